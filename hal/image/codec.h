/* SPDX-License-Identifier: MIT */
/*
 * A codec reads and writes one kind of picture file (image_png.c ...). Private to hal/image.
 */
#ifndef INLAY_HAL_IMAGE_CODEC_H
#define INLAY_HAL_IMAGE_CODEC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/image/image.h"

/* A file in memory; messages call it by name. */
struct image_source {
	const uint8_t *data;
	size_t bytes;
	const char *name;
	bool deep; /* keep 16 bits: fill u16 */
	/* Another size is refused before its pixels are decoded; 0: any. why: like "as before". */
	int width, height;
	const char *why;
};

struct image_codec {
	const char *name;   /* "PNG", for messages */
	const char *ending; /* ".png", compared without regard to case */
	bool linear;	    /* write() takes f32; otherwise u8 */

	/* Mandatory. Whether the first bytes are those of this kind. bytes may be 0. */
	bool (*probe)(const uint8_t *data, size_t bytes);

	/* Mandatory. Fills a zeroed image, which the caller frees, after a failure too. Calls
	 * image_check_size() before it allocates. 0 or -errno with a fault. */
	int (*read)(const struct image_source *source, struct image *image, struct fault *fault);

	/* Optional. Writes to the stream; the caller checks the stream for errors, commits it, and
	 * reports failures. 0, or -errno of a failure that is not the stream's. */
	int (*write)(FILE *stream, const struct image *image);
};

extern const struct image_codec image_png, image_jpeg, image_hdr, image_pfm;
#if WITH_EXR
extern const struct image_codec image_exr;
#endif
#if WITH_WEBP
extern const struct image_codec image_webp;
#endif

/* Names the kind of a file that no codec reads, and how it becomes one that is read; NULL: it is of
 * none that is known. */
const char *image_foreign(const uint8_t *data, size_t bytes, const char **how);

/*
 * Checks the size in a header. 0; -EBADMSG: no pixels; -EFBIG: a side beyond IMAGE_SIDE_MAX, or
 * more memory than a file of this length may ask for (hal/base/budget.h), by the bytes of a decoded
 * pixel; -EINVAL: not the source's size.
 */
int image_check_size(const struct image_source *source, int64_t width, int64_t height,
		     size_t pixel_bytes, struct fault *fault);

/* Checks the chromaticities of red, green, blue and white (x and y of each) against those of sRGB.
 * 0; -ENOTSUP: other primaries, such as those of ACES or P3. */
int image_check_primaries(const struct image_source *source, const double xy[8],
			  struct fault *fault);

#endif
