/* SPDX-License-Identifier: MIT */
/*
 * What is on the screen: the picture with the object, before it, both beside each other, the
 * fisheye with its marked lights, the scene camera, or four of them in the thesis's arrangement
 * (section 4.2.1):
 *
 *     scene   fisheye
 *     before  after
 *
 * A view that has no picture is black.
 */
#ifndef INLAY_APP_VIEW_SHOW_H
#define INLAY_APP_VIEW_SHOW_H

#include <stdbool.h>

#include "app/camera/eye.h"
#include "app/pipeline/pipeline.h"
#include "app/view/overlay.h"
#include "app/view/scaler.h"
#include "config/config.h"
#include "hal/device/display.h"
#include "hal/frame/frame.h"

struct show {
	struct canvas after, marked;
	struct scaler scalers[4]; /* of the whole screen and three more quarters */
};

/* What is wanted of one picture. */
struct show_request {
	enum config_show what;
	enum config_scale scale;
	double split;  /* SHOW_SPLIT: where the line stands, share of the picture's width, 0..1 */
	double squash; /* of the screen's pixels, height over width: what display_fit() has taken
			  over (struct show_fit), 1 without it */
	bool blank;    /* black instead of the pictures; the text is shown */
	struct overlay *overlay; /* drawn last; NULL: no text */
};

/* What to ask of display_fit(): then nothing but parts of SHOW_QUAD need scaling by the
 * processor. */
struct show_fit {
	int width, height;
	double squash;
};

void show_free(struct show *show); /* idempotent; zeroed is fine */

struct show_fit show_fit(enum config_show what, const struct eyes *eyes, const struct basis *basis);

/* The size at which everything can be shown pixel by pixel; for screens that have none of their
 * own. */
void show_size(enum config_show what, const struct eyes *eyes, const struct basis *basis,
	       int *width, int *height);

/* Draws the whole screen, of any size. The light has been chosen (pipeline_choose()). */
int show_draw(struct show *show, const struct show_request *request, struct pipeline *pipeline,
	      const struct eyes *eyes, const struct display_buffer *screen, struct fault *fault);

#endif
