/* SPDX-License-Identifier: MIT */
#include "app/view/show.h"

#include <math.h>

#define HEIGHT_PER_SIDE 120
#define SHOWN_SIDE_PX 3
#define SIDE_LEAST_PX 2

int mark_side_px(int picture_height, int shown_height)
{
	int side = (picture_height + HEIGHT_PER_SIDE / 2) / HEIGHT_PER_SIDE;
	int visible = (SHOWN_SIDE_PX * picture_height + shown_height - 1) / shown_height;

	if (side < visible)
		side = visible;
	return side < SIDE_LEAST_PX ? SIDE_LEAST_PX : side;
}

/* Fills a half-open square, cut at the canvas's border: a light on the horizon lies on the edge of
 * the image circle. */
static void fill_square(struct canvas *canvas, int left, int top, int side, const uint8_t bgr[3])
{
	for (int y = top < 0 ? 0 : top; y < top + side && y < canvas->height; y++) {
		uint8_t *row = canvas->pixels + (size_t)y * canvas->stride;

		for (int x = left < 0 ? 0 : left; x < left + side && x < canvas->width; x++) {
			for (int c = 0; c < 3; c++)
				row[4 * x + c] = bgr[c];
		}
	}
}

void marks_draw(struct canvas *canvas, const struct dome *dome, const struct fisheye *lens,
		const bool *used, int side_px)
{
	static const uint8_t colour[2][3] = {MARK_UNUSED_BGR, MARK_USED_BGR};

	for (int i = 0; i < dome->count; i++) {
		double px[2];

		if (!fisheye_project(lens, dome->direction[i], px))
			continue;
		fill_square(canvas, (int)lrint(px[0] - side_px / 2.0),
			    (int)lrint(px[1] - side_px / 2.0), side_px, colour[used[i]]);
	}
}
