/* SPDX-License-Identifier: MIT */
/*
 * The fisheye camera in several exposures, one after the other: which one it is asked for next, and
 * which one a picture has (hal/lights/exposure_schedule.h).
 *
 * All of it on the thread that owns the camera, with each of its pictures that is used: one that is
 * passed over costs no exposure its turn. Frames that the camera has captured meanwhile are
 * reckoned from the picture's time. A camera that refuses, or does not show what it was told within
 * EXPOSURE_DELAY_MAX frames, stays at the longest exposure until it is opened again, and a warning
 * says so once. One that rounds lets in other shares of the light than were asked for, which ratio
 * has.
 */
#ifndef INLAY_APP_CAMERA_EXPOSING_H
#define INLAY_APP_CAMERA_EXPOSING_H

#include <stdbool.h>
#include <stdint.h>

#include "app/camera/source.h"
#include "config/config.h"
#include "hal/lights/exposure_schedule.h"

struct exposing {
	const struct config_fisheye *config; /* borrowed; NULL: the camera keeps its exposure */
	int count;
	struct exposure_schedule schedule;
	unsigned opening;	     /* of the source, that the schedule is of; 0: none yet */
	int exposure;		     /* of the last picture */
	double taken[EXPOSURES_MAX]; /* what the camera makes of each; at first what is asked for */
	double ratio[EXPOSURES_MAX]; /* of it to that of the first: the light that each lets in */
	bool asked;		     /* the camera has obeyed since it was opened */
	bool single;		     /* it stays at one */
	int64_t least_ns;	     /* that a picture has waited for us */
	int judged, unfit;
	struct fault said; /* the trouble that was logged last */
};

/* Settings that are checked, and stay. Zeroed, it is of a camera that keeps its exposure. */
void exposing_start(struct exposing *exposing, const struct config_fisheye *config);

/* The source's picture is a new one: its exposure, -1: not known. Asks for another. */
int exposing_take(struct exposing *exposing, struct source *source, int64_t now_ns);

/* How bright that picture was, and whether it is of that exposure. */
void exposing_judge(struct exposing *exposing, struct source *source, double level, bool fits);

#endif
