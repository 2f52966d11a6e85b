/* SPDX-License-Identifier: MIT */
#include "bake/base/report_plot.h"

#include <cairo-svg.h>
#include <cairo.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WIDTH 760
#define HEIGHT 420
#define LEFT 66
#define ABOVE 16
#define BELOW 54
#define RIGHT_LEAST 24
#define TEXT_PX 13
#define LINE_PX 15 /* distance between lines of text */

/* The palette of Okabe and Ito without its yellow, which is too pale on white. */
static const double palette[][3] = {
	{0.55, 0.55, 0.55},    {0.000, 0.447, 0.698}, {0.835, 0.369, 0.000}, {0.000, 0.620, 0.451},
	{0.800, 0.475, 0.655}, {0.902, 0.624, 0.000}, {0.337, 0.706, 0.914}, {0.1, 0.1, 0.1},
};

#define COLOURS ((int)(sizeof(palette) / sizeof(*palette)))

void report_plot_begin(struct report_plot *p, const char *name, const char *x_label,
		       const char *y_label)
{
	*p = (struct report_plot){.name = name};
	snprintf(p->x_label, sizeof(p->x_label), "%s", x_label);
	snprintf(p->y_label, sizeof(p->y_label), "%s", y_label);
}

void report_plot_free(struct report_plot *p)
{
	for (int k = 0; k < p->count; k++)
		free(p->series[k].point);
	*p = (struct report_plot){.count = 0};
}

void report_plot_series(struct report_plot *p, const char *label, enum report_style style,
			int colour)
{
	struct report_series *s = &p->series[p->count];

	if (p->count == REPORT_SERIES_MAX) {
		p->err = -E2BIG;
		return;
	}
	p->count++;
	*s = (struct report_series){.style = style, .colour = colour % COLOURS};
	snprintf(s->label, sizeof(s->label), "%s", label ? label : "");
	s->point = calloc(REPORT_POINTS_MAX, sizeof(*s->point));
	if (!s->point)
		p->err = -ENOMEM;
}

struct report_point *report_plot_point(struct report_plot *p, double x, double y)
{
	static struct report_point nowhere;
	struct report_series *s = p->count ? &p->series[p->count - 1] : NULL;
	struct report_point *point = &nowhere;

	if (s && s->point && s->count < REPORT_POINTS_MAX && isfinite(x) && isfinite(y) &&
	    (!p->x_log || x > 0) && (!p->y_log || y > 0))
		point = &s->point[s->count++];
	*point = (struct report_point){.x = x, .y = y, .y_low = y, .y_high = y};
	return point;
}

/* ---- axes ---- */

struct axis {
	bool log;
	double low, high; /* range of the values; of their log10 where log */
	double from, to;  /* the same in the picture, in pixels */
	double tick[REPORT_TICKS_MAX];
	int ticks;
};

static double axis_place(const struct axis *a, double value)
{
	const double v = a->log ? log10(value) : value;

	return a->from + (v - a->low) / (a->high - a->low) * (a->to - a->from);
}

static void axis_include(struct axis *a, double value)
{
	const double v = a->log ? log10(value) : value;

	a->low = fmin(a->low, v);
	a->high = fmax(a->high, v);
}

/* Adds a tick inside the range. */
static void axis_add_tick(struct axis *a, double value)
{
	const double v = a->log ? log10(value) : value;

	if (a->ticks == REPORT_TICKS_MAX || v < a->low - 1e-9 || v > a->high + 1e-9)
		return;
	a->tick[a->ticks++] = value;
}

static void choose_log_ticks(struct axis *a)
{
	static const double fine[] = {1, 2, 5}, half[] = {1, 3};
	const double decades = a->high - a->low;
	const double *steps = decades < 2.5 ? fine : half;
	const int count = decades < 2.5 ? 3 : decades < 4.5 ? 2 : 1;

	for (int e = (int)floor(a->low); e <= (int)ceil(a->high); e++)
		for (int k = 0; k < count; k++)
			axis_add_tick(a, steps[k] * pow(10, e));
}

