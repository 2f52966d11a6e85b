/* SPDX-License-Identifier: MIT */
/* Decodes JPEG pictures of cameras to BGRX. */
#ifndef INLAY_HAL_FRAME_FRAME_JPEG_H
#define INLAY_HAL_FRAME_FRAME_JPEG_H

#include "hal/frame/frame.h"

struct frame_jpeg {
	void *handle; /* TurboJPEG's; NULL: there was no memory for it */
};

/* 0 or -ENOMEM. */
int frame_jpeg_create(struct frame_jpeg *jpeg);
void frame_jpeg_destroy(struct frame_jpeg *jpeg); /* idempotent, zeroed is fine */

/* Decodes the first JPEG picture in a plane, which must have the canvas's size. 0, -EBADMSG,
 * -ENOMEM. */
int frame_jpeg_decode(struct frame_jpeg *jpeg, const struct frame_plane *plane,
		      struct canvas *canvas, struct fault *fault);

/* Reads only the height of the first picture. 0, -EBADMSG, -ENOMEM. */
int frame_jpeg_height(struct frame_jpeg *jpeg, const struct frame_plane *plane, int *height,
		      struct fault *fault);

/* The rest of a plane from the beginning of its second JPEG picture; no bytes if there is none. */
struct frame_plane frame_jpeg_after(const struct frame_plane *plane);

#endif
