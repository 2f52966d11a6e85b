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
 * Guesses all unknowns: tries some focal lengths, each with the poses that fit the views best
 * without distortion (camera_pose()), and keeps what fits best. Of the two tilts that a plane seen
 * from afar allows, the one that fits better is taken. kappa1 is tried in steps where 0 leaves more
 * than a hundredth of the picture's extent.
 *
 * x[problem_unknowns()]. Returns 0; -ERANGE: no guess (too few points, on a line, or in no order
 * that a camera sees); -ENOMEM.
 */
int camera_guess(const struct camera_problem *problem, const struct camera_start *start, double *x);

/* Finds the pose (as the unknowns of a view) in which points at these places are seen in these directions, in focal
 * lengths from the axis. False: there is none. */
bool camera_pose(int count, const double (*place)[3], const double (*seen)[2],
		 double pose[MODEL_OF_VIEW]);

/* Computes the pose of a view whose plane is tilted the other way about the line of sight, which
 * looks the same from afar. */
void camera_tilt(const struct camera_problem *problem, int view, const double *x, double *tilted);

#endif
