/* SPDX-License-Identifier: MIT */
/*
 * A fisheye lens from points: of boards whose places are not known, each view with a pose of its
 * own, or things in known directions, seen with one orientation.
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
	int step, first; /* points first, first + step...: 1 and 0 for all */
	bool plain;	 /* as if there were no outliers */
};

/* Where it starts from, and what it finds. */
struct lens_solution {
	struct optics optics;
	int poses;
	struct lens_pose *pose; /* [poses] */
	/* Parameters: optics.number, then for each pose three turns (rad, about the camera's axes,
	 * after its rotation) and, of boards, its translation. */
	int parameters;
	struct least_squares_fit fit;
};

int lens_poses(const struct lens_problem *problem);
int lens_pose_size(const struct lens_problem *problem); /* 3 or 6 parameters */
int lens_points(const struct lens_problem *problem);

/* Room for the poses. -ENOMEM. */
int lens_solution_create(struct lens_solution *solution, const struct lens_problem *problem);
void lens_solution_free(struct lens_solution *solution); /* idempotent; zeroed is fine */

/* A copy without the fit, to start from. -ENOMEM. */
int lens_solution_copy(struct lens_solution *copy, const struct lens_solution *from);

/* Improves the solution's optics (terms only of the polynomial model) and poses: by plain squares,
 * and, unless the problem is to be plain, with a loss that takes less from outliers if there are
 * any. As least_squares_solve(). */
int lens_solve(const struct lens_problem *problem, struct lens_solution *solution,
	       struct fault *fault);

/* A point's deviation, px, by the median of the residuals, which few outliers hardly move. */
double lens_deviation(const struct lens_problem *problem, const struct lens_solution *solution);

/* Where the solution puts a point; false: nowhere. */
bool lens_expect(const struct lens_problem *problem, const struct lens_solution *solution,
		 const struct observation *point, double px[2]);

#endif
