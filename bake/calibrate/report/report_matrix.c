/* SPDX-License-Identifier: MIT */
/* The matrix of correlations between parameters, and a sentence on f and the distance. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/report/report_parts.h"

#define SHOWN_MOST 18
#define NAMES 190 /* width of the parameters' names, on the left */
#define HIGH 0.9  /* correlation above which two parameters are hardly told apart */
#define PAIRS_SAID 6

struct correlation_matrix {
	int parameter[SHOWN_MOST]; /* index in the estimate */
	int count;
	double cell;
};

static bool belongs_to_view(const char *name, int *view)
{
	return sscanf(name, "view %d ", view) == 1;
}

/* Chooses the parameters of the lens, then those of the first view. */
static void choose_parameters(struct correlation_matrix *m, const struct estimate *e)
{
	for (int views = 0; views < 2; views++)
		for (int k = 0; k < e->count && m->count < SHOWN_MOST; k++) {
			int view = 0;
			const bool of_view = belongs_to_view(e->parameter[k].name, &view);

			if (estimate_deviation(e, k) > 0 && of_view == (views == 1) && view <= 1)
				m->parameter[m->count++] = k;
		}
}

/* Sets the colour: white at 0, orange towards 1, blue towards -1. */
static void set_cell_colour(cairo_t *c, double correlation)
{
	static const double ends[2][3] = {{0.000, 0.447, 0.698}, {0.835, 0.369, 0.000}};
	const double *end = ends[correlation > 0], share = fmin(fabs(correlation), 1);

	cairo_set_source_rgb(c, 1 + share * (end[0] - 1), 1 + share * (end[1] - 1),
			     1 + share * (end[2] - 1));
}

static void draw_cell(struct report_sheet *sheet, const struct correlation_matrix *m, int row,
		      int column, double correlation)
{
	const double x = NAMES + column * m->cell, y = SHEET_MARGIN + row * m->cell;

	cairo_rectangle(sheet->c, x + 0.5, y + 0.5, m->cell - 1, m->cell - 1);
	if (isfinite(correlation))
		set_cell_colour(sheet->c, correlation);
	else
		sheet_ink(sheet, INK_FAINT, 1);
	cairo_fill(sheet->c);
	sheet_ink(sheet, fabs(correlation) > 0.75 ? INK_WHITE : INK_BLACK, 1);
	if (isfinite(correlation))
		sheet_text(sheet, x + m->cell / 2, y + m->cell / 2 + 5, 0.5, "%.2f", correlation);
	else
		sheet_text(sheet, x + m->cell / 2, y + m->cell / 2 + 5, 0.5, "?");
}

static int draw_matrix(const struct shown *s, const struct correlation_matrix *m,
		       struct fault *fault)
{
	const struct estimate *e = &s->finding->estimate;
	const int side = (int)(m->count * m->cell);
	struct report_sheet sheet;
	const int err = sheet_begin(&sheet, SHEET_WIDTH, side + 2 * SHEET_MARGIN + NAMES);

	if (err)
		return fault_say(fault, err, "correlations cannot be drawn: %s", strerror(-err));
	for (int a = 0; a < m->count; a++) {
		const char *name = e->parameter[m->parameter[a]].name;

		sheet_ink(&sheet, INK_BLACK, 1);
		sheet_text(&sheet, NAMES - 8, SHEET_MARGIN + (a + 0.5) * m->cell + 5, 1, "%s",
			   name);
		cairo_save(sheet.c);
		cairo_translate(sheet.c, NAMES + (a + 0.5) * m->cell + 5, SHEET_MARGIN + side + 8);
		cairo_rotate(sheet.c, -M_PI / 2);
		sheet_text(&sheet, 0, 0, 1, "%s", name);
		cairo_restore(sheet.c);
		for (int b = 0; b < m->count; b++)
			draw_cell(
				&sheet, m, a, b,
				a == b ? 1
				       : estimate_correlation(e, m->parameter[a], m->parameter[b]));
	}
	return sheet_show(&sheet, s->page, "correlations",
			  "Correlations of what was found, with the first view's place where there "
			  "are several.",
			  fault);
}

/* ---- in words ---- */

static bool name_ends_with(const char *text, const char *end)
{
	const size_t length = strlen(text), tail = strlen(end);

	return length >= tail && !strcmp(text + length - tail, end);
}

/* Names the focal length and the distance with the largest correlation. */
static void say_focal(const struct shown *s)
{
	const struct estimate *e = &s->finding->estimate;
	double most = 0;
	int focal = -1, distance = -1;

	for (int a = 0; a < e->count; a++)
		for (int b = 0; b < e->count; b++) {
			const double r = estimate_correlation(e, a, b);

			if (!strncmp(e->parameter[a].name, "focal", 5) &&
			    name_ends_with(e->parameter[b].name, "translation z") &&
			    fabs(r) > fabs(most)) {
				most = r;
				focal = a;
				distance = b;
			}
		}
	if (focal < 0)
		return;
	report_paragraph(s->page->body, "%s and %s: correlation %.6g. %s", e->parameter[focal].name,
			 e->parameter[distance].name, most,
			 fabs(most) > HIGH
				 ? "They are known well together only: what one has too much, the "
				   "other makes up for. Points at more depths, or a board at a "
				   "steeper angle, tell them apart."
				 : "They are told apart.");
}

static void say_pairs(const struct shown *s, const struct correlation_matrix *m)
{
	const struct estimate *e = &s->finding->estimate;
	char text[1024] = "";
	int said = 0;

	for (int a = 0; a < m->count; a++)
		for (int b = a + 1; b < m->count; b++) {
			const double r = estimate_correlation(e, m->parameter[a], m->parameter[b]);
			const size_t used = strlen(text);

			if (!(fabs(r) > HIGH))
				continue;
			if (said++ < PAIRS_SAID)
				snprintf(text + used, sizeof(text) - used, "%s%s with %s (%.6g)",
					 used ? ", " : "", e->parameter[m->parameter[a]].name,
					 e->parameter[m->parameter[b]].name, r);
		}
	if (!said)
		report_paragraph(s->page->body, "No two go together beyond %g.", HIGH);
	else
		report_paragraph(s->page->body, "Beyond %g go together: %s%s.", HIGH, text,
				 said > PAIRS_SAID ? ", and others" : "");
}

int report_correlations(const struct shown *s, struct fault *fault)
{
	struct correlation_matrix m = {.count = 0};

	choose_parameters(&m, &s->finding->estimate);
	if (m.count < 2)
		return 0;
	m.cell = fmin((SHEET_WIDTH - NAMES - SHEET_MARGIN) / (double)m.count, 60);
	report_heading(s->page->body, "What goes together");
	say_focal(s);
	say_pairs(s, &m);
	return draw_matrix(s, &m, fault);
}
