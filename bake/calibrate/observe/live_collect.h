/* SPDX-License-Identifier: MIT */
/*
 * Pictures of a board, taken by themselves while a person moves it before a live camera: one
 * whenever it is held still in a new place, until the picture is covered and the board was tilted.
 */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_COLLECT_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_COLLECT_H

#include "bake/calibrate/observe/boards.h"
#include "bake/calibrate/observe/live.h"
#include "bake/calibrate/observe/observations.h"

struct collect_settings {
	int views;	   /* at most, >= 1; less when nothing is missing before */
	double patience_s; /* of the camera's time, without a new view */
	bool round;	   /* a fisheye's picture: its corners show nothing */
};

/*
 * Shows on the screen of the configuration what is seen, what was covered and what is missing;
 * where that screen fails, the log says it. Adds a view for each picture taken;
 * pictures[count] are the caller's, to be freed one by one and all. -ETIMEDOUT: nothing new within
 * the patience; -ECANCELED: the window was closed; what live_next() and board_find() say;
 * -ENOMEM. On failure there are no pictures, and the views taken so far stay.
 */
int live_collect(struct live *live, const struct board *board,
		 const struct collect_settings *settings, struct observations *all,
		 struct image **pictures, int *count, struct fault *fault);

#endif
