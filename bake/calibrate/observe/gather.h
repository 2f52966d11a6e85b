/* SPDX-License-Identifier: MIT */
/* The sources of observations: files of points, photographs of a board, or a live camera. */
#ifndef INLAY_BAKE_CALIBRATE_OBSERVE_GATHER_H
#define INLAY_BAKE_CALIBRATE_OBSERVE_GATHER_H

#include "bake/calibrate/observe/boards.h"
#include "bake/calibrate/observe/live.h"
#include "bake/calibrate/observe/observations.h"

struct gathering {
	struct observations seen;
	struct observed_view *boardless; /* [boardlesses]: photographs that are skipped */
	int boardlesses;
	int misfits, misfit_width, misfit_height; /* those of another size; the size of the last */
	struct image *picture; /* [pictures]: the photograph of each view; NULL for points */
	int pictures;
};

/* Reads files of points, each as one view. Returns what observations_read() returns. */
int gather_points(struct gathering *all, char *const *paths, int count,
		  const struct points_convention *convention, struct fault *fault);

/*
 * Finds the board in photographs, each as one view. A pattern is a file name or a shell pattern.
 * Photographs without the board, of another size than most, damaged, or of a kind that is not read,
 * are named in the log and skipped, but keep their numbers. -ENOENT: no such file, or the board is
 * in none of them (the fault says why for the last); else as image_read() and board_find().
 */
int gather_images(struct gathering *all, char *const *patterns, int count, struct board *board,
		  struct fault *fault);

/*
 * Collects views from a camera of a kiosk's configuration until there are as many as views, or
 * nothing is missing any more. world: number of the view that shows where the world is; 0: none.
 * Returns what live_open() and live_collect() return; the patience is a minute.
 */
int gather_live(struct gathering *all, const char *config, enum live_view view, struct board *board,
		int views, int world, struct fault *fault);

/* Moves the picture into the gathering, as that of the next view without one. -ENOMEM. */
int gather_keep(struct gathering *all, struct image *picture);

/*
 * Finds the view with this number (from 1, counting those that are skipped, too) or file
 * name. Returns its index; -ENOENT: the photograph of that number or name shows no board, and
 * *boardless becomes its file name; -EINVAL: there is none.
 */
int gather_view(const struct gathering *all, const char *text, const char **boardless);

void gather_free(struct gathering *all); /* idempotent; zeroed is fine */

#endif