static void choose_linear_ticks(struct axis *a)
{
	static const double steps[] = {1, 2, 5, 10};
	const double low = a->log ? pow(10, a->low) : a->low;
	const double high = a->log ? pow(10, a->high) : a->high;
	const double rough = (high - low) / 6, decade = pow(10, floor(log10(rough)));
	int k = 0;

	while (k < 3 && steps[k] * decade < rough)
		k++;
	/* + 0.0: ceil() of a number just below 0 is -0, which would be printed with its sign */
	for (double v = ceil(low / (steps[k] * decade)) + 0.0; v * steps[k] * decade <= high; v++)
		axis_add_tick(a, v * steps[k] * decade);
}

/* Widens the range to leave room around the points, and chooses the ticks. ticks: number of the
 * plot's own ticks, or 0. */
static void finish_axis(struct axis *a, const struct report_plot *p, int ticks)
{
	double room;

	if (a->low > a->high)
		a->low = a->high = 0;
	if (!a->log && !ticks && a->low > 0)
		a->low = 0;
	room = a->high > a->low ? 0.05 * (a->high - a->low) : a->log ? 0.3 : 1;
	if (a->log || ticks || a->low != 0)
		a->low -= room;
	a->high += room;
	for (int k = 0; k < ticks; k++)
		axis_add_tick(a, p->x_tick[k]);
	if (ticks)
		return;
	if (a->log && a->high - a->low > 0.8)
		choose_log_ticks(a);
	else
		choose_linear_ticks(a);
}

/* ---- drawing ---- */

struct plot_drawing {
	cairo_t *c;
	struct axis x, y;
};

static void plot_set_colour(cairo_t *c, int colour)
{
	cairo_set_source_rgb(c, palette[colour][0], palette[colour][1], palette[colour][2]);
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
	const double left = x - share * text_width(c, text), base = y + 0.36 * TEXT_PX;

	cairo_save(c);
	cairo_move_to(c, left, base);
	cairo_text_path(c, text);
	cairo_set_source_rgba(c, 1, 1, 1, 0.85);
	cairo_set_line_width(c, 4);
	cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
	cairo_stroke(c);
	cairo_restore(c);
	cairo_move_to(c, left, base);
	cairo_show_text(c, text);
}

static void draw_tick(const struct plot_drawing *d, const struct axis *a, int k, bool across)
{
	const double value = a->tick[k], at = rint(axis_place(a, value)) + 0.5;
	char text[32];

	snprintf(text, sizeof(text), fabs(value) < 1e5 ? "%.4g" : "%.0f", value);
	cairo_set_source_rgb(d->c, 0.9, 0.9, 0.9);
	if (across) {
		cairo_move_to(d->c, at, d->y.from);
		cairo_line_to(d->c, at, d->y.to);
	} else {
		cairo_move_to(d->c, d->x.from, at);
		cairo_line_to(d->c, d->x.to, at);
	}
	cairo_stroke(d->c);
	cairo_set_source_rgb(d->c, 0.25, 0.25, 0.25);
	if (across)
		plot_draw_text(d->c, at, d->y.from + LINE_PX, 0.5, text);
	else
		plot_draw_text(d->c, d->x.from - 8, at, 1, text);
}

static void draw_axes(const struct plot_drawing *d, const struct report_plot *p)
{
	cairo_set_line_width(d->c, 1);
	for (int k = 0; k < d->x.ticks; k++)
		draw_tick(d, &d->x, k, true);
	for (int k = 0; k < d->y.ticks; k++)
		draw_tick(d, &d->y, k, false);
	cairo_set_source_rgb(d->c, 0.4, 0.4, 0.4);
	cairo_move_to(d->c, d->x.from, d->y.to);
	cairo_line_to(d->c, d->x.from, d->y.from);
	cairo_line_to(d->c, d->x.to, d->y.from);
	cairo_stroke(d->c);
	cairo_set_source_rgb(d->c, 0.1, 0.1, 0.1);
	plot_draw_text(d->c, (d->x.from + d->x.to) / 2, HEIGHT - 14, 0.5, p->x_label);
	cairo_save(d->c);
	cairo_translate(d->c, 14, (d->y.from + d->y.to) / 2);
	cairo_rotate(d->c, -M_PI / 2);
	plot_draw_text(d->c, 0, 0, 0.5, p->y_label);
	cairo_restore(d->c);
}

