/* SPDX-License-Identifier: MIT */
/* What a person sees while pictures are collected: the live picture and what is drawn over it. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_SCREEN_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_SCREEN_H

#include <stdbool.h>

#include "bake/calibrate/observe/live.h"
#include "bake/calibrate/observe/observations.h"
#include "hal/device/display.h"

#define COVER_COLUMNS 4
#define COVER_ROWS 3

struct live_screen {
	struct display display;
	uint8_t *picture, *page; /* BGRX: the camera's, the screen's */
	int width, height;	 /* of the camera's */
	double squash;
};

/* What is shown. */
struct live_scene {
	const struct image *picture;
	const struct observation *corner; /* of the board in it */
	int corners;
	bool taken;			/* this picture has just been taken */
	bool (*covered)[COVER_COLUMNS]; /* [COVER_ROWS] */
	const char *text;
};

/* The screen of the configuration that live was opened with. -EINVAL: it names no driver that there
 * is; -ENODEV: it does not open; -ENOMEM. */
int live_screen_open(struct live_screen *screen, struct live *live, struct fault *fault);

/* Shows it, unless the screen is still busy with the one before. -ECANCELED: the window was closed;
 * or a display's errors. */
int live_screen_show(struct live_screen *screen, const struct live_scene *scene,
		     struct fault *fault);

/* Idempotent; zeroed is fine. What a file's end could not be written for. */
int live_screen_close(struct live_screen *screen, struct fault *fault);

#endif
