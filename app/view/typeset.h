/* SPDX-License-Identifier: MIT */
/* Breaks texts into lines that fit into a panel. Private to app/view/panel.c; needs cairo. */
#ifndef INLAY_APP_VIEW_TYPESET_H
#define INLAY_APP_VIEW_TYPESET_H

#include <cairo.h>

#include "app/view/panel.h"

#define TYPESET_LINES_MAX 40

/* A text as glyphs along one line that begins at x = 0. */
struct typeset_run {
	char text[PANEL_TEXT_MAX + 1];		 /* the text and a blank */
	int at[PANEL_TEXT_MAX];			 /* byte at which each character begins */
	cairo_glyph_t glyph[PANEL_TEXT_MAX + 1]; /* one for each character, and one at the end */
	int count;
};

struct typeset_line {
	int text, first, count; /* glyphs first..first + count - 1 of a text */
	double width;
};

/* Lines of one size. Zeroed: nothing is set yet. */
struct typeset {
	struct panel_room room;
	const char *texts[PANEL_TEXTS_MAX];
	int text_count;
	int marked; /* number of texts that have a mark */

	int size_px;
	int line_px;	 /* height of a line */
	int ascent_px;	 /* from a line's upper edge to its base line */
	int pad, indent; /* margin around the lines; before each line */
	int line_room;	 /* width for letters */
	double widest;	 /* width of the widest text, if it were not broken */
	struct typeset_line lines[TYPESET_LINES_MAX];
	int count;

	struct typeset_run run; /* the text found last */
	char more[32];
};

/* Breaks set->texts into lines in set->room, as panel_draw() says. again: keeps the last size if
 * the texts still fit. 0 or -ENOMEM. */
int typeset(struct typeset *set, cairo_t *cairo, bool again);

/* Fills set->run with one of the texts, in the context's font size. 0 or -ENOMEM. */
int typeset_run(struct typeset *set, cairo_t *cairo, int text);

int typeset_height_px(const struct typeset *set);

#endif
