/* SPDX-License-Identifier: MIT */
#include "app/view/panel.h"

#include <cairo.h>
#include <math.h>
#include <stdlib.h>

#define FONT "DejaVu Sans"
#define EDGE_ALPHA 0.55 /* of the dark edge */

struct pen {
	cairo_surface_t *surface; /* on the canvas's memory */
	cairo_t *cairo;
	double width, height;	 /* of the canvas */
	double line_px, edge_px; /* usual width of a line; of its edge, on both sides together */
};

struct pen *pen_take(const struct canvas *canvas, double letter_px)
{
	struct pen *pen = calloc(1, sizeof(*pen));

	if (!pen)
		return NULL;
	pen->surface = cairo_image_surface_create_for_data(canvas->pixels, CAIRO_FORMAT_RGB24,
							   canvas->width, canvas->height,
							   (int)canvas->stride);
	pen->cairo = cairo_create(pen->surface);
	if (cairo_status(pen->cairo)) {
		pen_drop(pen);
		return NULL;
	}
	pen->width = canvas->width;
	pen->height = canvas->height;
	pen->line_px = fmax(1, letter_px / 8);
	pen->edge_px = fmax(1.5, letter_px / 8);
	cairo_set_line_cap(pen->cairo, CAIRO_LINE_CAP_ROUND);
	cairo_set_line_join(pen->cairo, CAIRO_LINE_JOIN_ROUND);
	cairo_select_font_face(pen->cairo, FONT, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_BOLD);
	cairo_set_font_size(pen->cairo, letter_px);
	return pen;
}

void pen_drop(struct pen *pen)
{
	if (!pen)
		return;
	cairo_destroy(pen->cairo);
	cairo_surface_destroy(pen->surface);
	free(pen);
}

/* Strokes the path in its colour over a dark, wider one. */
static void pen_stroke(struct pen *pen, const double rgb[3], double width_px)
{
	cairo_set_source_rgba(pen->cairo, 0, 0, 0, EDGE_ALPHA);
	cairo_set_line_width(pen->cairo, width_px + pen->edge_px);
	cairo_stroke_preserve(pen->cairo);
	cairo_set_source_rgb(pen->cairo, rgb[0], rgb[1], rgb[2]);
	cairo_set_line_width(pen->cairo, width_px);
	cairo_stroke(pen->cairo);
}

/* Whether cairo's fixed point holds a coordinate. */
static bool is_drawable(const double point[2])
{
	return fabs(point[0]) < 1e5 && fabs(point[1]) < 1e5;
}

void pen_line(struct pen *pen, const double (*points)[2], int count, const double rgb[3],
	      double width)
{
	bool on = false;

	if (!pen)
		return;
	for (int i = 0; i < count; i++) {
		if (!is_drawable(points[i])) {
			on = false;
			continue;
		}
		if (on)
			cairo_line_to(pen->cairo, points[i][0], points[i][1]);
		else
			cairo_move_to(pen->cairo, points[i][0], points[i][1]);
		on = true;
	}
	pen_stroke(pen, rgb, width * pen->line_px);
}

void pen_ring(struct pen *pen, const double centre[2], double radius, const double rgb[3])
{
	if (!pen || !is_drawable(centre))
		return;
	cairo_new_sub_path(pen->cairo);
	cairo_arc(pen->cairo, centre[0], centre[1], radius, 0, 2 * M_PI);
	pen_stroke(pen, rgb, pen->line_px);
}

void pen_text(struct pen *pen, const double at[2], const char *text, const double rgb[3])
{
	cairo_text_extents_t size;
	double x, y;

	if (!pen || !is_drawable(at))
		return;
	cairo_text_extents(pen->cairo, text, &size);
	x = at[0] - size.width / 2;
	y = at[1] - size.height / 2;
	x = fmax(pen->edge_px, fmin(x, pen->width - size.width - pen->edge_px));
	y = fmax(pen->edge_px, fmin(y, pen->height - size.height - pen->edge_px));
	cairo_move_to(pen->cairo, x - size.x_bearing, y - size.y_bearing);
	cairo_text_path(pen->cairo, text);
	cairo_set_source_rgba(pen->cairo, 0, 0, 0, EDGE_ALPHA);
	cairo_set_line_width(pen->cairo, 2 * pen->edge_px);
	cairo_stroke_preserve(pen->cairo);
	cairo_set_source_rgb(pen->cairo, rgb[0], rgb[1], rgb[2]);
	cairo_fill(pen->cairo);
}
