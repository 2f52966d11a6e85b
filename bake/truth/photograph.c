/* SPDX-License-Identifier: MIT */
#include "bake/truth/photograph.h"

#include <errno.h>
#include <math.h>
#include <string.h>

int photograph_read(const char *path, const struct scene *scene, struct image *picture,
		    struct fault *fault)
{
	const struct tsai_camera *camera = &scene->camera;
	int err = image_read(path, picture, fault);

	if (err)
		return err;
	if (picture->width != camera->width || picture->height != camera->height) {
		err = fault_say(fault, -EINVAL,
				"%s: %d x %d pixels, expected %d x %d as the camera of %s has",
				path, picture->width, picture->height, camera->width,
				camera->height, scene->path);
		image_free(picture);
	}
	return err;
}

int photograph_encode(const struct image *linear, const struct transfer_curve *curve,
		      struct image *out)
{
	const size_t values = 3 * (size_t)linear->width * (size_t)linear->height;
	const int err = image_create_u8(out, linear->width, linear->height);

	for (size_t i = 0; !err && i < values; i++)
		out->u8[i] =
			(uint8_t)lround(255 * transfer_curve_encode(curve, (double)linear->f32[i]));
	return err;
}

int photograph_decode(const struct image *coded, const struct transfer_curve *curve,
		      struct image *out)
{
	const size_t values = 3 * (size_t)coded->width * (size_t)coded->height;
	const int err = image_create_f32(out, coded->width, coded->height);

	for (size_t i = 0; !err && i < values; i++)
		out->f32[i] = (float)transfer_curve_decode(curve, coded->u8[i] / 255.0);
	return err;
}

int photograph_write(const char *path, const struct image *linear,
		     const struct transfer_curve *curve, struct fault *fault)
{
	struct image coded;
	int err = image_name_linear(path, fault);

	if (err < 0)
		return err;
	if (err)
		return image_write(path, linear, fault);
	err = photograph_encode(linear, curve, &coded);
	if (err)
		return fault_say(fault, err, "%s: %s", path, strerror(-err));
	err = image_write(path, &coded, fault);
	image_free(&coded);
	return err;
}
