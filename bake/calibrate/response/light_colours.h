/* SPDX-License-Identifier: MIT */
/*
 * The 3x3 matrix between two cameras' colours, from patches that both have seen: background =
 * colours * fisheye, linear R, G, B; least squares of what differs relative to a patch's
 * brightness.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_COLOURS_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_COLOURS_H

#include <stdbool.h>

#include "bake/calibrate/estimate/estimate.h"
#include "bake/calibrate/estimate/verdict.h"
#include "hal/base/fault.h"

#define LIGHT_PATCHES_MAX 256

struct light_colour_pair {
	double fisheye[3], background[3]; /* linear, >= 0 */
};

struct light_colours {
	double matrix[9]; /* row by row; its rows' mean sum is 1: grey keeps its brightness */
	double scale;	  /* of all of it: background / fisheye; gain's part */
	double condition; /* of the equations: 1 is best, infinite where patches are all grey */
	double before,
		after; /* rms difference, relative to brightness: scale alone; with colours */
	double residual[LIGHT_PATCHES_MAX]; /* relative, of each patch */
	int patches;
	struct estimate estimate; /* "red from red", ... of matrix, row by row */
	struct verdict verdict;
};

/* keep_white: each row's sum is 1, so that grey stays grey (white balance is gain's, or none).
 * -EINVAL: fewer than 3 patches, or too many, or one that is black; -ENOMEM. */
int light_colours_find(struct light_colours *found, const struct light_colour_pair *pairs,
		       int count, bool keep_white, struct fault *fault);
void light_colours_free(struct light_colours *found); /* idempotent; zeroed is fine */

/* Lines of six numbers, `r g b` of the fisheye and `r g b` of the background; blank lines and what
 * follows # are passed over. How many, or -EINVAL with file and line, -ENOENT... */
int light_colours_read(const char *path, struct light_colour_pair pairs[LIGHT_PATCHES_MAX],
		       struct fault *fault);

#endif
