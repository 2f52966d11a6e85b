/* SPDX-License-Identifier: MIT */
/*
 * Decodes the H.264 of a camera by FFmpeg's libavcodec, which is loaded when the first such camera
 * is opened: most machines have none, and it brings a hundred libraries.
 *
 * A picture is decoded from earlier ones, so the decoder has to see every access unit. After one
 * that is damaged or lost nothing comes out until a picture that needs no earlier one.
 */
#ifndef INLAY_DRIVERS_V4L2_H264_H
#define INLAY_DRIVERS_V4L2_H264_H

#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"
#include "hal/frame/frame.h"

struct h264_decoder;

/* Loads the library. 0; -ENOTSUP: built without the decoder, or the library is not installed. */
int h264_available(struct fault *fault);

/* 0; -ENOMEM; -ENOTSUP. */
int h264_create(struct h264_decoder **decoder, struct fault *fault);
void h264_destroy(struct h264_decoder *decoder); /* NULL is harmless */

/* Decodes one access unit, with start codes. Sets format, size, planes and, where the stream tells
 * them, matrix and range of *frame; the planes stay valid until the next picture is decoded. 0;
 * -EAGAIN: it holds no picture; -EBADMSG: it is damaged, or needs one that was; -ENOTSUP: no 4:2:0
 * of 8 bits; -ENOMEM. */
int h264_decode(struct h264_decoder *decoder, const uint8_t *data, size_t bytes,
		struct frame *frame, struct fault *fault);

/* Tells the decoder that an access unit is missing. */
void h264_skip(struct h264_decoder *decoder);

#endif