static void draw_lines(const struct plot_drawing *d, const struct report_series *s)
{
	static const double dashes[] = {6, 4};

	cairo_set_line_width(d->c, 2);
	if (s->style == STYLE_DASHED)
		cairo_set_dash(d->c, dashes, 2, 0);
	for (int k = 0; k < s->count; k++) {
		const double x = axis_place(&d->x, s->point[k].x),
			     y = axis_place(&d->y, s->point[k].y);

		if (k)
			cairo_line_to(d->c, x, y);
		else
			cairo_move_to(d->c, x, y);
	}
	cairo_stroke(d->c);
	cairo_set_dash(d->c, NULL, 0, 0);
}

static void draw_bar(const struct plot_drawing *d, const struct report_point *point, double x)
{
	if (!(point->y_high > point->y_low))
		return;
	cairo_set_line_width(d->c, 1.2);
	cairo_move_to(d->c, x, axis_place(&d->y, point->y_low));
	cairo_line_to(d->c, x, axis_place(&d->y, point->y_high));
	cairo_stroke(d->c);
}

static void draw_points(const struct plot_drawing *d, const struct report_series *s)
{
	for (int k = 0; k < s->count; k++) {
		const double x = axis_place(&d->x, s->point[k].x),
			     y = axis_place(&d->y, s->point[k].y);

		plot_set_colour(d->c, s->colour);
		draw_bar(d, &s->point[k], x);
		cairo_arc(d->c, x, y, s->style == STYLE_POINTS ? 3 : 3.5, 0, 2 * M_PI);
		cairo_fill(d->c);
		if (!s->point[k].ringed)
			continue;
		cairo_set_source_rgb(d->c, 0.1, 0.1, 0.1);
		cairo_set_line_width(d->c, 1.6);
		cairo_arc(d->c, x, y, 8, 0, 2 * M_PI);
		cairo_stroke(d->c);
	}
}

/* ---- names beside what they name ---- */

struct label {
	const struct report_series *series;
	double y;
};

static int label_upwards(const void *a, const void *b)
{
	const double x = ((const struct label *)a)->y, y = ((const struct label *)b)->y;

	return (x > y) - (x < y);
}

/* Draws the labels of series at their right ends, moved apart where they would overlap. */
static void draw_series_labels(const struct plot_drawing *d, const struct report_plot *p)
{
	struct label label[REPORT_SERIES_MAX] = {{.y = 0}};
	int count = 0;

	for (int k = 0; k < p->count; k++) {
		const struct report_series *s = &p->series[k];

		if (s->label[0] && s->count)
			label[count++] =
				(struct label){s, axis_place(&d->y, s->point[s->count - 1].y)};
	}
	qsort(label, (size_t)count, sizeof(*label), label_upwards);
	for (int k = 1; k < count; k++)
		label[k].y = fmax(label[k].y, label[k - 1].y + LINE_PX);
	for (int k = count - 1; k >= 0; k--) {
		const double below = k == count - 1 ? d->y.from : label[k + 1].y - LINE_PX;

		label[k].y = fmin(label[k].y, below);
	}
	for (int k = 0; k < count; k++) {
		plot_set_colour(d->c, label[k].series->colour);
		plot_draw_text(d->c, d->x.to + 8, label[k].y, 0, label[k].series->label);
	}
}

struct label_box {
	double x, y, width;
};

static bool is_box_free(const struct label_box *boxes, int count, const struct label_box *box)
{
	for (int k = 0; k < count; k++) {
		const struct label_box *b = &boxes[k];

		if (box->x < b->x + b->width && b->x < box->x + box->width &&
		    fabs(box->y - b->y) < LINE_PX - 1)
			return false;
	}
	return true;
}

