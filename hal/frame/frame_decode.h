/* SPDX-License-Identifier: MIT */
/* Decodes whole frames, of any 8-bit format, progressive or in fields, to BGRX; and what that is
 * made of: JPEG pictures of cameras, and the fields of interlaced pictures. */
#ifndef INLAY_HAL_FRAME_FRAME_DECODE_H
#define INLAY_HAL_FRAME_FRAME_DECODE_H

#include "hal/frame/frame.h"
#include "hal/jpeg/jpeg_decoder.h"

/* Decodes the first JPEG picture in a plane. It has the canvas's size, or is larger by less than a
 * block of 16 pixels at the right and below, which encoders add and some cameras do not cut off. 0,
 * -EBADMSG, -ENOMEM. */
int frame_jpeg_decode(struct jpeg_decoder *jpeg, const struct frame_plane *plane,
		      struct canvas *canvas, struct fault *fault);

/* Reads only the size of the first picture. 0, -EBADMSG, -ENOMEM. */
int frame_jpeg_size(struct jpeg_decoder *jpeg, const struct frame_plane *plane, int *width,
		    int *height, struct fault *fault);

/* Whether a JPEG picture of this size holds a picture of width x height and at most padding. */
bool frame_jpeg_holds(int jpeg_width, int jpeg_height, int width, int height);

/* The rest of a plane from the beginning of its second JPEG picture; no bytes if there is none. */
struct frame_plane frame_jpeg_after(const struct frame_plane *plane);

/* Checks that the lines can be divided between two fields. 0; -EINVAL: an odd height, or NV12 in
 * one picture with an odd number of chroma lines. Not for FIELDS_NONE. */
int frame_fields_check(const struct frame *frame, struct fault *fault);

/* Whether the frame has this field; FIELDS_TOP and FIELDS_BOTTOM have one. */
bool frame_fields_has(const struct frame *frame, bool bottom);

/* One field as a progressive frame in the same memory. Its planes may be too short: the caller
 * checks. Not for MJPEG. */
struct frame frame_fields_one(const struct frame *frame, bool bottom);

/* Every other line of a canvas, as a canvas of half the height in the same memory; never free
 * it. */
struct canvas canvas_field(const struct canvas *canvas, bool bottom);

/* Fills the lines of the other field with the mean of their neighbours; a line at the edge repeats
 * its only neighbour. */
void canvas_interpolate(struct canvas *canvas, bool from_bottom);

/* Replaces each line by (above + 2 line + below) / 4, mirrored at the edges. At least two lines.
 * scratch: two rows. */
void canvas_blend(struct canvas *canvas, uint8_t *scratch);

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
