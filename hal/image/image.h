/* SPDX-License-Identifier: MIT */
/* Pictures in memory, and reading and writing their files. */
#ifndef INLAY_HAL_IMAGE_IMAGE_H
#define INLAY_HAL_IMAGE_IMAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/base/fault.h"

/* A picture in memory: 8-bit code values or linear light. */

#define IMAGE_SIDE_MAX 32768

/* Three channels R, G, B, interleaved; row 0 at the top; no padding. Exactly one of u8, u16 and f32
 * is set; u16 by image_read_memory_deep() alone. */
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

/*
 * Pictures in files. Reading recognises the kind by the first bytes of a file; writing takes it
 * from the ending of the name. 8-bit pictures hold code values as stored; float ones hold linear
 * light.
 *
 *     PNG, JPEG, WebP                8-bit, with alpha (16-bit PNG is rounded, grey spread, inks
 *                                    multiplied)
 *     Radiance .hdr, .pfm, OpenEXR   float
 *
 * Written: .png, .pfm, .hdr; every file appears by rename (hal/base/output.h).
 */

/* Reads a picture, which the caller frees. Negative light is read as 0. 0; -ENOENT...; -EBADMSG:
 * damaged or truncated; -ENOTSUP: unknown kind; -EFBIG: a side beyond IMAGE_SIDE_MAX; -EDOM: a NaN
 * or an infinity in a float picture (the fault names the pixel). On failure the image is zeroed. */
int image_read(const char *path, struct image *image, struct fault *fault);

/* The same, but a picture of another size is refused before its pixels are decoded. why ends the
 * fault, like "as before". -EINVAL. */
int image_read_sized(const char *path, int width, int height, const char *why, struct image *image,
		     struct fault *fault);

/* Reads a file that is in memory; messages call it by name. */
int image_read_memory(const uint8_t *data, size_t bytes, const char *name, struct image *image,
		      struct fault *fault);
int image_read_memory_deep(const uint8_t *data, size_t bytes, const char *name, struct image *image,
			   struct fault *fault);

/* Writes a picture: .png takes u8, .pfm and .hdr take f32. 0; -ENOTSUP: another ending or sample
 * type; other -errno: the file cannot be written. */
int image_write(const char *path, const struct image *image, struct fault *fault);

/* The same, but a file that is there is left as it is: -EEXIST. */
int image_write_new(const char *path, const struct image *image, struct fault *fault);

/* Writes u8 to a stream as PNG, which is not flushed; messages call it by name. */
int image_write_png(FILE *stream, const struct image *image, const char *name, struct fault *fault);

/* Samples that image_write() takes for this name: 1: linear light; 0: code values; -ENOTSUP: it
 * writes none of this kind. Lets programs check a name before long work. */
int image_name_linear(const char *path, struct fault *fault);

#endif
