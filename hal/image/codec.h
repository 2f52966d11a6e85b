/* SPDX-License-Identifier: MIT */
/*
 * What image.c and the codecs (image_png.c ...) agree on. Private to hal/image.
 */
#ifndef INLAY_HAL_IMAGE_CODEC_H
#define INLAY_HAL_IMAGE_CODEC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/base/fault.h"
#include "hal/image/image_pixels.h"

/* A file in memory; name stands for it in messages. */
struct image_source {
	const uint8_t *data;
	size_t bytes;
	const char *name;
};

struct image_codec {
	const char *name;   /* "PNG", for messages */
	const char *ending; /* ".png", compared without regard to case */
	bool linear;	    /* write() takes f32; otherwise u8 */

	/* Mandatory. True when the first bytes are this kind's. bytes may be 0. */
	bool (*probe)(const uint8_t *data, size_t bytes);

	/* Mandatory. Fills a zeroed image. May leave a half-filled one on failure: the caller frees
	 * it. Checks sizes with image_check_size() before it allocates. */
	int (*read)(const struct image_source *source, struct image *image, struct fault *fault);

	/* Optional. Only has to write: the caller checks the stream, commits it, and says what
	 * failed. 0, or -errno of something that is not the stream's. */
	int (*write)(FILE *stream, const struct image *image);
};

extern const struct image_codec image_png, image_jpeg, image_hdr, image_pfm;
#if WITH_EXR
extern const struct image_codec image_exr;
#endif

/*
 * Sizes that a header claims, against what the file can hold: at the densest, a byte of this kind
 * of file stands for so many pixels. A tiny file cannot make the reader allocate gigabytes. -EFBIG:
 * a side beyond IMAGE_SIDE_MAX; -EBADMSG: no pixels, or more than the file can hold.
 */
int image_check_size(const struct image_source *source, int64_t width, int64_t height,
		     double pixels_per_byte, struct fault *fault);

/* Chromaticities of red, green, blue and white, x and y of each, against those that colours are
 * taken for, of sRGB. -ENOTSUP: others, as of ACES or P3. */
int image_check_primaries(const struct image_source *source, const double xy[8],
			  struct fault *fault);

#endif
