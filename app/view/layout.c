/* SPDX-License-Identifier: MIT */
#include "app/view/layout.h"

#include <math.h>
#include <string.h>

#define LINE_HEIGHTS 480 /* height of the picture over a third of the line's width */

struct layout_box layout_whole(const struct display_buffer *screen)
{
	return (struct layout_box){0, 0, screen->width, screen->height};
}

/* The middle line of an odd size belongs to the later quarter. */
struct layout_box layout_half(const struct display_buffer *screen, int half)
{
	const bool beside = screen->width >= screen->height;
	const int side = beside ? screen->width : screen->height;
	const int from = half ? side / 2 : 0, length = half ? side - side / 2 : side / 2;

	if (beside)
		return (struct layout_box){from, 0, length, screen->height};
	return (struct layout_box){0, from, screen->width, length};
}

struct layout_box layout_quarter(const struct display_buffer *screen, int quarter)
{
	int half_width = screen->width / 2, half_height = screen->height / 2;
	bool right = quarter % 2, down = quarter / 2;

	return (struct layout_box){
		.x = right ? half_width : 0,
		.y = down ? half_height : 0,
		.width = right ? screen->width - half_width : half_width,
		.height = down ? screen->height - half_height : half_height,
	};
}

static int at_least_one(double length)
{
	return length < 1 ? 1 : (int)lrint(length);
}

struct layout_box layout_box(const struct layout_box *cell, int width, int height, double squash,
			     enum config_scale scale)
{
	double tall = height * squash, factor = 1;
	double fitting = fmin(cell->width / (double)width, cell->height / tall);
	struct layout_box box;

	/* Pixels that are not square have to be scaled anyway: a picture that is too large is
	 * fitted. */
	if (scale == SCALE_FIT || (squash != 1 && fitting < 1))
		factor = fitting;
	box.width = at_least_one(width * factor);
	box.height = at_least_one(tall * factor);
	box.x = cell->x + (cell->width - box.width) / 2;
	box.y = cell->y + (cell->height - box.height) / 2;
	return box;
}

bool layout_in_place(const struct layout_box *cell, const struct layout_box *box, int width,
		     int height)
{
	return box->width == width && box->height == height && width <= cell->width &&
	       height <= cell->height;
}

static uint8_t *pixel_at(const struct display_buffer *screen, int x, int y)
{
	return screen->pixels + (size_t)y * screen->stride + (size_t)x * 4;
}

void layout_black(const struct display_buffer *screen, const struct layout_box *box)
{
	for (int y = 0; y < box->height; y++)
		memset(pixel_at(screen, box->x, box->y + y), 0, (size_t)box->width * 4);
}

static int clamp_int(int value, int low, int high)
{
	return value < low ? low : value > high ? high : value;
}

/* The part of the box that is in the cell. */
static struct layout_box visible_part(const struct layout_box *cell, const struct layout_box *box)
{
	int right = cell->x + cell->width, bottom = cell->y + cell->height;
	int x0 = clamp_int(box->x, cell->x, right),
	    x1 = clamp_int(box->x + box->width, cell->x, right);
	int y0 = clamp_int(box->y, cell->y, bottom),
	    y1 = clamp_int(box->y + box->height, cell->y, bottom);

	return (struct layout_box){x0, y0, x1 - x0, y1 - y0};
}

void layout_border(const struct display_buffer *screen, const struct layout_box *cell,
		   const struct layout_box *box)
{
	const struct layout_box in = visible_part(cell, box);
	int right = in.x + in.width, bottom = in.y + in.height;

	layout_black(screen, &(struct layout_box){cell->x, cell->y, cell->width, in.y - cell->y});
	layout_black(screen, &(struct layout_box){cell->x, in.y, in.x - cell->x, in.height});
	layout_black(screen,
		     &(struct layout_box){right, in.y, cell->x + cell->width - right, in.height});
	layout_black(screen, &(struct layout_box){cell->x, bottom, cell->width,
						  cell->y + cell->height - bottom});
}

int layout_fill(const struct display_buffer *screen, const struct layout_box *cell,
		const struct layout_box *box, const struct layout_span *columns,
		const struct picture *picture, struct scaler *scaler, struct pool *pool)
{
	struct layout_box in = visible_part(cell, box);
	int from = clamp_int(columns->from, in.x, in.x + in.width);
	int to = clamp_int(columns->to, from, in.x + in.width), err;
	uint8_t *out = pixel_at(screen, from, in.y);

	if (from == to || in.height == 0)
		return 0;
	if (box->width == picture->width && box->height == picture->height) {
		struct picture part = *picture;

		/* Cuts out the middle where the picture is larger than its cell. */
		part.origin += (from - box->x) * part.x_step + (in.y - box->y) * part.y_step;
		part.width = to - from;
		part.height = in.height;
		picture_copy(&part, out, screen->stride);
		return 0;
	}
	err = scaler_fit(scaler, picture->width, picture->height, box->width, box->height, pool);
	if (err)
		return err;
	scaler_run(scaler, pool, picture, from - box->x, to - box->x, out, screen->stride);
	return 0;
}

int layout_place(const struct display_buffer *screen, const struct layout_box *cell,
		 const struct picture *picture, double squash, enum config_scale scale,
		 struct scaler *scaler, struct pool *pool)
{
	const struct layout_span all = {cell->x, cell->x + cell->width};
	struct layout_box box;

	if (cell->width < 1 || cell->height < 1)
		return 0;
	box = layout_box(cell, picture->width, picture->height, squash, scale);
	layout_border(screen, cell, &box);
	return layout_fill(screen, cell, &box, &all, picture, scaler, pool);
}

/* ---- the line of a split picture ---- */

/* A third of the width is each black edge. */
static int line_width_px(int height)
{
	int third = (height + LINE_HEIGHTS / 2) / LINE_HEIGHTS;

	return 3 * (third < 1 ? 1 : third);
}

struct layout_span layout_line(const struct layout_box *cell, const struct layout_box *box,
			       double split)
{
	const struct layout_box in = visible_part(cell, box);
	int width = line_width_px(in.height), from;

	if (width > in.width)
		width = in.width;
	from = in.x + (int)lrint(split * in.width) - width / 2;
	from = clamp_int(from, in.x, in.x + in.width - width);
	return (struct layout_span){from, from + width};
}

void layout_draw_line(const struct display_buffer *screen, const struct layout_box *cell,
		      const struct layout_box *box, const struct layout_span *line)
{
	const struct layout_box in = visible_part(cell, box);
	int width = line->to - line->from, edge = width / 3;

	for (int y = in.y; y < in.y + in.height; y++) {
		uint8_t *row = pixel_at(screen, line->from, y);

		memset(row, 0, (size_t)edge * 4);
		memset(row + (size_t)edge * 4, 255, (size_t)(width - 2 * edge) * 4);
		memset(row + (size_t)(width - edge) * 4, 0, (size_t)edge * 4);
	}
}
