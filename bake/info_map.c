/* SPDX-License-Identifier: MIT */
#include "bake/info_map.h"

#include <cairo.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/surface.h"
#include "hal/image/image.h"

#define PANELS 3
#define PANEL_LEAST 360	   /* pixels across that its texts need */
#define ENLARGED_MOST 1080 /* pixels down, at most, of a panel that is enlarged for them */
#define MARGIN 20
#define ABOVE 36 /* for a panel's title */
#define BELOW 58 /* for its bar */
#define BAR 12

static const char *const titles[PANELS] = {"patterns", "columns", "bytes"};
static const double paper[3] = {0.09, 0.09, 0.1}, ink[3] = {0.92, 0.92, 0.92};
static const double not_stored[3] = {0.26, 0.26, 0.28};

/* One number for each pixel, and their statistics. */
struct map_panel {
	float *value; /* [height][width]; negative: not stored */
	double mean, most;
	double top; /* value of the lightest colour, a round number */
};

struct map {
	int width, height, zoom;
	int across; /* width of a panel: of its picture or its texts, whichever is wider */
	struct map_panel panel[PANELS];
};

/* The smallest round number that is not below value: one of `steps` times a power of ten. A quarter
 * of it, a label of the bar, is round as well. */
static double round_up(double value)
{
	static const double steps[] = {1, 1.2, 1.6, 2, 2.4, 3.2, 4, 6, 8, 10};
	const double decade = pow(10, floor(log10(fmax(value, 1))));
	int k = 0;

	while (k < 9 && steps[k] * decade < value * (1 - 1e-9))
		k++;
	return steps[k] * decade;
}

