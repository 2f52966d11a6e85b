/*
 * Text over the picture: a line of figures at the lower edge, and what is wrong above it. Drawn
 * with cairo into memory of its own, only when it changes; each frame then copies those rows over
 * the screen's, which is never read. Without cairo in the build nothing is drawn.
 */
#ifndef INLAY_APP_OVERLAY_H
#define INLAY_APP_OVERLAY_H

#include <stdbool.h>

#include "hal/display.h"

#define OVERLAY_TEXT_MAX 256
#define OVERLAY_TROUBLES_MAX 6

struct overlay {
	char information[OVERLAY_TEXT_MAX]; /* empty: not shown */
	char trouble[OVERLAY_TROUBLES_MAX][OVERLAY_TEXT_MAX];
	int trouble_count;
	bool changed; /* since it was drawn last */
	void *drawn;  /* private: what was drawn, and for which size of screen */
};

/* UTF-8. The same text again changes nothing. */
void overlay_information(struct overlay *overlay, const char *text); /* NULL: not shown */
/* All that is wrong at present, most important first; what does not fit is left out. */
void overlay_troubles(struct overlay *overlay, const char (*texts)[OVERLAY_TEXT_MAX], int count);

/* Copies the text over what has been drawn in the buffer. 0, or -ENOMEM. */
int overlay_draw(struct overlay *overlay, const struct display_buffer *screen);

void overlay_free(struct overlay *overlay); /* idempotent; zeroed is fine */

#endif
