/* SPDX-License-Identifier: MIT */
#include "bake/report/report_parts.h"

#include <cairo-svg.h>
#include <cairo.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>

#define WIDTH 760
#define HEIGHT 420
#define LEFT 66
#define RIGHT 24
#define ABOVE 16
#define BELOW 54
#define TEXT_PX 13
#define LINE_PX 15 /* distance between lines of text */
#define MARGIN 1.2 /* factor between the outermost points and the ends of the axes */

struct axis {
	double low, high; /* log10 of the values at its ends */
	double from, to;  /* the same in the picture, in pixels */
};

struct label_box {
	double x, y, width;
};

struct plot_drawing {
	cairo_t *c;
	struct axis x, y;
	struct label_box taken[REPORT_POINTS_MAX]; /* by labels */
	int count;
};

static double axis_place(const struct axis *a, double value)
{
	return a->from + (log10(value) - a->low) / (a->high - a->low) * (a->to - a->from);
}

static void axis_include(struct axis *a, double value)
{
	a->low = fmin(a->low, log10(value / MARGIN));
	a->high = fmax(a->high, log10(value * MARGIN));
}

static double text_width(cairo_t *c, const char *text)
{
	cairo_text_extents_t extents;

	cairo_text_extents(c, text, &extents);
	return extents.x_advance;
}

/* Draws text so that `share` of its width lies left of x; y is the middle of its height. A white
 * outline around the letters covers lines below. */
static void plot_draw_text(cairo_t *c, double x, double y, double share, const char *text)
{
	cairo_move_to(c, x - share * text_width(c, text), y + 0.36 * TEXT_PX);
	cairo_text_path(c, text);
	cairo_set_source_rgb(c, 1, 1, 1);
	cairo_set_line_width(c, 4);
	cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
	cairo_stroke_preserve(c);
	cairo_set_source_rgb(c, 0.1, 0.1, 0.1);
	cairo_fill(c);
}

static void plot_draw_line(cairo_t *c, double x, double y, double to_x, double to_y)
{
	cairo_move_to(c, x, y);
	cairo_line_to(c, to_x, to_y);
	cairo_stroke(c);
}

/* Draws a line across the plot at each tick, with its value. */
static void draw_ticks(const struct plot_drawing *d, const struct axis *a, bool across)
{
	/* Ticks of a decade: the fewer decades there are, the more ticks. */
	static const double steps[][9] = {{1, 1.2, 1.5, 2, 2.5, 3, 4, 6, 8}, {1, 2, 5}, {1}};
	const double decades = a->high - a->low;
	const double *step = steps[decades < 1 ? 0 : decades < 3 ? 1 : 2];

	for (int k = 0; k < 9 * ((int)floor(a->high) - (int)floor(a->low) + 1); k++) {
		const double value = step[k % 9] * pow(10, (int)floor(a->low) + k / 9);
		const double at = rint(axis_place(a, value)) + 0.5;
		char text[32];

		if (!(log10(value) > a->low && log10(value) < a->high))
			continue;
		snprintf(text, sizeof(text), "%.4g", value);
		cairo_set_line_width(d->c, 1);
		cairo_set_source_rgb(d->c, 0.9, 0.9, 0.9);
		if (across) {
			plot_draw_line(d->c, at, d->y.from, at, d->y.to);
			plot_draw_text(d->c, at, d->y.from + LINE_PX, 0.5, text);
		} else {
			plot_draw_line(d->c, d->x.from, at, d->x.to, at);
			plot_draw_text(d->c, d->x.from - 8, at, 1, text);
		}
	}
}

static void draw_axes(const struct plot_drawing *d, const char *x_label, const char *y_label)
{
	draw_ticks(d, &d->x, true);
	draw_ticks(d, &d->y, false);
	cairo_set_line_width(d->c, 1);
	cairo_set_source_rgb(d->c, 0.4, 0.4, 0.4);
	plot_draw_line(d->c, d->x.from, d->y.to, d->x.from, d->y.from);
	plot_draw_line(d->c, d->x.from, d->y.from, d->x.to, d->y.from);
	plot_draw_text(d->c, (d->x.from + d->x.to) / 2, HEIGHT - 14, 0.5, x_label);
	cairo_save(d->c);
	cairo_translate(d->c, 14, (d->y.from + d->y.to) / 2);
	cairo_rotate(d->c, -M_PI / 2);
	plot_draw_text(d->c, 0, 0, 0.5, y_label);
	cairo_restore(d->c);
}