/* Draws a label at the first free place around its point, on its right before its left. */
static void draw_point_label(const struct plot_drawing *d, const struct report_point *point,
			     int colour, struct label_box *taken, int *count)
{
	const double x = axis_place(&d->x, point->x), y = axis_place(&d->y, point->y);
	const double width = text_width(d->c, point->label);
	const double gap = point->ringed ? 13 : 8;
	const double at[][2] = {{x + gap, y - 10},	   {x + gap, y},
				{x + gap, y + 13},	   {x - gap - width, y + 13},
				{x - gap - width, y - 13}, {x - gap - width, y},
				{x + gap, y - 26},	   {x + gap, y + 26}};

	for (size_t k = 0; k < sizeof(at) / sizeof(*at) && *count < REPORT_POINTS_MAX; k++) {
		const struct label_box box = {at[k][0], at[k][1], width};

		if (box.x < d->x.from || box.x + width > WIDTH || box.y < ABOVE ||
		    box.y > d->y.from - 6 || !is_box_free(taken, *count, &box))
			continue;
		plot_set_colour(d->c, colour);
		plot_draw_text(d->c, box.x, box.y, 0, point->label);
		taken[(*count)++] = box;
		return;
	}
}

static void draw_point_labels(const struct plot_drawing *d, const struct report_plot *p)
{
	struct label_box taken[REPORT_POINTS_MAX];
	int count = 0;

	/* the setting in use comes first, so that its label finds a place */
	for (int first = 1; first >= 0; first--)
		for (int k = 0; k < p->count; k++)
			for (int n = 0; n < p->series[k].count; n++) {
				const struct report_point *point = &p->series[k].point[n];

				if (point->label[0] && point->ringed == (first == 1))
					draw_point_label(d, point,
							 point->ringed ? COLOURS - 1
								       : p->series[k].colour,
							 taken, &count);
			}
}

static void plot_draw(cairo_t *c, const struct report_plot *p)
{
	struct plot_drawing d = {.c = c,
				 .x = {.log = p->x_log, .low = INFINITY, .high = -INFINITY},
				 .y = {.log = p->y_log, .low = INFINITY, .high = -INFINITY}};
	double right = RIGHT_LEAST;

	cairo_select_font_face(c, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
	cairo_set_font_size(c, TEXT_PX);
	for (int k = 0; k < p->count; k++) {
		const struct report_series *s = &p->series[k];

		if (s->label[0])
			right = fmax(right, text_width(c, s->label) + 16);
		for (int n = 0; n < s->count; n++) {
			axis_include(&d.x, s->point[n].x);
			axis_include(&d.y, s->point[n].y_low);
			axis_include(&d.y, s->point[n].y_high);
		}
	}
	d.x.from = LEFT;
	d.x.to = WIDTH - right;
	d.y.from = HEIGHT - BELOW;
	d.y.to = ABOVE;
	finish_axis(&d.x, p, p->x_ticks);
	finish_axis(&d.y, p, 0);
	cairo_set_source_rgb(c, 1, 1, 1);
	cairo_paint(c);
	draw_axes(&d, p);
	for (int k = 0; k < p->count; k++) {
		plot_set_colour(c, p->series[k].colour);
		if (p->series[k].style != STYLE_POINTS)
			draw_lines(&d, &p->series[k]);
		draw_points(&d, &p->series[k]);
	}
	draw_series_labels(&d, p);
	draw_point_labels(&d, p);
}

int report_plot_write(struct report_plot *p, const char *folder, struct fault *fault)
{
	cairo_surface_t *surface;
	cairo_status_t status;
	char path[PATH_MAX];
	cairo_t *c;

	if (p->err)
		return fault_say(fault, p->err, "plot %s: %s", p->name, strerror(-p->err));
	snprintf(path, sizeof(path), "%s/%s.svg", folder, p->name);
	surface = cairo_svg_surface_create(path, WIDTH, HEIGHT);
	cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
	c = cairo_create(surface);
	plot_draw(c, p);
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
