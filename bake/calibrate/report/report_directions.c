/* SPDX-License-Identifier: MIT */
/* Plots of residuals: by direction, by size against a normal distribution, and by distance from the
 * middle. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/report/report_parts.h"

#define SIDE 620
#define LEFT 70
#define BELOW 50
#define BINS 40
#define RINGS 12

/* ---- by direction ---- */

struct scatter {
	double range; /* px, from the middle to each side */
	double left, top, scale;
	int beyond;
};

/* Rounds up to a round number. */
static double round_up(double value)
{
	const double decade = pow(10, floor(log10(value)));

	return value <= decade	     ? decade
	       : value <= 2 * decade ? 2 * decade
	       : value <= 5 * decade ? 5 * decade
				     : 10 * decade;
}

/* Standard deviation of one coordinate of the residuals in use, px. */
static double deviation_of_coordinate(const struct shown *s)
{
	return s->rms / sqrt(2);
}

static void draw_grid(struct report_sheet *sheet, const struct scatter *p)
{
	for (int k = -2; k <= 2; k++) {
		const double value = p->range * k / 2, far = p->scale * value;
		const double x = p->left + SIDE / 2.0 + far, y = p->top + SIDE / 2.0 - far;

		sheet_ink(sheet, k ? INK_FAINT : INK_GREY, 1);
		cairo_set_line_width(sheet->c, 1);
		cairo_move_to(sheet->c, x, p->top);
		cairo_line_to(sheet->c, x, p->top + SIDE);
		cairo_move_to(sheet->c, p->left, y);
		cairo_line_to(sheet->c, p->left + SIDE, y);
		cairo_stroke(sheet->c);
		sheet_ink(sheet, INK_BLACK, 1);
		sheet_text(sheet, x, p->top + SIDE + SHEET_LINE, 0.5, "%g", value);
		/* down is down, as in the picture */
		sheet_text(sheet, p->left - 8, y + 5, 1, "%g", k ? -value : 0);
	}
	sheet_text(sheet, p->left + SIDE / 2.0, p->top + SIDE + 2 * SHEET_LINE, 0.5,
		   "x, px; y counts downwards, as in the picture");
}

static void draw_deviations(struct report_sheet *sheet, const struct scatter *p, double sigma)
{
	for (int k = 1; k <= 3 && sigma > 0; k++) {
		const double radius = k * sigma * p->scale;

		if (radius > SIDE / 2.0)
			break;
		sheet_ink(sheet, INK_BLACK, 1);
		cairo_set_line_width(sheet->c, 1.2);
		cairo_arc(sheet->c, p->left + SIDE / 2.0, p->top + SIDE / 2.0, radius, 0, 2 * M_PI);
		cairo_stroke(sheet->c);
	}
}

/* Draws a residual; one beyond the range is drawn at its edge. */
static void draw_residual(struct report_sheet *sheet, struct scatter *p, const double r[2],
			  bool outlier)
{
	const double far = fmax(fabs(r[0]), fabs(r[1]));
	const double keep = far > p->range ? p->range / far : 1;
	const double at[2] = {p->left + SIDE / 2.0 + p->scale * keep * r[0],
			      p->top + SIDE / 2.0 + p->scale * keep * r[1]};

	if (isnan(r[0]))
		return;
	p->beyond += far > p->range;
	if (outlier) {
		sheet_square(sheet, at, 4, INK_OUTLIER);
		return;
	}
	sheet_ink(sheet, INK_SEEN, 0.55);
	cairo_arc(sheet->c, at[0], at[1], 2.6, 0, 2 * M_PI);
	cairo_fill(sheet->c);
}

static void draw_key(struct report_sheet *sheet, const struct shown *s, const struct scatter *p)
{
	const double x = p->left + SIDE + 24;
	double mean[2] = {0, 0}, y = p->top + SHEET_LINE;
	int count = 0;

	for (int k = 0; k < s->finding->seen->count; k++)
		if (!s->outlier[k]) {
			mean[0] += s->residual[k][0];
			mean[1] += s->residual[k][1];
			count++;
		}
	sheet_ink(sheet, INK_BLACK, 1);
	sheet_text(sheet, x, y, 0, "%d points in use", count);
	sheet_text(sheet, x, y += SHEET_LINE, 0, "%.3g px RMS", s->rms);
	sheet_text(sheet, x, y += SHEET_LINE, 0, "%.3g px at most", s->worst);
	if (count)
		sheet_text(sheet, x, y += SHEET_LINE, 0, "mean %.2g, %.2g px", mean[0] / count,
			   mean[1] / count);
	sheet_text(sheet, x, y += 2 * SHEET_LINE, 0, "rings: 1, 2, 3 deviations");
	sheet_text(sheet, x, y += SHEET_LINE, 0, "of %.3g px", deviation_of_coordinate(s));
	if (s->outliers) {
		const double at[2] = {x + 6, y += 2 * SHEET_LINE};

		sheet_square(sheet, at, 4, INK_OUTLIER);
		sheet_ink(sheet, INK_BLACK, 1);
		sheet_text(sheet, x + 20, y + 5, 0, "%d outlier%s", s->outliers,
			   s->outliers == 1 ? "" : "s");
	}
	if (p->beyond)
		sheet_text(sheet, x, y + 2 * SHEET_LINE, 0, "%d beyond, at the edge", p->beyond);
}

