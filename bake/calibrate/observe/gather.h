/* SPDX-License-Identifier: MIT */
/* What a lens is calibrated from: files of points, photographs of a board, or a live camera. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_GATHER_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_GATHER_H

#include "bake/calibrate/observe/boards.h"
#include "bake/calibrate/observe/live.h"
#include "bake/calibrate/observe/observations.h"

struct gathering {
	struct observations seen;
	struct image *picture; /* [pictures]: of each view; NULL for points */
	int pictures;
};

/* Each file a view. As observations_read(). */
int gather_points(struct gathering *all, char *const *paths, int count,
		  const struct points_convention *convention, struct fault *fault);

/*
 * Each file, or each that a pattern of the shell names, a view; photographs without the board are
 * named in the log and passed over. -ENOENT: no such file, or the board is in none of them (the
 * fault says why of the last); as image_read() and board_find().
 */
int gather_images(struct gathering *all, char *const *patterns, int count,
		  const struct board *board, struct fault *fault);

/*
 * Looks through a camera of a kiosk's configuration until the board was seen in this many places,
 * or nothing is missing any more. As live_open() and live_collect(), with a patience of a minute.
 */
int gather_live(struct gathering *all, const char *config, enum live_view view,
		const struct board *board, int views, struct fault *fault);

/* Takes over the picture of the next view that has none. -ENOMEM. */
int gather_keep(struct gathering *all, struct image *picture);

/* The view with this number (counted from 1) or file name, or -1. */
int gather_view(const struct gathering *all, const char *text);

void gather_free(struct gathering *all); /* idempotent; zeroed is fine */

#endif
