/* SPDX-License-Identifier: MIT */
/* JPEG pictures as cameras send them, into BGRX. */
#ifndef INLAY_HAL_FRAME_FRAME_JPEG_H
#define INLAY_HAL_FRAME_FRAME_JPEG_H

#include "hal/frame/frame.h"

struct frame_jpeg {
	void *handle; /* NULL: no memory for one */
};

/* 0 or -ENOMEM. */
int frame_jpeg_create(struct frame_jpeg *jpeg);
void frame_jpeg_destroy(struct frame_jpeg *jpeg); /* idempotent, zeroed is fine */

/* The first JPEG picture in a plane, which must be of the canvas's size. 0, -EBADMSG, -ENOMEM. */
int frame_jpeg_decode(struct frame_jpeg *jpeg, const struct frame_plane *plane,
		      struct canvas *canvas, struct fault *fault);

/* Only its height; 0 or -EBADMSG. */
int frame_jpeg_height(struct frame_jpeg *jpeg, const struct frame_plane *plane, int *height,
		      struct fault *fault);

/* What follows the first JPEG picture in a plane, from the next one's beginning; no bytes when
 * there is none. */
struct frame_plane frame_jpeg_after(const struct frame_plane *plane);

#endif
