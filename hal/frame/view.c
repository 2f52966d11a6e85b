/* SPDX-License-Identifier: MIT */
#include "hal/frame/view.h"

#include <errno.h>
#include <math.h>

int view_resolve(struct view *view, int camera_width, int camera_height, struct fault *fault)
{
	struct view v = *view;

	if (camera_width < 1 || camera_height < 1)
		return fault_say(fault, -EINVAL,
				 "view: the camera's picture is %d x %d, expected at least 1 x 1",
				 camera_width, camera_height);
	if (v.x < 0 || v.y < 0 || v.x >= camera_width || v.y >= camera_height)
		return fault_say(
			fault, -EINVAL,
			"view: corner (%d, %d) lies outside the camera's picture of %d x %d pixels",
			v.x, v.y, camera_width, camera_height);
	if (v.width == 0)
		v.width = camera_width - v.x;
	if (v.height == 0)
		v.height = camera_height - v.y;
	if (v.width < 1 || v.height < 1 || v.width > camera_width - v.x ||
	    v.height > camera_height - v.y)
		return fault_say(
			fault, -EINVAL,
			"view: %d x %d pixels from corner (%d, %d) do not fit into the camera's picture of %d x %d",
			v.width, v.height, v.x, v.y, camera_width, camera_height);
	if (!(v.squash > 0) || !isfinite(v.squash))
		return fault_say(fault, -EINVAL, "view: squash is %g, expected a number above 0",
				 v.squash);
	*view = v;
	return 0;
}

struct picture view_picture(const struct view *view, const uint8_t *pixels, size_t stride)
{
	const ptrdiff_t column = 4, row = (ptrdiff_t)stride;
	const int left = view->hflip ? view->x + view->width - 1 : view->x;
	const int top = view->vflip ? view->y + view->height - 1 : view->y;

	return (struct picture){
		.origin = pixels + top * row + left * column,
		.x_step = view->hflip ? -column : column,
		.y_step = view->vflip ? -row : row,
		.width = view->width,
		.height = view->height,
	};
}
