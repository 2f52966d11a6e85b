/* SPDX-License-Identifier: MIT */
/* Decodes whole frames, of any 8-bit format, progressive or in fields, to BGRX. */
#ifndef INLAY_HAL_FRAME_FRAME_DECODE_H
#define INLAY_HAL_FRAME_FRAME_DECODE_H

#include "hal/frame/frame.h"

/*
 * Decodes a frame into a canvas of the same size, or of the size exchanged where the decoder turns
 * pictures by 90 or 270 degrees: matrix and range as the frame says (a JPEG is always BT.601 full),
 * no flips, no scaling. Y'CbCr and R'G'B' of limited range are exact to 0.501 levels, R'G'B' of
 * full range is exact. 0; -EINVAL: short planes, sizes that differ, fields in an odd number of
 * lines; -EBADMSG: a JPEG that does not decode; -ENOTSUP: PIXEL_RGBF, PIXEL_NONE.
 *
 * Fields: each line of the canvas shows the same place of the scene as in a progressive frame,
 * whatever the way to deinterlace: the picture does not move up or down by half a line.
 * Interpolated lines are rounded to nearest, halves up, from decoded R'G'B'. A field that comes
 * alone is interpolated to the whole height. In one picture of NV12, chroma lines belong to the two
 * fields in turn, so its height must be a multiple of four. Interlaced MJPEG is one JPEG of the
 * whole height, or two JPEGs of half the height, one after the other.
 *
 * A decoder keeps a JPEG decompressor, two rows, and a picture for MJPEG in fields, so that a frame
 * of a known size allocates nothing (libjpeg itself allocates for each picture). One decoder per
 * thread.
 */
struct frame_decoder;
int frame_decoder_create(struct frame_decoder **decoder, enum deinterlace deinterlace,
			 enum picture_turn turn);
int frame_decode(struct frame_decoder *decoder, const struct frame *frame, struct canvas *canvas,
		 struct fault *fault);
/* Size of the picture in a frame: the frame's own, unless a progressive JPEG tells another one that
 * is not the same with a block of padding. 0, -EBADMSG, -ENOMEM. */
int frame_decoder_size(struct frame_decoder *decoder, const struct frame *frame, int *width,
		       int *height, struct fault *fault);
void frame_decoder_destroy(struct frame_decoder *decoder);

#endif
