/* SPDX-License-Identifier: MIT */
/*
 * Text over the picture: troubles in a box at the upper edge, a line of figures along the lower
 * one. Each takes at most a third of the height, so that the middle stays free. cairo draws them
 * into memory of its own, only when the text or the screen's size changes; each frame then copies
 * the boxes over the screen's pixels, which are never read. Without cairo in the build nothing is
 * drawn, and the log says so once.
 */
#ifndef INLAY_APP_VIEW_OVERLAY_H
#define INLAY_APP_VIEW_OVERLAY_H

#include <stdbool.h>

#include "hal/device/display.h"

#define OVERLAY_TEXT_MAX                                                                           \
	256 /* bytes, terminator included; longer texts are cut between characters */
#define OVERLAY_TROUBLES_MAX 7

struct overlay_drawn;

struct overlay {
	char information[OVERLAY_TEXT_MAX]; /* empty: not shown */
	char trouble[OVERLAY_TROUBLES_MAX][OVERLAY_TEXT_MAX];
	int trouble_count;
	/* Private: */
	bool information_drawn, troubles_drawn; /* the panels hold the present texts */
	struct overlay_drawn *drawn; /* panels and the screen's size that they are drawn for */
};

/* UTF-8. The same text again changes nothing. */
void overlay_information(struct overlay *overlay, const char *text); /* NULL: not shown */
/* Present troubles, the most important one first; those that do not fit are left out. */
void overlay_troubles(struct overlay *overlay, const char (*texts)[OVERLAY_TEXT_MAX], int count);

/* Copies the text over the picture in the buffer. Nothing is allocated while text and size stay the
 * same. 0 or -ENOMEM. */
int overlay_draw(struct overlay *overlay, const struct display_buffer *screen);

void overlay_free(struct overlay *overlay); /* idempotent; zeroed is fine */

#endif
