/* SPDX-License-Identifier: MIT */
/*
 * Least-squares fit of a fisheye lens to points: of boards whose poses are unknown, one pose for
 * each view; or in known directions, with one orientation.
 */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_SOLVE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_SOLVE_H

#include "bake/calibrate/estimate/least_squares.h"
#include "bake/calibrate/fisheye/fisheye_optics.h"
#include "bake/calibrate/observe/observations.h"
#include "hal/base/fault.h"

struct lens_pose {
	double rotation[9]; /* world to camera: camera = rotation world + translation */
	double translation[3];
};

struct lens_problem {
	const struct observations *seen;
	bool directions; /* world[] are directions: one pose, without translation */
	int step, first; /* uses points first, first + step...: 1 and 0 for all */
	bool plain;	 /* plain squares, even if there are outliers */
};

/* The first guess, and then the solution. */
struct lens_solution {
	struct optics optics;
	int poses;
	struct lens_pose *pose; /* [poses] */
	/* Parameters: optics.number, then for each pose three turns (rad, about the camera's axes,
	 * after its rotation) and, for boards, its translation. */
	int parameters;
	struct least_squares_fit fit;
};

int lens_poses(const struct lens_problem *problem);
int lens_pose_size(const struct lens_problem *problem); /* 3 or 6 parameters */
int lens_points(const struct lens_problem *problem);

/* Allocates the poses. -ENOMEM. */
int lens_solution_create(struct lens_solution *solution, const struct lens_problem *problem);
void lens_solution_free(struct lens_solution *solution); /* idempotent; zeroed is fine */

/* Copies a solution without its fit, as a first guess. -ENOMEM. */
int lens_solution_copy(struct lens_solution *copy, const struct lens_solution *from);

/* Improves the solution's optics (the terms only of the polynomial model) and poses: by plain
 * squares and, unless problem->plain, once more with a robust loss if there are outliers. Returns
 * what least_squares_solve() returns. */
int lens_solve(const struct lens_problem *problem, struct lens_solution *solution,
	       struct fault *fault);

/* Returns the standard deviation of a point, px, from the median of the residuals, which few
 * outliers hardly move. */
double lens_deviation(const struct lens_problem *problem, const struct lens_solution *solution);

/* Projects a point by the solution; false: it has no image. */
bool lens_expect(const struct lens_problem *problem, const struct lens_solution *solution,
		 const struct observation *point, double px[2]);

#endif
