/* SPDX-License-Identifier: MIT */
#include "bake/base/surface.h"

#include <string.h>

int surface_to_image(cairo_surface_t *surface, struct image *image)
{
	const size_t stride = (size_t)cairo_image_surface_get_stride(surface);
	const unsigned char *data;
	const int ret = image_create_u8(image, cairo_image_surface_get_width(surface),
					cairo_image_surface_get_height(surface));

	if (ret < 0)
		return ret;
	cairo_surface_flush(surface);
	data = cairo_image_surface_get_data(surface);
	for (int y = 0; y < image->height; y++)
		for (int x = 0; x < image->width; x++) {
			const size_t at = (size_t)y * (size_t)image->width + (size_t)x;
			uint32_t pixel;

			memcpy(&pixel, data + (size_t)y * stride + (size_t)x * 4, sizeof(pixel));
			for (int c = 0; c < 3; c++)
				image->u8[3 * at + (size_t)c] = (uint8_t)(pixel >> (16 - 8 * c));
		}
	return 0;
}

cairo_surface_t *surface_of_image(const struct image *image)
{
	cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, image->width,
							      image->height);
	size_t stride;
	unsigned char *data;

	if (cairo_surface_status(surface) != CAIRO_STATUS_SUCCESS) {
		cairo_surface_destroy(surface);
		return NULL;
	}
	stride = (size_t)cairo_image_surface_get_stride(surface);
	data = cairo_image_surface_get_data(surface);
	for (int y = 0; y < image->height; y++)
		for (int x = 0; x < image->width; x++) {
			const uint8_t *from = image->u8 +
					      3 * ((size_t)y * (size_t)image->width + (size_t)x);
			const uint32_t pixel = (uint32_t)from[0] << 16 | (uint32_t)from[1] << 8 |
					       (uint32_t)from[2];

			memcpy(data + (size_t)y * stride + (size_t)x * 4, &pixel, sizeof(pixel));
		}
	cairo_surface_mark_dirty(surface);
	return surface;
}
