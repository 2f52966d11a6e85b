/* SPDX-License-Identifier: MIT */
/* Maps over the picture: uncertainty of the model, and disagreement of two halves of the data. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/surface.h"
#include "bake/calibrate/report/report_parts.h"

#define NODES_LONG 97 /* grid nodes along the picture's longer side */
#define LEVELS_MOST 16
#define LEVELS_WANTED 6	  /* number of evenly spaced levels */
#define NEAR 8.0	  /* ratio of most to least up to which levels are evenly spaced */
#define RANGE_MOST 1000.0 /* largest ratio of most to least in colours */
#define BAR 14

/* Samples of a function of the picture's points on a grid. */
struct field {
	int across, down;
	double *value; /* [down][across]; NaN: not known, or not seen */
	double least, most;
	double level[LEVELS_MOST];
	int levels;
};

/* ---- values ---- */

static void map_measure(struct field *f)
{
	const int nodes = f->across * f->down;

	f->least = INFINITY;
	f->most = -INFINITY;
	for (int k = 0; k < nodes; k++)
		if (!isnan(f->value[k])) {
			f->least = fmin(f->least, f->value[k]);
			f->most = fmax(f->most, f->value[k]);
		}
	f->least = fmax(fmax(f->least, f->most / RANGE_MOST), 1e-12);
	f->most = fmax(f->most, f->least);
}

static void add_level(struct field *f, double level)
{
	if (level >= f->least && level <= f->most && f->levels < LEVELS_MOST)
		f->level[f->levels++] = level;
}

/* Chooses contour levels: 1, 2, 5, 10 ... within at most three decades; evenly spaced where least
 * and most are close. */
static void choose_levels(struct field *f)
{
	static const double steps[] = {1, 2, 5, 10};
	const double decade = pow(10, floor(log10(f->most - f->least)) - 1);
	int step = 0;

	f->levels = 0;
	if (f->most > NEAR * f->least) {
		for (int e = (int)floor(log10(f->least)); e <= (int)ceil(log10(f->most)); e++)
			for (int k = 0; k < 3; k++)
				add_level(f, steps[k] * pow(10, e));
		return;
	}
	while (step < 3 && (f->most - f->least) / (steps[step] * decade) > LEVELS_WANTED)
		step++;
	for (int k = 0; f->most > f->least && k <= 10 * LEVELS_MOST; k++)
		add_level(f, (ceil(f->least / (steps[step] * decade)) + k) * steps[step] * decade);
}

static int map_fill(struct field *f, const struct shown *s,
		    double (*function)(const void *context, const double px[2]))
{
	const double step = fmax(s->width, s->height) / (NODES_LONG - 1.0);

	*f = (struct field){.across = (int)fmax(rint(s->width / step), 1) + 1,
			    .down = (int)fmax(rint(s->height / step), 1) + 1};
	f->value = malloc((size_t)f->across * (size_t)f->down * sizeof(*f->value));
	if (!f->value)
		return -ENOMEM;
	for (int y = 0; y < f->down; y++)
		for (int x = 0; x < f->across; x++) {
			const double px[2] = {(double)s->width * x / (f->across - 1),
					      (double)s->height * y / (f->down - 1)};
			const double value = function(s->finding->context, px);

			f->value[y * f->across + x] = isfinite(value) && value >= 0 ? value : NAN;
		}
	map_measure(f);
	choose_levels(f);
	return 0;
}

/* Bilinear interpolation; x and y in cells. NaN next to unknown nodes. */
static double value_at(const struct field *f, double x, double y)
{
	const int i = (int)fmin(x, f->across - 2), j = (int)fmin(y, f->down - 2);
	const double *v = f->value + j * f->across + i, a = x - i, b = y - j;

	return (1 - b) * ((1 - a) * v[0] + a * v[1]) +
	       b * ((1 - a) * v[f->across] + a * v[f->across + 1]);
}

static double colour_share(const struct field *f, double value)
{
	return f->most > f->least ? log(fmax(value, f->least) / f->least) / log(f->most / f->least)
				  : 0.5;
}