static int draw_directions(const struct shown *s, struct fault *fault)
{
	struct scatter p = {.left = LEFT, .top = SHEET_MARGIN};
	struct report_sheet sheet;
	const int err = sheet_begin(&sheet, SHEET_WIDTH, SIDE + SHEET_MARGIN + BELOW);

	if (err)
		return fault_say(fault, err, "residuals cannot be drawn: %s", strerror(-err));
	p.range = s->worst > 0 ? round_up(fmin(s->worst, 5 * deviation_of_coordinate(s))) : 1;
	p.scale = SIDE / 2.0 / p.range;
	draw_grid(&sheet, &p);
	for (int outliers = 0; outliers < 2; outliers++)
		for (int k = 0; k < s->finding->seen->count; k++)
			if (s->outlier[k] == (outliers == 1))
				draw_residual(&sheet, &p, s->residual[k], s->outlier[k]);
	draw_deviations(&sheet, &p, deviation_of_coordinate(s));
	draw_key(&sheet, s, &p);
	return sheet_show(
		&sheet, s->page, "directions",
		"Every residual, seen less expected: a round cloud in the middle is noise.", fault);
}

/* ---- by size ---- */

static int plot_sizes(const struct shown *s, struct fault *fault)
{
	const double sigma = deviation_of_coordinate(s), range = 4 * sigma, step = 2 * range / BINS;
	int bin[BINS] = {0}, total = 0;
	struct report_plot plot;

	if (!(step > 0))
		return 0;
	for (int k = 0; k < s->finding->seen->count; k++)
		for (int i = 0; i < 2 && !s->outlier[k]; i++) {
			const double at = floor((s->residual[k][i] + range) / step);

			bin[(int)fmin(fmax(at, 0), BINS - 1)]++;
			total++;
		}
	report_plot_begin(&plot, "sizes", "residual along x or y, px", "how many");
	report_plot_series(&plot, "seen", STYLE_STEPS, 1);
	for (int k = 0; k < BINS; k++) {
		report_plot_point(&plot, -range + k * step, bin[k]);
		if (k == BINS - 1)
			report_plot_point(&plot, range, bin[k]);
	}
	report_plot_series(&plot, "noise", STYLE_DASHED, 2);
	for (int k = 0; k <= 2 * BINS; k++) {
		const double x = -range + k * step / 2, z = x / sigma;

		report_plot_point(&plot, x,
				  total * step / (sigma * sqrt(2 * M_PI)) * exp(-z * z / 2));
	}
	return report_page_plot(
		s->page, s->page->body, &plot,
		"How large residuals are, against normal noise of the same deviation; "
		"the outermost steps hold what is beyond.",
		fault);
}

/* ---- by distance from the middle ---- */

/* Plots the radial component of residuals, outwards positive: a trend shows radial distortion that
 * the model lacks. */
static int plot_radially(const struct shown *s, struct fault *fault)
{
	const double middle[2] = {s->width / 2.0, s->height / 2.0};
	const double range = hypot(middle[0], middle[1]);
	double sum[RINGS] = {0}, squares[RINGS] = {0};
	int count[RINGS] = {0};
	struct report_plot plot;

	for (int k = 0; k < s->finding->seen->count; k++) {
		const double *px = s->finding->seen->point[k].px;
		const double x = px[0] - middle[0], y = px[1] - middle[1], far = hypot(x, y);
		const double away = (x * s->residual[k][0] + y * s->residual[k][1]) / far;
		const double ring = floor(far / range * RINGS);

		if (s->outlier[k] || !(ring < RINGS) || !isfinite(away))
			continue;
		sum[(int)ring] += away;
		squares[(int)ring] += away * away;
		count[(int)ring]++;
	}
	report_plot_begin(&plot, "radial", "distance from the middle of the picture, px",
			  "residual away from it, px");
	for (int series = 0; series < 3; series++) {
		static const char *const label[] = {"mean", "+ 2 s.e.", "- 2 s.e."};
		static const double share[] = {0, 2, -2};

		report_plot_series(&plot, label[series], series ? STYLE_DASHED : STYLE_LINE,
				   series ? 0 : 1);
		for (int k = 0; k < RINGS; k++) {
			const double mean = sum[k] / count[k];
			const double error =
				sqrt(fmax(squares[k] / count[k] - mean * mean, 0) / count[k]);

			if (count[k] > 2)
				report_plot_point(&plot, (k + 0.5) / RINGS * range,
						  mean + share[series] * error);
		}
	}
	return report_page_plot(
		s->page, s->page->body, &plot,
		"Residuals along the radius, mean of each ring and two standard "
		"errors. A curve that leaves 0 by more is distortion that the model "
		"does not have.",
		fault);
}

int report_directions(const struct shown *s, struct fault *fault)
{
	int err = draw_directions(s, fault);

	if (!err)
		err = plot_sizes(s, fault);
	return err ? err : plot_radially(s, fault);
}