static int float_ascending(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

/* Finds mean and largest value of the stored pixels. The colours end at the 99th percentile, so
 * that a few large values do not darken all others. */
static int panel_measure(struct map_panel *panel, size_t pixels)
{
	float *stored = malloc(pixels * sizeof(*stored));
	size_t count = 0;
	double sum = 0;

	if (!stored)
		return -ENOMEM;
	for (size_t i = 0; i < pixels; i++) {
		if (panel->value[i] < 0)
			continue;
		stored[count++] = panel->value[i];
		sum += (double)panel->value[i];
	}
	panel->top = 1;
	if (count) {
		qsort(stored, count, sizeof(*stored), float_ascending);
		panel->mean = sum / (double)count;
		panel->most = (double)stored[count - 1];
		panel->top = round_up((double)stored[(count - 1) * 99 / 100]);
	}
	free(stored);
	return 0;
}

static void map_add_block(struct map *map, const struct basis_tile *tile,
			  const struct basis_block *block)
{
	const float numbers[PANELS] = {(float)block->patterns, (float)block->columns,
				       (float)block->bytes / (float)block->pixels};

	for (int p = 0; p < block->pixels; p++) {
		const int x = tile->x + block->pixel[p] % BASIS_TILE;
		const int y = tile->y + block->pixel[p] / BASIS_TILE;
		const size_t at = (size_t)y * (size_t)map->width + (size_t)x;

		for (int k = 0; k < PANELS; k++)
			map->panel[k].value[at] = fmaxf(map->panel[k].value[at], 0) + numbers[k];
	}
}

static void free_map(struct map *map)
{
	for (int k = 0; k < PANELS; k++)
		free(map->panel[k].value);
}

static int fill_map(struct map *map, const struct basis *basis)
{
	const struct basis_layer *layer = &basis->poses[0].shown;
	const size_t pixels = (size_t)basis->info.width * basis->info.height;
	int ret = 0;

	map->width = (int)basis->info.width;
	map->height = (int)basis->info.height;
	map->zoom = (PANEL_LEAST + map->width - 1) / map->width;
	while (map->zoom > 1 && map->zoom * map->height > ENLARGED_MOST)
		map->zoom--;
	map->across = map->zoom * map->width < PANEL_LEAST ? PANEL_LEAST : map->zoom * map->width;
	for (int k = 0; k < PANELS; k++) {
		map->panel[k].value = malloc(pixels * sizeof(*map->panel[k].value));
		if (!map->panel[k].value)
			return -ENOMEM;
		for (size_t i = 0; i < pixels; i++)
			map->panel[k].value[i] = -1;
	}
	for (int t = 0; t < basis->tiles_across * basis->tiles_down; t++)
		for (int b = 0; b < layer->tiles[t].block_count; b++)
			map_add_block(map, &layer->tiles[t], &layer->tiles[t].blocks[b]);
	for (int k = 0; k < PANELS && ret == 0; k++)
		ret = panel_measure(&map->panel[k], pixels);
	return ret;
}

static uint32_t rgb_packed(const double rgb[3])
{
	return (uint32_t)lrint(255 * rgb[0]) << 16 | (uint32_t)lrint(255 * rgb[1]) << 8 |
	       (uint32_t)lrint(255 * rgb[2]);
}

/* Writes into the surface's memory, each pixel as a square of zoom x zoom. */
static void panel_draw_pixels(const struct map *map, const struct map_panel *panel,
			      cairo_surface_t *surface, int left, int top)
{
	const size_t stride = (size_t)cairo_image_surface_get_stride(surface);
	unsigned char *data;

	cairo_surface_flush(surface);
	data = cairo_image_surface_get_data(surface);
	for (int y = 0; y < map->height * map->zoom; y++) {
		unsigned char *row = data + (size_t)(top + y) * stride + (size_t)left * 4;
		const float *from = panel->value + (size_t)(y / map->zoom) * (size_t)map->width;

		for (int x = 0; x < map->width * map->zoom; x++) {
			const float value = from[x / map->zoom];
			double rgb[3];
			uint32_t pixel;

			surface_ramp((double)value / panel->top, rgb);
			pixel = rgb_packed(value < 0 ? not_stored : rgb);
			memcpy(row + (size_t)x * 4, &pixel, sizeof(pixel));
		}
	}
	cairo_surface_mark_dirty(surface);
}

/* x is the text's left end, middle or right end where align is 0, 0.5 or 1. */
static void map_draw_text(cairo_t *cairo, double x, double y, double align, const char *text)
{
	cairo_text_extents_t size;

	cairo_text_extents(cairo, text, &size);
	cairo_set_source_rgb(cairo, ink[0], ink[1], ink[2]);
	cairo_move_to(cairo, x - align * size.x_advance, y);
	cairo_show_text(cairo, text);
}

static void panel_draw_bar(cairo_t *cairo, const struct map_panel *panel, double left, double top,
			   double width)
{
	cairo_pattern_t *gradient = cairo_pattern_create_linear(left, 0, left + width, 0);
	char text[80];

	surface_ramp_stops(gradient);
	cairo_rectangle(cairo, left, top, width, BAR);
	cairo_set_source(cairo, gradient);
	cairo_fill(cairo);
	cairo_pattern_destroy(gradient);
	for (int k = 0; k <= 4; k++) {
		snprintf(text, sizeof(text), "%.4g%s", panel->top * k / 4,
			 k == 4 && panel->most > panel->top ? " or more" : "");
		map_draw_text(cairo, left + width * k / 4, top + BAR + 16,
			      k == 0   ? 0
			      : k == 4 ? 1
				       : 0.5,
			      text);
	}
}

static void map_draw_panel(const struct map *map, int index, cairo_t *cairo,
			   cairo_surface_t *surface)
{
	const struct map_panel *panel = &map->panel[index];
	const int left = MARGIN + index * (map->across + MARGIN);
	char text[120];

	panel_draw_pixels(map, panel, surface, left, ABOVE);
	snprintf(text, sizeof(text), "%s of a pixel: mean %.4g, most %.4g", titles[index],
		 panel->mean, panel->most);
	map_draw_text(cairo, left, ABOVE - 12, 0, text);
	panel_draw_bar(cairo, panel, left, ABOVE + map->height * map->zoom + 14, map->across);
}

static int draw_map(const struct map *map, struct image *image)
{
	const int width = MARGIN + PANELS * (map->across + MARGIN);
	cairo_surface_t *surface = cairo_image_surface_create(
		CAIRO_FORMAT_RGB24, width, ABOVE + map->height * map->zoom + BELOW);
	cairo_t *cairo = cairo_create(surface);
	int ret = cairo_surface_status(surface) == CAIRO_STATUS_INVALID_SIZE ? -EFBIG : -ENOMEM;

	if (cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS) {
		cairo_set_source_rgb(cairo, paper[0], paper[1], paper[2]);
		cairo_paint(cairo);
		cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
				       CAIRO_FONT_WEIGHT_NORMAL);
		cairo_set_font_size(cairo, 14);
		for (int k = 0; k < PANELS; k++)
			map_draw_panel(map, k, cairo, surface);
		ret = surface_to_image(surface, image);
	}
	cairo_destroy(cairo);
	cairo_surface_destroy(surface);
	return ret;
}

int info_map_write(const struct basis *basis, const char *path, struct fault *fault)
{
	struct image image = {.width = 0};
	struct map map = {.width = 0};
	int ret = fill_map(&map, basis);

	if (ret == 0)
		ret = draw_map(&map, &image);
	free_map(&map);
	if (ret < 0)
		return fault_say(fault, ret, "%s: a map of %u x %u pixels cannot be drawn: %s",
				 path, basis->info.width, basis->info.height, strerror(-ret));
	ret = image_write(path, &image, fault);
	image_free(&image);
	return ret;
}
