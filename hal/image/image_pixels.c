/* SPDX-License-Identifier: MIT */
#include "hal/image/image_pixels.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

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
