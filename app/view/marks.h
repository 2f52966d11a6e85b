/* SPDX-License-Identifier: MIT */
/* The lights drawn into the fisheye's picture, as in the thesis's figures: those in use red, those
 * left out blue. */
#ifndef INLAY_APP_VIEW_MARKS_H
#define INLAY_APP_VIEW_MARKS_H

#include <stdbool.h>

#include "hal/frame/frame.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"

#define MARK_USED_BGR                                                                              \
	{                                                                                          \
		32, 32, 255                                                                        \
	}
#define MARK_UNUSED_BGR                                                                            \
	{                                                                                          \
		255, 96, 32                                                                        \
	}

/* A side of a mark in a picture of this height, which is shown shown_height pixels high: 2 in the
 * thesis's 243 and in smaller ones; at least 3 of the screen's pixels, to be seen where the picture
 * is made smaller. */
int mark_side_px(int picture_height, int shown_height);

/* used[dome->count]. lens is of the canvas's size. Lights that it does not see are not drawn. */
void marks_draw(struct canvas *canvas, const struct dome *dome, const struct fisheye *lens,
		const bool *used, int side_px);

#endif
