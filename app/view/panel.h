/* SPDX-License-Identifier: MIT */
/* A box with text in it, drawn with cairo into memory of its own. */
#ifndef INLAY_APP_VIEW_PANEL_H
#define INLAY_APP_VIEW_PANEL_H

#include <stdbool.h>

#include "hal/frame/view.h"

#define PANEL_TEXTS_MAX 8
#define PANEL_TEXT_MAX 256 /* bytes of each, with its end */

enum panel_kind {
	PANEL_STRIP,   /* as wide as it may be; keeps size and lines as its figures change */
	PANEL_WARNING, /* as wide as its text; a mark before each one */
};

struct panel_room {
	int width, height; /* the panel is no larger */
	int size_px;	   /* of the letters, where there is room for it */
};

struct panel;

/* 0; -ENOMEM; -ENOTSUP: built without cairo. */
int panel_create(struct panel **panel, enum panel_kind kind);

/*
 * Draws count texts, UTF-8, one below the other. One that is too wide is made smaller, down to
 * two thirds; where that is not enough, lines are broken: between the parts of a text that " ·
 * " separates, else between words, else between letters. If the lines are too many, letters are
 * made smaller as long as they can be read; then the last texts are left out and counted instead. 0
 * or -ENOMEM; nothing is allocated by this file for a panel no larger than it has been.
 */
int panel_draw(struct panel *panel, const char (*texts)[PANEL_TEXT_MAX], int count,
	       const struct panel_room *room);

/* What was drawn, opaque; width 0: nothing. Valid until it is drawn anew. */
struct picture panel_picture(const struct panel *panel);

void panel_destroy(struct panel *panel); /* NULL is harmless */

#endif