static void draw_point(const struct plot_drawing *d, const struct report_point *point)
{
	const double x = axis_place(&d->x, point->x), y = axis_place(&d->y, point->y);

	/* grey, and a blue of Okabe and Ito, which colour-blind readers tell apart */
	cairo_set_source_rgb(d->c, point->strong ? 0 : 0.55, point->strong ? 0.447 : 0.55,
			     point->strong ? 0.698 : 0.55);
	cairo_arc(d->c, x, y, 3, 0, 2 * M_PI);
	cairo_fill(d->c);
	if (!point->ringed)
		return;
	cairo_set_source_rgb(d->c, 0.1, 0.1, 0.1);
	cairo_set_line_width(d->c, 1.6);
	cairo_arc(d->c, x, y, 8, 0, 2 * M_PI);
	cairo_stroke(d->c);
}

static bool is_place_free(const struct plot_drawing *d, const struct label_box *box)
{
	bool is_free = box->x > LEFT && box->x + box->width < WIDTH && box->y > ABOVE &&
		       box->y < d->y.from - 6;

	for (int k = 0; k < d->count; k++) {
		const struct label_box *b = &d->taken[k];

		is_free &= box->x > b->x + b->width || b->x > box->x + box->width ||
			   fabs(box->y - b->y) >= LINE_PX - 1;
	}
	return is_free;
}

/* Draws a label at the first free place around its point, on its right before its left. */
static void draw_label(struct plot_drawing *d, const struct report_point *point)
{
	static const int down[] = {-10, 0, 13, -26, 26, -40, 40};
	const double x = axis_place(&d->x, point->x), y = axis_place(&d->y, point->y);
	const double width = text_width(d->c, point->label), gap = point->ringed ? 13 : 8;

	for (size_t k = 0; k < 2 * sizeof(down) / sizeof(*down); k++) {
		const struct label_box box = {k % 2 ? x - gap - width : x + gap, y + down[k / 2],
					      width};

		if (!is_place_free(d, &box))
			continue;
		plot_draw_text(d->c, box.x, box.y, 0, point->label);
		d->taken[d->count++] = box;
		return;
	}
}

static void plot_draw(cairo_t *c, const char *x_label, const char *y_label,
		      const struct report_point *points, int count)
{
	struct plot_drawing d = {.c = c,
				 .x = {INFINITY, -INFINITY, LEFT, WIDTH - RIGHT},
				 .y = {INFINITY, -INFINITY, HEIGHT - BELOW, ABOVE}};
	const struct report_point *drawn[REPORT_POINTS_MAX];
	int many = 0;

	for (int k = 0; k < count && many < REPORT_POINTS_MAX; k++) {
		if (!(points[k].x > 0 && points[k].y > 0))
			continue;
		axis_include(&d.x, points[k].x);
		axis_include(&d.y, points[k].y);
		drawn[many++] = &points[k];
	}
	cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
	cairo_set_font_size(c, TEXT_PX);
	cairo_set_source_rgb(c, 1, 1, 1);
	cairo_paint(c);
	draw_axes(&d, x_label, y_label);
	for (int k = 0; k < many; k++)
		draw_point(&d, drawn[k]);
	for (int k = 0; k < many; k++)
		if (drawn[k]->label)
			draw_label(&d, drawn[k]);
}

int report_plot_write(const char *folder, const char *name, const char *x_label,
		      const char *y_label, const struct report_point *points, int count,
		      struct fault *fault)
{
	cairo_surface_t *surface;
	cairo_status_t status;
	char path[PATH_MAX];
	cairo_t *c;

	snprintf(path, sizeof(path), "%s/%s.svg", folder, name);
	surface = cairo_svg_surface_create(path, WIDTH, HEIGHT);
	cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
	c = cairo_create(surface);
	plot_draw(c, x_label, y_label, points, count);
	status = cairo_status(c);
	cairo_destroy(c);
	cairo_surface_finish(surface);
	if (status == CAIRO_STATUS_SUCCESS)
		status = cairo_surface_status(surface);
	cairo_surface_destroy(surface);
	if (status != CAIRO_STATUS_SUCCESS)
		return fault_say(fault, -EIO, "%s: %s", path, cairo_status_to_string(status));
	return 0;
}
