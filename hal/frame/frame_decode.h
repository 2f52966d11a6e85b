/* SPDX-License-Identifier: MIT */
/* Whole frames, of any format and with or without fields, to BGRX. */
#ifndef INLAY_HAL_FRAME_FRAME_DECODE_H
#define INLAY_HAL_FRAME_FRAME_DECODE_H

#include "hal/frame/frame.h"

/*
 * Decodes a frame into a canvas of the same size: matrix and range as the frame says (a JPEG is
 * always BT.601 full), no flips, no scaling; Y'CbCr and R'G'B' of limited range to within 0.501
 * levels, R'G'B' of full range exactly. -EINVAL (short planes, sizes that differ, fields in an odd
 * number of lines), -EBADMSG (a JPEG that does not decode), -ENOTSUP (PIXEL_RGBF and PIXEL_NONE).
 *
 * Fields: a progressive frame is decoded as it is. Each line of an interlaced frame's canvas shows
 * the place of the scene that it would show in a progressive one, whichever way is taken: nothing
 * moves up or down by half a line. What interpolation makes is rounded to the nearest, halves up,
 * from decoded R'G'B'. A field that is alone is interpolated to the whole height. NV12 in one
 * picture has chroma lines that belong to the fields in turn, so its height is a multiple of four.
 * Interlaced MJPEG is one JPEG of the whole height or two of half of it, one after the other.
 *
 * The decoder keeps its state (a JPEG decompressor, two rows, a picture for MJPEG in fields), so
 * that nothing of ours is allocated per frame of a size that it has met (libjpeg allocates what it
 * needs for each picture); one for each thread.
 */
struct frame_decoder;
int frame_decoder_create(struct frame_decoder **decoder, enum deinterlace deinterlace);
int frame_decode(struct frame_decoder *decoder, const struct frame *frame, struct canvas *canvas,
		 struct fault *fault);
void frame_decoder_destroy(struct frame_decoder *decoder);

#endif
