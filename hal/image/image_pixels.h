/* SPDX-License-Identifier: MIT */
/* A picture in memory: 8-bit code values or linear light. */
#ifndef INLAY_HAL_IMAGE_IMAGE_PIXELS_H
#define INLAY_HAL_IMAGE_IMAGE_PIXELS_H

#include <stdbool.h>
#include <stdint.h>

#define IMAGE_SIDE_MAX 32768

/* Three channels R, G, B, interleaved; row 0 at the top; no padding. Exactly one of u8, u16 and f32
 * is set; u16 by image_read_deep() alone. */
struct image {
	int width, height;
	uint8_t *u8;
	uint16_t *u16; /* code values, 65535 for 1 */
	float *f32;
	uint8_t *alpha; /* coverage of each pixel, 255: all; NULL: 255 everywhere */
};

/* Whether both sides are 1..IMAGE_SIDE_MAX. */
bool image_size_fits(int width, int height);

/* Create a black picture, which the caller frees. 0; -EINVAL: a side out of range; -ENOMEM. On
 * failure the image is zeroed. */
int image_create_u8(struct image *image, int width, int height);
int image_create_u16(struct image *image, int width, int height);
int image_create_f32(struct image *image, int width, int height);

/* Fills a u8 picture from four channels R, G, B, A, the colours not multiplied by alpha.
 * -ENOMEM. */
int image_take_rgba(struct image *image, const uint8_t *rgba);

/* The same of a u16 picture; alpha is rounded. */
int image_take_rgba16(struct image *image, const uint16_t *rgba);

void image_free(struct image *image); /* idempotent */

#endif
