/* SPDX-License-Identifier: MIT */
/* Texts broken into lines that fit into a panel. Private to app/view/panel.c; needs cairo. */
#ifndef INLAY_APP_VIEW_TYPESET_H
#define INLAY_APP_VIEW_TYPESET_H

#include <cairo.h>

#include "app/view/panel.h"

#define TYPESET_LINES_MAX 40

/* A text as glyphs along one line, which begins at 0. */
struct typeset_run {
	char text[PANEL_TEXT_MAX + 1];		 /* and a blank */
	int at[PANEL_TEXT_MAX];			 /* where in it each character begins */
	cairo_glyph_t glyph[PANEL_TEXT_MAX + 1]; /* one a character, and one where it ends */
	int count;
};

struct typeset_line {
	int text, first, count; /* glyphs of a text */
	double width;
};

/* Lines of one size. Zeroed: nothing set yet. */
struct typeset {
	struct panel_room room;
	const char *texts[PANEL_TEXTS_MAX];
	int text_count;
	int marked; /* so many texts have a mark */

	int size_px;
	int line_px;	 /* from a line to the next */
	int ascent_px;	 /* from its upper edge to where letters stand */
	int pad, indent; /* around all; before each line */
	int line_room;	 /* for its letters */
	double widest;	 /* text, were it not broken */
	struct typeset_line lines[TYPESET_LINES_MAX];
	int count;

	struct typeset_run run; /* of one of the texts */
	char more[32];
};

/* Sets the texts, in set->room, as panel_draw() says; again: as they stood the last time, if they
 * still fit so. 0 or -ENOMEM. */
int typeset(struct typeset *set, cairo_t *cairo, bool again);

/* Finds set->run of one of the texts, in the size that the context has. */
int typeset_run(struct typeset *set, cairo_t *cairo, int text);

int typeset_height_px(const struct typeset *set);

#endif
