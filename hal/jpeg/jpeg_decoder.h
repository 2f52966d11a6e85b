/* SPDX-License-Identifier: MIT */
/*
 * Decodes JPEG pictures in memory, of files and of cameras, by libjpeg.
 *
 * A picture counts as damaged where a part of it is missing or made up. Oddities after which the
 * picture is whole are forgiven, because every viewer shows such pictures: bytes before the start
 * marker or behind the end marker, stray bytes between segments, a missing end marker, a scan
 * header with odd parameters, left out Huffman tables (those of motion JPEG are always the same).
 */
#ifndef INLAY_HAL_JPEG_JPEG_DECODER_H
#define INLAY_HAL_JPEG_JPEG_DECODER_H

#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"

enum jpeg_pixels {
	JPEG_RGB,  /* 3 bytes */
	JPEG_BGRX, /* 4 bytes, X = 255 */
};

struct jpeg_decoder;

/* One decoder per thread. 0 or -ENOMEM. */
int jpeg_decoder_create(struct jpeg_decoder **jpeg);
void jpeg_decoder_destroy(struct jpeg_decoder *jpeg); /* NULL is harmless */

/* Reads the header of the first picture in data, which stays in use until the next call of
 * jpeg_decoder_open(). 0, -EBADMSG, -ENOMEM. */
int jpeg_decoder_open(struct jpeg_decoder *jpeg, const uint8_t *data, size_t bytes, int *width,
		      int *height, struct fault *fault);

/* Decodes the upper left part of the opened picture, which is at least as large as width and
 * height: once for each jpeg_decoder_open(). stride: bytes from row to row. Grey and CMYK pictures
 * become R'G'B'. 0; -EBADMSG: damaged, and what pixels hold is undefined; -ENOMEM. */
int jpeg_decoder_read(struct jpeg_decoder *jpeg, enum jpeg_pixels kind, uint8_t *pixels,
		      size_t stride, int width, int height, struct fault *fault);

#endif
