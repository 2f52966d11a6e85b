/* SPDX-License-Identifier: MIT */
/* A first guess of all unknowns, near enough for the descent, from any number of views. */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_GUESS_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_GUESS_H

#include "bake/calibrate/camera/camera_problem.h"

struct camera_start {
	/* Given: centre and aspect always; focal (above 0) and kappa1 if known. */
	double shared[MODEL_SHARED];
	bool known; /* focal and kappa1 are given */
	/* there may be outliers: take the guess with the least median error of many small
	 * samples */
	bool robust;
};

/*
 * Guesses all unknowns. One view of a plane: Tsai's coplanar stage; a view of points in space: his
 * non-coplanar stage (s is then in x[MODEL_ASPECT]); several planes: Zhang's focal length from
 * their homographies. Of the two tilts that a plane seen from afar allows, the one that fits better
 * is taken. kappa1 is tried in steps where 0 leaves more than a hundredth of the picture's extent.
 *
 * x[problem_unknowns()]. Returns 0; -ERANGE, -EDOM: no guess (points on a line, or in no order that
 * a camera sees); -ENOMEM.
 */
int camera_guess(const struct camera_problem *problem, const struct camera_start *start, double *x);

/* Computes the pose of a view whose plane is tilted the other way about the line of sight, which
 * looks the same from afar. */
void camera_tilt(const struct camera_problem *problem, int view, const double *x, double *tilted);

#endif
