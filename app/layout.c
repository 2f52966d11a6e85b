#include "app/layout.h"

#include <math.h>
#include <string.h>

struct box layout_whole(const struct display_buffer *screen)
{
	return (struct box){0, 0, screen->width, screen->height};
}

/* The middle line of an odd size belongs to the later quarter. */
struct box layout_quarter(const struct display_buffer *screen, int quarter)
{
	int half_width = screen->width / 2, half_height = screen->height / 2;
	bool right = quarter % 2, down = quarter / 2;

	return (struct box){
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

struct box layout_box(const struct box *cell, int width, int height, double squash,
		      enum config_scale scale)
{
	double tall = height * squash, factor = 1;
	double fitting = fmin(cell->width / (double)width, cell->height / tall);
	struct box box;

	/* Pixels that are not square cannot be shown one by one: too large, they are fitted. */
	if (scale == SCALE_FIT || (squash != 1 && fitting < 1))
		factor = fitting;
	box.width = at_least_one(width * factor);
	box.height = at_least_one(tall * factor);
	box.x = cell->x + (cell->width - box.width) / 2;
	box.y = cell->y + (cell->height - box.height) / 2;
	return box;
}

bool layout_in_place(const struct box *cell, const struct box *box, int width, int height)
{
	return box->width == width && box->height == height && width <= cell->width &&
	       height <= cell->height;
}

static uint8_t *pixel_at(const struct display_buffer *screen, int x, int y)
{
	return screen->pixels + (size_t)y * screen->stride + (size_t)x * 4;
}

void layout_black(const struct display_buffer *screen, const struct box *box)
{
	for (int y = 0; y < box->height; y++)
		memset(pixel_at(screen, box->x, box->y + y), 0, (size_t)box->width * 4);
}

static int clamp(int value, int low, int high)
{
	return value < low ? low : value > high ? high : value;
}

void layout_border(const struct display_buffer *screen, const struct box *cell,
		   const struct box *box)
{
	int right = cell->x + cell->width, bottom = cell->y + cell->height;
	int x0 = clamp(box->x, cell->x, right), x1 = clamp(box->x + box->width, cell->x, right);
	int y0 = clamp(box->y, cell->y, bottom), y1 = clamp(box->y + box->height, cell->y, bottom);

	layout_black(screen, &(struct box){cell->x, cell->y, cell->width, y0 - cell->y});
	layout_black(screen, &(struct box){cell->x, y0, x0 - cell->x, y1 - y0});
	layout_black(screen, &(struct box){x1, y0, right - x1, y1 - y0});
	layout_black(screen, &(struct box){cell->x, y1, cell->width, bottom - y1});
}

/* The middle of a picture that is larger than its cell. */
static void place_cut(const struct display_buffer *screen, const struct box *cell,
		      const struct box *box, const struct picture *picture)
{
	struct picture part = *picture;
	int x = clamp(box->x, cell->x, cell->x + cell->width);
	int y = clamp(box->y, cell->y, cell->y + cell->height);

	part.origin += (x - box->x) * part.x_step + (y - box->y) * part.y_step;
	part.width = part.width < cell->width ? part.width : cell->width;
	part.height = part.height < cell->height ? part.height : cell->height;
	picture_copy(&part, pixel_at(screen, x, y), screen->stride);
}

int layout_place(const struct display_buffer *screen, const struct box *cell,
		 const struct picture *picture, double squash, enum config_scale scale,
		 struct scaler *scaler, struct pool *pool)
{
	struct box box;
	int err;

	if (cell->width < 1 || cell->height < 1)
		return 0;
	box = layout_box(cell, picture->width, picture->height, squash, scale);
	layout_border(screen, cell, &box);
	if (box.width == picture->width && box.height == picture->height) {
		place_cut(screen, cell, &box, picture);
		return 0;
	}
	err = scaler_fit(scaler, picture->width, picture->height, box.width, box.height, pool);
	if (err)
		return err;
	scaler_run(scaler, pool, picture, pixel_at(screen, box.x, box.y), screen->stride);
	return 0;
}
