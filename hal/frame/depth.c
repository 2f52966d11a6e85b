/* SPDX-License-Identifier: MIT */
#include "hal/frame/depth.h"

#include <errno.h>

enum { WORD = 2 }; /* bytes */

/* The whole frame, turned upright. */
static void map_turned(struct depth_map *map, const struct frame *frame, enum picture_turn turn)
{
	const ptrdiff_t stride = (ptrdiff_t)frame->planes[0].stride;
	const ptrdiff_t right = (ptrdiff_t)WORD * (frame->width - 1);
	const ptrdiff_t lower = stride * (frame->height - 1);
	/* Where the turned picture's upper left pixel is, and the steps to its right and down. */
	const struct {
		ptrdiff_t corner, x_step, y_step;
	} turned[PICTURE_TURN_COUNT] = {
		[PICTURE_UPRIGHT] = {0, WORD, stride},
		[PICTURE_TURN_90] = {lower, -stride, WORD},
		[PICTURE_TURN_180] = {lower + right, -WORD, -stride},
		[PICTURE_TURN_270] = {right, stride, -WORD},
	};
	const bool sideways = picture_turn_is_sideways(turn);

	map->origin = frame->planes[0].data + turned[turn].corner;
	map->x_step = turned[turn].x_step;
	map->y_step = turned[turn].y_step;
	map->width = sideways ? frame->height : frame->width;
	map->height = sideways ? frame->width : frame->height;
}

int depth_map_of(struct depth_map *map, const struct frame *frame, enum picture_turn turn,
		 const struct view *view, double unit_m, struct fault *fault)
{
	int err;

	if (frame->format != PIXEL_Z16 || frame->fields != FIELDS_NONE)
		return fault_say(fault, -ENOTSUP, "the camera sends %s, expected Z16",
				 pixel_format_names[frame->format]);
	err = frame_check(frame, fault);
	if (err)
		return err;
	map_turned(map, frame, turn);
	if (view->x < 0 || view->y < 0 || view->width < 1 || view->height < 1 ||
	    view->x > map->width - view->width || view->y > map->height - view->height)
		return fault_say(fault, -EINVAL, "a view that is not inside of %dx%d", map->width,
				 map->height);
	map->origin += (view->hflip ? view->x + view->width - 1 : view->x) * map->x_step +
		       (view->vflip ? view->y + view->height - 1 : view->y) * map->y_step;
	map->x_step = view->hflip ? -map->x_step : map->x_step;
	map->y_step = view->vflip ? -map->y_step : map->y_step;
	map->width = view->width;
	map->height = view->height;
	map->unit_m = unit_m;
	return 0;
}

double depth_map_at(const struct depth_map *map, int x, int y)
{
	const uint8_t *word = map->origin + x * map->x_step + y * map->y_step;

	return (word[0] | word[1] << 8) * map->unit_m;
}
