/* SPDX-License-Identifier: MIT */
/*
 * Pictures in files. What a file is, is told by its first bytes; what is written, by its name's
 * ending. 8-bit pictures hold code values as stored; float ones hold linear light.
 *
 *     PNG, JPEG            8-bit (16-bit PNG is rounded, alpha dropped, grey spread)
 *     Radiance .hdr, .pfm, OpenEXR   float
 *
 * Written: .png, .pfm, .hdr; every file appears by rename.
 */
#ifndef INLAY_HAL_IMAGE_H
#define INLAY_HAL_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/image/image_pixels.h"

/* -ENOENT..., -EBADMSG (damaged, truncated), -ENOTSUP (unknown kind), -EFBIG (a side beyond
 * IMAGE_SIDE_MAX), -EDOM (a float picture that holds a NaN or an infinity; the fault names the
 * pixel). Negative light is read as 0. The image is zeroed on failure. */
int image_read(const char *path, struct image *image, struct fault *fault);

/* The same from memory; name stands for the file in messages. */
int image_read_memory(const uint8_t *data, size_t bytes, const char *name, struct image *image,
		      struct fault *fault);

/* .png takes u8; .pfm and .hdr take f32; anything else is -ENOTSUP. */
int image_write(const char *path, const struct image *image, struct fault *fault);

/* What a picture of this name holds: 1, linear light, or 0, code values; -ENOTSUP where none is
 * written. For programs that work long before they write. */
int image_name_linear(const char *path, struct fault *fault);

#endif
