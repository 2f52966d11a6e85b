/* SPDX-License-Identifier: MIT */
/* The screen during live calibration: the live picture with marks and one line of text over it. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_SCREEN_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_SCREEN_H

#include <stdbool.h>

#include "bake/calibrate/observe/live.h"
#include "bake/calibrate/observe/observations.h"
#include "config/config.h"
#include "hal/device/display.h"

#define COVER_COLUMNS 4
#define COVER_ROWS 3

struct live_screen {
	struct display display;
	uint8_t *picture, *page; /* BGRX: the camera's picture, the screen's page */
	int width, height;	 /* of the camera's picture */
	double squash;
};

/* The content of the screen. */
struct live_scene {
	const struct image *picture;
	const struct observation *corner; /* corners of the board in it */
	int corners;
	bool taken;			/* this picture has just become a view */
	bool (*covered)[COVER_COLUMNS]; /* [COVER_ROWS] */
	const char *text;
};

/* Opens the screen of the configuration given to live_open(). -EINVAL: it names an unknown driver;
 * -ENODEV: the screen does not open; -ENOMEM. */
int live_screen_open(struct live_screen *screen, struct live *live, struct fault *fault);

/* Shows the scene, unless the screen is still busy with the last one. -ECANCELED: the window was
 * closed; or a display's errors. */
int live_screen_show(struct live_screen *screen, const struct live_scene *scene,
		     struct fault *fault);

/* Idempotent; zeroed is fine. Returns the error of display_close(), which finishes files. */
int live_screen_close(struct live_screen *screen, struct fault *fault);

/* The configuration given to live_open(); it also names the screen. */
struct config *live_config(struct live *live);

/* Height of a pixel over its width, from the view's settings. */
double live_squash(const struct live *live);

#endif
