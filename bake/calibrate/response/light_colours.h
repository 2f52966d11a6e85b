/* SPDX-License-Identifier: MIT */
/*
 * The 3x3 colour matrix between two cameras, from patches that both have seen, in linear R, G, B:
 *     background = colours * fisheye
 * by least squares of the differences relative to a patch's brightness.
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
	/* row by row; the mean of its row sums is 1, so grey keeps its brightness */
	double matrix[9];
	double scale; /* common factor: background / fisheye; gain corrects it */
	/* condition of the equations: 1 is best, infinite if all patches are grey */
	double condition;
	double before, after; /* rms relative difference: with scale alone; with colours */
	double residual[LIGHT_PATCHES_MAX]; /* rms relative difference of each patch */
	int patches;
	struct estimate estimate; /* "red from red", ...: elements of matrix, row by row */
	struct verdict verdict;
};

/* Finds the matrix. -EINVAL: fewer than 3 patches, too many, or a black one; -ENOMEM. */
int light_colours_find(struct light_colours *found, const struct light_colour_pair *pairs,
		       int count, struct fault *fault);
void light_colours_free(struct light_colours *found); /* idempotent; zeroed is fine */

/* Reads lines of six numbers, `r g b` of the fisheye and `r g b` of the background; blank lines and
 * what follows # are ignored. Returns how many lines, or -EINVAL with file and line, -ENOENT... */
int light_colours_read(const char *path, struct light_colour_pair pairs[LIGHT_PATCHES_MAX],
		       struct fault *fault);

#endif
