/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/budget.h"
#include "hal/image/codec.h"
#include "hal/image/image.h"

bool image_size_fits(int width, int height)
{
	return width >= 1 && width <= IMAGE_SIDE_MAX && height >= 1 && height <= IMAGE_SIDE_MAX;
}

int image_create_u8(struct image *image, int width, int height)
{
	*image = (struct image){0};
	if (!image_size_fits(width, height))
		return -EINVAL;
	image->u8 = calloc((size_t)width * (size_t)height, 3);
	if (!image->u8)
		return -ENOMEM;
	image->width = width;
	image->height = height;
	return 0;
}

int image_create_u16(struct image *image, int width, int height)
{
	*image = (struct image){0};
	if (!image_size_fits(width, height))
		return -EINVAL;
	image->u16 = calloc((size_t)width * (size_t)height, 3 * sizeof(*image->u16));
	if (!image->u16)
		return -ENOMEM;
	image->width = width;
	image->height = height;
	return 0;
}

int image_create_f32(struct image *image, int width, int height)
{
	*image = (struct image){0};
	if (!image_size_fits(width, height))
		return -EINVAL;
	image->f32 = calloc((size_t)width * (size_t)height, 3 * sizeof(float));
	if (!image->f32)
		return -ENOMEM;
	image->width = width;
	image->height = height;
	return 0;
}

int image_take_rgba(struct image *image, const uint8_t *rgba)
{
	const size_t pixels = (size_t)image->width * (size_t)image->height;
	bool opaque = true;

	for (size_t k = 0; k < pixels; k++) {
		memcpy(image->u8 + 3 * k, rgba + 4 * k, 3);
		opaque &= rgba[4 * k + 3] == 255;
	}
	if (opaque)
		return 0;
	image->alpha = malloc(pixels);
	if (!image->alpha)
		return -ENOMEM;
	for (size_t k = 0; k < pixels; k++)
		image->alpha[k] = rgba[4 * k + 3];
	return 0;
}

int image_take_rgba16(struct image *image, const uint16_t *rgba)
{
	const size_t pixels = (size_t)image->width * (size_t)image->height;
	bool opaque = true;

	for (size_t k = 0; k < pixels; k++) {
		memcpy(image->u16 + 3 * k, rgba + 4 * k, 3 * sizeof(*rgba));
		opaque &= rgba[4 * k + 3] == 65535;
	}
	if (opaque)
		return 0;
	image->alpha = malloc(pixels);
	if (!image->alpha)
		return -ENOMEM;
	for (size_t k = 0; k < pixels; k++)
		image->alpha[k] = (uint8_t)((rgba[4 * k + 3] + 128) / 257);
	return 0;
}

void image_free(struct image *image)
{
	free(image->alpha);
	free(image->u8);
	free(image->u16);
	free(image->f32);
	*image = (struct image){0};
}

int image_check_size(const struct image_source *source, int64_t width, int64_t height,
		     size_t pixel_bytes, struct fault *fault)
{
	const struct budget own = {.file_bytes = source->bytes};

	if (width < 1 || height < 1)
		return fault_say(fault, -EBADMSG, "%s: the header says %lld x %lld pixels",
				 source->name, (long long)width, (long long)height);
	if (width > IMAGE_SIDE_MAX || height > IMAGE_SIDE_MAX)
		return fault_say(fault, -EFBIG, "%s: %lld x %lld pixels, but a side has at most %d",
				 source->name, (long long)width, (long long)height, IMAGE_SIDE_MAX);
	if (source->width && (width != source->width || height != source->height))
		return fault_say(fault, -EINVAL, "%s: is %lldx%lld pixels, expected %dx%d %s",
				 source->name, (long long)width, (long long)height, source->width,
				 source->height, source->why);
	return budget_fits(&own, (double)width * (double)height * (double)pixel_bytes, source->name,
			   fault);
}

int image_check_primaries(const struct image_source *source, const double xy[8],
			  struct fault *fault)
{
	static const double srgb[8] = {0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.329};

	for (int k = 0; k < 8; k++)
		/* 0.03 admits Radiance's default primaries, whose white is that of equal energy.
		 * The negated comparison refuses NaN. */
		if (!(fabs(xy[k] - srgb[k]) < 0.03))
			return fault_say(
				fault, -ENOTSUP,
				"%s: its colours are of other primaries: red %g %g, green %g %g, blue %g %g, white %g %g, expected those of sRGB",
				source->name, xy[0], xy[1], xy[2], xy[3], xy[4], xy[5], xy[6],
				xy[7]);
	return 0;
}
