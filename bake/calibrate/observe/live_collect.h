/* SPDX-License-Identifier: MIT */
/*
 * Automatic collection of views of a board that a person moves before a live camera: a view is
 * taken whenever the board is held still in a new place, until the picture is covered and the board
 * was tilted.
 */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_COLLECT_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_LIVE_COLLECT_H

#include "bake/calibrate/observe/boards.h"
#include "bake/calibrate/observe/live.h"
#include "bake/calibrate/observe/observations.h"

struct collect_settings {
	int views;	   /* most views, >= 1; collection ends earlier if nothing is missing */
	double patience_s; /* longest time without a new view, by the camera's clock */
	bool round;	   /* a fisheye's picture, whose corners show nothing */
	int world; /* number of the view, from 1, whose board lies where the world is; 0: none */
};

/*
 * Collects views. Shows the picture, what is covered and what is missing on the configured screen;
 * where that screen fails, the log says the same. Adds a view to all for each picture taken;
 * pictures[count] belong to the caller, who frees each image and the array. -ETIMEDOUT: no new view
 * within the patience; -ECANCELED: the window was closed; errors of live_next() and board_find();
 * -ENOMEM. On failure there are no pictures, and the views taken so far stay in all.
 */
int live_collect(struct live *live, struct board *board, const struct collect_settings *settings,
		 struct observations *all, struct image **pictures, int *count,
		 struct fault *fault);

#endif
