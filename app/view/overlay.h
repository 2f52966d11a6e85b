/* SPDX-License-Identifier: MIT */
/*
 * Text over the picture: what is wrong in a box at the upper edge, a line of figures along the
 * lower one; each takes at most a third of the height, so that the middle stays free. Drawn with
 * cairo into memory of its own, only when it or the screen's size changes; each frame then copies
 * those boxes over the screen's pixels, which are never read. Without cairo in the build nothing is
 * drawn, and the log says so once.
 */
#ifndef INLAY_APP_VIEW_OVERLAY_H
#define INLAY_APP_VIEW_OVERLAY_H

#include <stdbool.h>

#include "hal/device/display.h"

#define OVERLAY_TEXT_MAX 256 /* bytes, with the end; longer ones are cut between characters */
#define OVERLAY_TROUBLES_MAX 6

struct overlay_drawn;

struct overlay {
	char information[OVERLAY_TEXT_MAX]; /* empty: not shown */
	char trouble[OVERLAY_TROUBLES_MAX][OVERLAY_TEXT_MAX];
	int trouble_count;
	/* Private: */
	bool information_drawn, troubles_drawn; /* as they are */
	struct overlay_drawn *drawn;		/* and for which size of screen */
};

/* UTF-8. The same text again changes nothing. */
void overlay_information(struct overlay *overlay, const char *text); /* NULL: not shown */
/* All that is wrong at present, most important first; what does not fit is left out. */
void overlay_troubles(struct overlay *overlay, const char (*texts)[OVERLAY_TEXT_MAX], int count);

/* Copies the text over what has been drawn in the buffer. Nothing is allocated while neither text
 * nor size change. 0, or -ENOMEM. */
int overlay_draw(struct overlay *overlay, const struct display_buffer *screen);

void overlay_free(struct overlay *overlay); /* idempotent; zeroed is fine */

#endif
