/* SPDX-License-Identifier: MIT */
/* A box with text in it, drawn with cairo into memory of its own. */
#ifndef INLAY_APP_VIEW_PANEL_H
#define INLAY_APP_VIEW_PANEL_H

#include <stdbool.h>

#include "hal/frame/view.h"

#define PANEL_TEXTS_MAX 8
#define PANEL_TEXT_MAX 256 /* bytes of each, terminator included */

enum panel_kind {
	PANEL_STRIP,   /* as wide as the room; keeps size and lines as its figures change */
	PANEL_WARNING, /* as wide as its text, with a mark before each one */
};

struct panel_room {
	int width, height; /* the panel is no larger */
	int size_px;	   /* of the letters, if there is room */
};

struct panel;

/* 0; -ENOMEM; -ENOTSUP: built without cairo. */
int panel_create(struct panel **panel, enum panel_kind kind);

/*
 * Draws count texts, UTF-8, one below the other. A text that is too wide is made smaller, down to
 * two thirds. If that is not enough, lines are broken: between the parts that " · " separates, else
 * between words, else between letters. If there are too many lines, letters are made smaller as
 * long as they can be read; then the last texts are left out and counted instead. 0 or -ENOMEM.
 * This file allocates nothing for a panel no larger than it has been.
 */
int panel_draw(struct panel *panel, const char (*texts)[PANEL_TEXT_MAX], int count,
	       const struct panel_room *room);

/* The panel, opaque; width 0: there is nothing in it. Valid until it is drawn again. */
struct picture panel_picture(const struct panel *panel);

void panel_destroy(struct panel *panel); /* NULL is harmless */

#endif