/* ---- drawing ---- */

static void draw_colours(struct report_sheet *sheet, const struct sheet_area *area,
			 const struct field *f)
{
	const int wide = (int)(area->scale * area->width);
	const int high = (int)(area->scale * area->height);

	for (int y = 0; y < high; y += 2)
		for (int x = 0; x < wide; x += 2) {
			const double value = value_at(f, (x + 1.0) / wide * (f->across - 1),
						      (y + 1.0) / high * (f->down - 1));
			double rgb[3];

			if (isnan(value)) {
				sheet_ink(sheet, INK_FAINT, 1);
			} else {
				surface_ramp(colour_share(f, value), rgb);
				cairo_set_source_rgb(sheet->c, rgb[0], rgb[1], rgb[2]);
			}
			cairo_rectangle(sheet->c, area->left + x, area->top + y, 2, 2);
			cairo_fill(sheet->c);
		}
}

/* Finds the crossings of a level with the four sides of a cell, in cells. */
static int cell_crossings(const struct field *f, int i, int j, double level, double at[4][2])
{
	static const int corner[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};
	int count = 0;

	for (int k = 0; k < 4; k++) {
		const int *p = corner[k], *q = corner[k + 1];
		const double a = f->value[(j + p[1]) * f->across + i + p[0]];
		const double b = f->value[(j + q[1]) * f->across + i + q[0]];
		double t;

		if (isnan(a) || isnan(b))
			return 0;
		if ((a < level) == (b < level))
			continue;
		t = (level - a) / (b - a);
		at[count][0] = i + p[0] + t * (q[0] - p[0]);
		at[count++][1] = j + p[1] + t * (q[1] - p[1]);
	}
	return count;
}

static void to_sheet(const struct sheet_area *area, const struct field *f, double point[2])
{
	point[0] = area->left + point[0] / (f->across - 1) * area->scale * area->width;
	point[1] = area->top + point[1] / (f->down - 1) * area->scale * area->height;
}

/* Draws a contour line. Its label is placed where the line comes nearest to a place below the
 * middle; the height of that place depends on the level's number, so that labels do not overlap. */
static void draw_level(struct report_sheet *sheet, const struct sheet_area *area,
		       const struct field *f, int number)
{
	const double wanted[2] = {area->left +
					  area->scale * area->width * (0.5 + 0.06 * (number % 3)),
				  area->top + area->scale * area->height * 0.97};
	double best = INFINITY, name[2] = {0, 0};
	char text[32];

	for (int j = 0; j < f->down - 1; j++)
		for (int i = 0; i < f->across - 1; i++) {
			double at[4][2];
			const int count = cell_crossings(f, i, j, f->level[number], at);

			for (int k = 0; k < count; k++)
				to_sheet(area, f, at[k]);
			for (int k = 0; k + 1 < count; k += 2) {
				const double far = hypot(3 * (at[k][0] - wanted[0]),
							 at[k][1] - wanted[1]);

				cairo_move_to(sheet->c, at[k][0], at[k][1]);
				cairo_line_to(sheet->c, at[k + 1][0], at[k + 1][1]);
				if (far < best) {
					best = far;
					memcpy(name, at[k], sizeof(name));
				}
			}
		}
	sheet_ink(sheet, INK_BLACK, 0.6);
	cairo_set_line_width(sheet->c, 3);
	cairo_stroke_preserve(sheet->c);
	sheet_ink(sheet, INK_WHITE, 1);
	cairo_set_line_width(sheet->c, 1.3);
	cairo_stroke(sheet->c);
	snprintf(text, sizeof(text), "%g", f->level[number]);
	if (isfinite(best))
		sheet_label(sheet,
			    fmin(fmax(name[0] - sheet_text_width(sheet, text) / 2, area->left + 4),
				 area->left + area->scale * area->width - 50),
			    fmax(name[1] - 3, area->top + 16), INK_BLACK, text);
}

