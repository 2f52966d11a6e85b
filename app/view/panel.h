/* SPDX-License-Identifier: MIT */
/* What cairo draws: boxes of text, and lines in a picture. */
#ifndef INLAY_APP_VIEW_PANEL_H
#define INLAY_APP_VIEW_PANEL_H

#include <stdbool.h>

#include "hal/frame/frame.h"
#include "hal/frame/view.h"

/* A box with text in it, drawn with cairo into memory of its own. */

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

/* Lines and short texts in a picture, drawn with cairo. What is drawn has a dark edge, to be seen
 * on every picture. */

struct pen;

/* A pen for a canvas, which it borrows until pen_drop(). letter_px: height of letters; lines are an
 * eighth as wide. NULL: no memory, or a build without cairo; a pen that is NULL draws nothing. */
struct pen *pen_take(const struct canvas *canvas, double letter_px);
void pen_drop(struct pen *pen);

/* A line through points, in pixels (x right, y down, corner of the picture at 0); a point that is
 * not finite interrupts it. width: 1 is the usual one. */
void pen_line(struct pen *pen, const double (*points)[2], int count, const double rgb[3],
	      double width);

void pen_ring(struct pen *pen, const double centre[2], double radius, const double rgb[3]);

/* A text, UTF-8, whose middle stands at a point; it is moved to lie in the picture. */
void pen_text(struct pen *pen, const double at[2], const char *text, const double rgb[3]);

#endif
