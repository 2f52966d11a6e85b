/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/observe/live_screen.h"

#include <cairo.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/drivers.h"

#define TEXT_SHARE 0.045 /* height of the text, as a share of the screen's height */

int live_screen_open(struct live_screen *screen, struct live *live, struct fault *fault)
{
	struct config *config = live_config(live);
	struct display_settings settings = config->screen->settings;
	const int driver = config_driver_index(config, CONFIG_DISPLAY, config->screen->driver);
	struct fault why = {{0}};
	int err;

	*screen = (struct live_screen){.width = live_width(live),
				       .height = live_height(live),
				       .squash = live_squash(live)};
	if (driver < 0)
		return fault_say(fault, -EINVAL, "%s: [screen] driver: there is no driver \"%s\"",
				 config->name, config->screen->driver);
	settings.picture_width = screen->width;
	settings.picture_height = (int)lround(screen->height * screen->squash);
	err = display_open(&screen->display, display_drivers[driver], &settings,
			   config_options(config, CONFIG_DISPLAY, config->screen, driver), &why);
	if (err)
		return fault_say(fault, err == -ENOMEM ? err : -ENODEV, "screen: %s: %s",
				 display_situation_names[screen->display.situation], why.text);
	screen->picture = malloc(4 * (size_t)screen->width * (size_t)screen->height);
	screen->page = malloc(4 * (size_t)screen->display.width * (size_t)screen->display.height);
	if (screen->picture && screen->page)
		return 0;
	(void)live_screen_close(screen, NULL);
	return fault_say(fault, -ENOMEM, "screen: out of memory");
}

int live_screen_close(struct live_screen *screen, struct fault *fault)
{
	const int err = display_close(&screen->display, fault);

	free(screen->picture);
	free(screen->page);
	screen->picture = screen->page = NULL;
	return err;
}

/* ---- drawing ---- */

static void draw_picture(cairo_t *cr, struct live_screen *screen, const struct image *picture)
{
	const size_t pixels = (size_t)screen->width * (size_t)screen->height;
	cairo_surface_t *surface;

	for (size_t i = 0; i < pixels; i++) {
		screen->picture[4 * i] = picture->u8[3 * i + 2];
		screen->picture[4 * i + 1] = picture->u8[3 * i + 1];
		screen->picture[4 * i + 2] = picture->u8[3 * i];
		screen->picture[4 * i + 3] = 255;
	}
	surface = cairo_image_surface_create_for_data(screen->picture, CAIRO_FORMAT_RGB24,
						      screen->width, screen->height,
						      4 * screen->width);
	cairo_set_source_surface(cr, surface, 0, 0);
	cairo_paint(cr);
	cairo_surface_destroy(surface);
}

static void draw_cover(cairo_t *cr, const struct live_screen *screen,
		       const struct live_scene *scene)
{
	const double width = (double)screen->width / COVER_COLUMNS;
	const double height = (double)screen->height / COVER_ROWS;

	for (int r = 0; r < COVER_ROWS; r++)
		for (int c = 0; c < COVER_COLUMNS; c++) {
			cairo_rectangle(cr, c * width, r * height, width, height);
			cairo_set_source_rgba(cr, 0, 1, 0, scene->covered[r][c] ? 0.18 : 0);
			cairo_fill_preserve(cr);
			cairo_set_source_rgba(cr, 1, 1, 1, 0.3);
			cairo_stroke(cr);
		}
}

/* The first corner has a larger circle, to show from where the board is counted. */
static void draw_corners(cairo_t *cr, const struct live_screen *screen,
			 const struct live_scene *scene)
{
	const double radius = fmax(2, 0.006 * screen->width);

	cairo_set_line_width(cr, fmax(1, 0.0025 * screen->width));
	if (scene->taken)
		cairo_set_source_rgb(cr, 0.2, 1, 0.2);
	else
		cairo_set_source_rgb(cr, 1, 0.7, 0);
	for (int i = 0; i < scene->corners; i++) {
		const double *px = scene->corner[i].px;

		cairo_new_sub_path(cr);
		cairo_arc(cr, px[0], px[1], i ? radius : 2 * radius, 0, 2 * M_PI);
		cairo_stroke(cr);
	}
}

static void draw_caption(cairo_t *cr, const struct live_screen *screen, const char *text)
{
	const double size = TEXT_SHARE * screen->display.height;

	cairo_identity_matrix(cr);
	cairo_rectangle(cr, 0, screen->display.height - 1.8 * size, screen->display.width,
			1.8 * size);
	cairo_set_source_rgba(cr, 0, 0, 0, 0.6);
	cairo_fill(cr);
	cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
	cairo_set_font_size(cr, size);
	cairo_set_source_rgb(cr, 1, 1, 1);
	cairo_move_to(cr, 0.6 * size, screen->display.height - 0.6 * size);
	cairo_show_text(cr, text);
}

/* The picture fills the screen as far as its aspect ratio allows. */
static void draw_scene(struct live_screen *screen, const struct live_scene *scene)
{
	const int width = screen->display.width, height = screen->display.height;
	cairo_surface_t *surface = cairo_image_surface_create_for_data(
		screen->page, CAIRO_FORMAT_RGB24, width, height, 4 * width);
	const double tall = screen->height * screen->squash;
	const double scale = fmin((double)width / screen->width, height / tall);
	cairo_t *cr = cairo_create(surface);

	cairo_paint(cr); /* black */
	cairo_translate(cr, (width - scale * screen->width) / 2, (height - scale * tall) / 2);
	cairo_scale(cr, scale, scale * screen->squash);
	draw_picture(cr, screen, scene->picture);
	draw_cover(cr, screen, scene);
	draw_corners(cr, screen, scene);
	draw_caption(cr, screen, scene->text);
	cairo_destroy(cr);
	cairo_surface_flush(surface);
	cairo_surface_destroy(surface);
}

/* ---- showing ---- */

static int take_events(struct live_screen *screen, struct fault *fault)
{
	struct display_event event;
	int err;

	do {
		err = display_dispatch(&screen->display, &event, fault);
		if (!err && event.kind == DISPLAY_CLOSED)
			err = fault_say(fault, -ECANCELED, "the window was closed");
	} while (!err && event.kind != DISPLAY_NOTHING);
	return err;
}

int live_screen_show(struct live_screen *screen, const struct live_scene *scene,
		     struct fault *fault)
{
	struct display_buffer buffer;
	int err = take_events(screen, fault);

	if (err)
		return err;
	err = display_acquire(&screen->display, &buffer);
	if (err == -EAGAIN)
		return 0;
	if (err)
		return fault_say(fault, err, "screen: %s",
				 display_situation_names[screen->display.situation]);
	draw_scene(screen, scene);
	for (int y = 0; y < buffer.height && y < screen->display.height; y++)
		memcpy(buffer.pixels + (size_t)y * buffer.stride,
		       screen->page + 4 * (size_t)y * (size_t)screen->display.width,
		       4 * (size_t)screen->display.width);
	return display_submit(&screen->display, &buffer, 0, fault);
}