static void draw_colour_bar(struct report_sheet *sheet, const struct sheet_area *area,
			    const struct field *f, const char *label)
{
	const double left = SHEET_MARGIN + 40, wide = SHEET_WIDTH - 2 * left;
	const double top = sheet_below(area, 0) - 8;
	cairo_pattern_t *gradient = cairo_pattern_create_linear(left, 0, left + wide, 0);
	double end = -INFINITY;

	surface_ramp_stops(gradient);
	cairo_rectangle(sheet->c, left, top, wide, BAR);
	cairo_set_source(sheet->c, gradient);
	cairo_fill(sheet->c);
	cairo_pattern_destroy(gradient);
	sheet_ink(sheet, INK_BLACK, 1);
	for (int k = -1; k <= f->levels; k++) {
		const double value = k < 0 ? f->least : k < f->levels ? f->level[k] : f->most;
		const double x = left + wide * colour_share(f, value);
		char text[32];
		double half;

		snprintf(text, sizeof(text), "%.2g", value);
		half = sheet_text_width(sheet, text) / 2;
		if (x - half < end + 8)
			continue;
		end = x + half;
		sheet_text(sheet, x, top + BAR + 16, 0.5, "%s", text);
	}
	sheet_text(sheet, SHEET_WIDTH / 2.0, top + BAR + 35, 0.5, "%s", label);
}

static int draw_map(const struct shown *s, const struct field *f, const char *name,
		    const char *label, const char *caption, struct fault *fault)
{
	struct report_sheet sheet;
	struct sheet_area area;
	const int err = sheet_begin_area(&sheet, &area, s->width, s->height, 3);

	if (err)
		return fault_say(fault, err, "%s cannot be drawn: %s", name, strerror(-err));
	sheet_clip(&sheet, &area);
	draw_colours(&sheet, &area, f);
	for (int k = 0; k < s->finding->seen->count; k++) {
		double at[2];

		sheet_ink(&sheet, INK_WHITE, 0.7);
		if (!sheet_place(&area, s->finding->seen->point[k].px, at))
			continue;
		cairo_rectangle(sheet.c, at[0] - 1, at[1] - 1, 2, 2);
		cairo_fill(sheet.c);
	}
	for (int k = 0; k < f->levels; k++)
		draw_level(&sheet, &area, f, k);
	sheet_unclip(&sheet);
	sheet_frame(&sheet, &area);
	draw_colour_bar(&sheet, &area, f, label);
	return sheet_show(&sheet, s->page, name, caption, fault);
}

/* Draws a map, or writes a sentence if nothing of it is known. */
static int report_map(const struct shown *s,
		      double (*function)(const void *context, const double px[2]), const char *name,
		      const char *label, const char *caption, struct fault *fault)
{
	struct field field;
	int err = map_fill(&field, s, function);

	if (err)
		return fault_say(fault, err, "%s: not enough memory", name);
	if (isfinite(field.most))
		err = draw_map(s, &field, name, label, caption, fault);
	else
		report_paragraph(s->page->body, "There is no map of it: nothing of it is known.");
	free(field.value);
	return err;
}

int report_maps(const struct shown *s, struct fault *fault)
{
	const struct finding *f = s->finding;
	int err = 0;

	report_heading(s->page->body, "How uncertain the model is");
	if (f->uncertainty)
		err = report_map(s, f->uncertainty, "uncertainty",
				 "one standard deviation, px (grey: not seen, or not known)",
				 "Where the model sees a thing at the distance of what was "
				 "observed: one standard deviation. Small dots: points observed.",
				 fault);
	else
		report_paragraph(s->page->body, "It was not found out.");
	if (err)
		return err;
	report_heading(s->page->body, "Odd points against even ones");
	if (!f->disagreement) {
		report_paragraph(s->page->body, "There are too few points for two halves.");
		return 0;
	}
	report_paragraph(s->page->body,
			 "The same model fitted to every other point, and to the others. Where the "
			 "two disagree by much more than the uncertainty, the model does not fit "
			 "what was seen.");
	return report_map(s, f->disagreement, "disagreement",
			  "distance, px (grey: not seen, or not known)",
			  "Distance between the two models over the picture.", fault);
}
