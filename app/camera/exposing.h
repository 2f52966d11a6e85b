/* SPDX-License-Identifier: MIT */
/*
 * The fisheye's camera in several exposures, one after the other: which exposure it is asked for
 * next, and which one a picture has (hal/lights/exposure_schedule.h).
 *
 * All calls come from the thread that owns the camera, for each picture that is used: a frame that
 * is passed over takes no exposure's turn. Frames that the camera has captured meanwhile are
 * estimated from the picture's age. A camera that refuses, or does not show an exposure within
 * EXPOSURE_DELAY_MAX frames, stays at the longest one until it is opened again; the log warns once.
 * A camera that rounds exposures lets in other shares of the light than asked for: ratio has the
 * true ones.
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
	unsigned opening;	     /* source.opening.count when the schedule began; 0: none yet */
	int exposure;		     /* of the last picture; -1: not known */
	double taken[EXPOSURES_MAX]; /* each one as the camera has taken it; first as asked for */
	double ratio[EXPOSURES_MAX]; /* taken[k] / taken[0]: share of the light that each lets in */
	bool asked;		     /* the camera has obeyed since it was opened */
	bool single;		     /* it stays at one exposure */
	int64_t least_ns;	     /* shortest time from a picture's capture to its use */
	int judged, unfit;
	struct fault said; /* the trouble that was logged last */
};

/* Takes settings that have been checked and that outlive exposing. A zeroed exposing is of a camera
 * that keeps its exposure. */
void exposing_start(struct exposing *exposing, const struct config_fisheye *config);

/* To be called when the source has a new picture. Returns its exposure, -1: not known. Asks the
 * camera for the next one. */
int exposing_take(struct exposing *exposing, struct source *source, int64_t now_ns);

/* Tells how bright that picture was (pipeline_report(): level) and whether its light fits its
 * exposure. */
void exposing_judge(struct exposing *exposing, struct source *source, double level, bool fits);

#endif
