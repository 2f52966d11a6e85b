/* SPDX-License-Identifier: MIT */
/* JPEG pictures of cameras, as BGRX. */
#ifndef INLAY_HAL_FRAME_FRAME_JPEG_H
#define INLAY_HAL_FRAME_FRAME_JPEG_H

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

#endif
