/* SPDX-License-Identifier: MIT */
/* Tables of a calibration's report: figures, parts of the picture, parameters. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/calibrate/report/report_parts.h"

/* ---- figures ---- */

int report_figures(const struct shown *s, struct fault *fault)
{
	const struct finding *f = s->finding;
	struct table table;

	table_begin(&table, "figures");
	table_column(&table, "key", NULL, NULL);
	table_column(&table, "figure", "what it means for the scene", NULL);
	table_column(&table, "value", "value", NULL);
	table_column(&table, "unit", "unit", NULL);
	table_text(&table, "rms_px");
	table_text(&table, "distance of points from where they are expected, RMS without outliers");
	table_number(&table, f->rms_px);
	table_text(&table, "px");
	table_text(&table, "worst_px");
	table_text(&table, "the largest such distance");
	table_number(&table, f->worst_px);
	table_text(&table, "px");
	for (int k = 0; k < f->figures; k++) {
		table_text(&table, "%s", f->figure[k].key);
		table_text(&table, "%s", f->figure[k].label);
		table_number(&table, f->figure[k].value);
		table_text(&table, "%s", f->figure[k].unit);
	}
	return report_page_table(s->page, &table, fault);
}

/* ---- parts of the picture ---- */

/* The picture is divided into this many parts each way: its middle, edges and corners. */
#define PARTS 3

/* The points in a part; outliers do not count. */
static int points_in_part(const struct shown *s, int x, int y)
{
	int count = 0;

	for (int k = 0; k < s->finding->seen->count; k++) {
		const double *px = s->finding->seen->point[k].px;

		count += !s->outlier[k] && floor(PARTS * px[0] / s->width) == x &&
			 floor(PARTS * px[1] / s->height) == y;
	}
	return count;
}

/* A function of the finding at px; NaN where it is not known or px is not seen. */
static double value_at(const struct shown *s, double (*of)(const void *context, const double px[2]),
		       const double px[2])
{
	const double value = s->modelled && of ? of(s->finding->context, px) : NAN;

	return value >= 0 ? value : NAN;
}

int report_parts_of_picture(const struct shown *s, struct fault *fault)
{
	struct table table;

	if (s->modelled && !s->finding->uncertainty) /* what was found is not the lens */
		return 0;
	table_begin(&table, "parts");
	table_column(&table, "x_px", "middle x", "px");
	table_column(&table, "y_px", "middle y", "px");
	table_column(&table, "points", "points", NULL);
	table_column(&table, "uncertainty_px", "uncertainty", "px");
	for (int k = 0; k < PARTS * PARTS; k++) {
		const double px[2] = {(k % PARTS + 0.5) * s->width / PARTS,
				      (k / PARTS + 0.5) * s->height / PARTS};

		table_number(&table, px[0]);
		table_number(&table, px[1]);
		table_number(&table, points_in_part(s, k % PARTS, k / PARTS));
		table_number(&table, value_at(s, s->finding->uncertainty, px));
	}
	report_heading(s->page->body, "How much is known in each part of the picture");
	report_paragraph(
		s->page->body,
		"What lies outside of all points is extrapolated: hold the board where it "
		"was not yet, into the corners above all. The uncertainty is one standard "
		"deviation at the part's middle. What is empty is not known, or not seen by the model.");
	return report_page_table(s->page, &table, fault);
}

/* ---- parameters ---- */

/* Writes a value with the digits that its deviation justifies. */
static void write_value(char *text, size_t room, double value, double deviation)
{
	const int digits = deviation > 0 && isfinite(deviation)
				   ? (int)fmin(fmax(1 - floor(log10(deviation)), 0), 12)
				   : -1;

	if (!isfinite(value))
		snprintf(text, room, "not known");
	else if (digits < 0 || fabs(value) >= 1e9)
		snprintf(text, room, "%.9g", value);
	else
		snprintf(text, room, "%.*f", digits, value);
}

static void add_parameter(struct table *table, const struct estimate *e, int k)
{
	const struct parameter *p = &e->parameter[k];
	const bool exact = p->fixed && !(estimate_deviation(e, k) > 0);
	const double deviation = exact ? NAN : estimate_deviation(e, k);
	char text[64];

	write_value(text, sizeof(text), p->value, deviation);
	table_text(table, "%s", p->name);
	table_text(table, "%s", text);
	table_number(table, p->value);
	table_number(table, deviation);
	table_text(table, "%s", p->unit);
	table_number(table, p->value != 0 ? 100 * deviation / fabs(p->value) : NAN);
	table_text(table, exact			? "held"
			  : p->fixed		? "held; its deviation is assumed"
			  : isfinite(deviation) ? ""
						: "cannot be told from the others");
}

int report_parameters(const struct shown *s, struct fault *fault)
{
	const struct estimate *e = &s->finding->estimate;
	struct table table;

	table_begin(&table, "parameters");
	table_column(&table, "name", "parameter", NULL);
	table_column(&table, "value_rounded", "value", NULL);
	table_column(&table, "value", NULL, NULL);
	table_column(&table, "deviation", "deviation", NULL);
	table_column(&table, "unit", "unit", NULL);
	table_column(&table, "deviation_percent", "deviation", "%");
	table_column(&table, "note", "note", NULL);
	for (int k = 0; k < e->count; k++)
		if (strncmp(e->parameter[k].name, "view ", 5) != 0)
			add_parameter(&table, e, k);
	report_heading(s->page->body, "What was found");
	report_paragraph(
		s->page->body,
		"%d numbers were observed, %d are left to judge by: one of them deviates "
		"by %.3g px. Deviations are standard deviations, to first order. Where the camera was in each view is in calibration.json.",
		e->residuals, e->freedom, e->sigma);
	return report_page_table(s->page, &table, fault);
}
