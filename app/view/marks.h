/* SPDX-License-Identifier: MIT */
/* Marks the lights in the fisheye's picture, as in the thesis's figures: red lights are in use,
 * blue ones left out. */
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

/* Side of a mark, px, in a picture of this height that is shown shown_height pixels high: 2 in the
 * thesis's 243 rows and in smaller pictures; at least 3 pixels of the screen, to be seen where the
 * picture is shrunk. */
int mark_side_px(int picture_height, int shown_height);

/* used[dome->count]; lens is prepared for the canvas's size. Lights that it does not see are not
 * drawn. */
void marks_draw(struct canvas *canvas, const struct dome *dome, const struct fisheye *lens,
		const bool *used, int side_px);

#endif
