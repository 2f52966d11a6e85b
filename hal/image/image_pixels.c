/* SPDX-License-Identifier: MIT */
#include "hal/image/image_pixels.h"

#include <errno.h>
#include <stdlib.h>

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

void image_free(struct image *image)
{
	free(image->u8);
	free(image->f32);
	*image = (struct image){0};
}
