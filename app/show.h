/*
 * What is on the screen: the picture with the object, before it, the fisheye with its marked
 * lights, the scene camera, or all four in the thesis's arrangement (section 4.2.1):
 *
 *     scene   fisheye
 *     before  after
 *
 * A view that has no picture is black.
 */
#ifndef INLAY_APP_SHOW_H
#define INLAY_APP_SHOW_H

#include "app/eye.h"
#include "app/pipeline.h"
#include "app/scaler.h"
#include "config/config.h"
#include "hal/display.h"
#include "hal/frame.h"

struct eyes {
	struct eye fisheye, background, scene;
};

struct show {
	struct canvas after, marked;
	struct scaler scalers[4]; /* of the whole screen and three more quarters */
};

void show_free(struct show *show); /* idempotent; zeroed is fine */

/* The size at which everything can be shown pixel by pixel; for screens that have none of their
 * own. */
void show_size(enum config_show what, const struct eyes *eyes, const struct basis *basis,
	       int *width, int *height);

/* Draws the whole screen. The light has been chosen (pipeline_choose()). */
int show_draw(struct show *show, enum config_show what, enum config_scale scale,
	      struct pipeline *pipeline, const struct eyes *eyes,
	      const struct display_buffer *screen, struct fault *fault);

#endif
