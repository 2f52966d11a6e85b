/* SPDX-License-Identifier: MIT */
#include "app/view/panel.h"

#include <cairo.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/view/typeset.h"
#include "hal/frame/frame.h"

#define FONT "DejaVu Sans"

/* Luminances far apart, so that nothing depends on hue alone. */
static const double back_rgb[3] = {0.06, 0.07, 0.09};
static const double edge_rgb[3] = {0.45, 0.47, 0.50};
static const double text_rgb[3] = {0.95, 0.95, 0.93};
static const double mark_rgb[3] = {1.00, 0.78, 0.20};

struct panel {
	enum panel_kind kind;
	struct canvas canvas;
	cairo_surface_t *surface; /* on the canvas's memory */
	cairo_t *cairo;
	int width, height; /* of the box in the canvas; 0: nothing was drawn */
	struct typeset set;
};

/* ---- memory ---- */

static void let_go(struct panel *panel)
{
	if (panel->cairo)
		cairo_destroy(panel->cairo);
	if (panel->surface)
		cairo_surface_destroy(panel->surface);
	panel->cairo = NULL;
	panel->surface = NULL;
	canvas_free(&panel->canvas);
}

static void set_font(cairo_t *cairo)
{
	cairo_font_options_t *options = cairo_font_options_create();

	/* Whole pixels: letters look the same wherever they stand. No subpixel rendering: the
	 * screen may be behind a scaler. */
	cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_ON);
	cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_SLIGHT);
	cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
	cairo_set_font_options(cairo, options);
	cairo_font_options_destroy(options);
	cairo_select_font_face(cairo, FONT, CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
}

/* Makes the canvas at least this large. */
static int fit_surface(struct panel *panel, int width, int height)
{
	struct canvas *canvas = &panel->canvas;
	int err;

	if (panel->cairo && canvas->width >= width && canvas->height >= height)
		return 0;
	width = width > canvas->width ? width : canvas->width;
	height = height > canvas->height ? height : canvas->height;
	let_go(panel);
	err = canvas_create(canvas, width, height);
	if (err)
		return err;
	panel->surface = cairo_image_surface_create_for_data(canvas->pixels, CAIRO_FORMAT_ARGB32,
							     width, height, (int)canvas->stride);
	panel->cairo = cairo_create(panel->surface);
	if (cairo_status(panel->cairo)) {
		let_go(panel);
		return -ENOMEM;
	}
	set_font(panel->cairo);
	return 0;
}

int panel_create(struct panel **panel, enum panel_kind kind)
{
	struct panel *p = calloc(1, sizeof(*p));

	*panel = p;
	if (!p)
		return -ENOMEM;
	p->kind = kind;
	return 0;
}

void panel_destroy(struct panel *panel)
{
	if (!panel)
		return;
	let_go(panel);
	free(panel);
}

struct picture panel_picture(const struct panel *panel)
{
	return (struct picture){.origin = panel->canvas.pixels,
				.x_step = 4,
				.y_step = (ptrdiff_t)panel->canvas.stride,
				.width = panel->width,
				.height = panel->height};
}

/* ---- painting ---- */

static void set_source_colour(cairo_t *cairo, const double rgb[3])
{
	cairo_set_source_rgb(cairo, rgb[0], rgb[1], rgb[2]);
}

/* A box with an edge: all around, or above a strip. */
static void paint_box(const struct panel *panel)
{
	cairo_t *cairo = panel->cairo;
	double edge = fmax(1, panel->set.size_px / 16);
	bool strip = panel->kind == PANEL_STRIP;
	double side = strip ? 0 : edge, below = strip ? 0 : edge;

	set_source_colour(cairo, edge_rgb);
	cairo_rectangle(cairo, 0, 0, panel->width, panel->height);
	cairo_fill(cairo);
	set_source_colour(cairo, back_rgb);
	cairo_rectangle(cairo, side, edge, panel->width - 2 * side, panel->height - edge - below);
	cairo_fill(cairo);
}

/* A triangle with an exclamation mark cut out, as high as a capital letter. */
static void paint_mark(cairo_t *cairo, double x, double base, double size)
{
	double high = 0.8 * size, half = 0.47 * size, middle = x + half;

	set_source_colour(cairo, mark_rgb);
	cairo_move_to(cairo, middle, base - high);
	cairo_line_to(cairo, middle + half, base);
	cairo_line_to(cairo, middle - half, base);
	cairo_close_path(cairo);
	cairo_fill(cairo);
	set_source_colour(cairo, back_rgb);
	cairo_rectangle(cairo, middle - 0.05 * size, base - 0.55 * size, 0.1 * size, 0.3 * size);
	cairo_rectangle(cairo, middle - 0.05 * size, base - 0.18 * size, 0.1 * size, 0.1 * size);
	cairo_fill(cairo);
}

static int paint_lines(struct panel *panel)
{
	const struct typeset *set = &panel->set;
	const struct typeset_run *run = &set->run;
	int current = -1, base = set->pad + set->ascent_px;

	for (int i = 0; i < set->count; i++, base += set->line_px) {
		const struct typeset_line *line = &set->lines[i];
		double x = 2 * set->pad;

		if (line->text != current) {
			int err = typeset_run(&panel->set, panel->cairo, line->text);

			if (err)
				return err;
			current = line->text;
		}
		if (line->first == 0 && line->text < set->marked)
			paint_mark(panel->cairo, x, base, set->size_px);
		set_source_colour(panel->cairo, text_rgb);
		cairo_save(panel->cairo);
		cairo_translate(panel->cairo, x + set->indent - run->glyph[line->first].x, base);
		cairo_show_glyphs(panel->cairo, run->glyph + line->first, line->count);
		cairo_restore(panel->cairo);
	}
	return 0;
}

static int box_width(const struct panel *panel)
{
	const struct typeset *set = &panel->set;
	double widest = 0;

	if (panel->kind == PANEL_STRIP)
		return set->room.width;
	for (int i = 0; i < set->count; i++)
		widest = fmax(widest, set->lines[i].width);
	return (int)fmin(set->room.width, ceil(widest) + set->indent + 4 * set->pad);
}

static int paint_panel(struct panel *panel)
{
	int err = fit_surface(panel, box_width(panel), typeset_height_px(&panel->set));

	if (err)
		return err;
	panel->width = box_width(panel);
	panel->height = typeset_height_px(&panel->set);
	cairo_set_font_size(panel->cairo, panel->set.size_px);
	paint_box(panel);
	err = paint_lines(panel);
	cairo_surface_flush(panel->surface);
	return err ? err : cairo_status(panel->cairo) ? -ENOMEM : 0;
}

int panel_draw(struct panel *panel, const char (*texts)[PANEL_TEXT_MAX], int count,
	       const struct panel_room *room)
{
	struct typeset *set = &panel->set;
	bool again = panel->kind == PANEL_STRIP && panel->width && count == set->text_count &&
		     !memcmp(room, &set->room, sizeof(*room));
	int err;

	panel->width = panel->height = 0;
	if (count < 1 || room->width < 1 || room->height < 1)
		return 0;
	set->text_count = count < PANEL_TEXTS_MAX ? count : PANEL_TEXTS_MAX;
	set->marked = panel->kind == PANEL_WARNING ? set->text_count : 0;
	for (int i = 0; i < set->text_count; i++)
		set->texts[i] = texts[i];
	set->room = *room;
	err = fit_surface(panel, 1, 1); /* letters are measured on a canvas */
	if (!err)
		err = typeset(set, panel->cairo, again);
	if (!err && set->count)
		err = paint_panel(panel);
	if (err)
		panel->width = panel->height = 0;
	return err;
}
