/* SPDX-License-Identifier: MIT */
/* The least-squares problem: a camera model, the points of some views, and where they are seen. */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_PROBLEM_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_PROBLEM_H

#include "bake/calibrate/camera/camera_model.h"
#include "bake/calibrate/estimate/least_squares.h"
#include "bake/calibrate/observe/observations.h"

/* Width of the robust loss, in sigmas: 95 % of the efficiency of plain squares on good points. */
#define CAMERA_LOSS 2.4
/* Points whose extent is below this share of their length lie in a plane, or on a line. */
#define SHAPE_FLAT 1e-3

/* Distribution of a view's points in the world. */
struct view_shape {
	double middle[3];
	/* rows: principal axes of the points, the longest first, the last out of their plane */
	double axes[9];
	double size;	    /* RMS distance from the middle; 1 where all points coincide */
	double across, out; /* spread along the second and third axis, relative to the first */
};

struct camera_problem {
	struct camera_model model;
	const struct observed_view *view; /* [views], borrowed */
	const struct observation *point;  /* [count], borrowed */
	double (*place)[3];		  /* [count]: world position minus the view's middle */
	const bool *unused;		  /* [count], borrowed: points left out; NULL: none */
	int count;
	struct view_shape *shape; /* [views] */
	int *first;		  /* [views + 1]: first point of each view */
	int views, first_view;	  /* first_view: subtracted from a point's view to count from 0 */
	double reach; /* largest distance of a point from the centre, sensor units, > 0 */
};

/* Prepares the problem. centre: px, y down. Views without points are allowed. -ENOMEM. */
int problem_create(struct camera_problem *problem, const struct observations *seen,
		   const struct camera_model *model, const double centre[2]);
void problem_free(struct camera_problem *problem);

/* Returns the problem of one view, which borrows everything; it has model_unknowns(1) unknowns. */
struct camera_problem problem_of_view(const struct camera_problem *problem, int view);

static inline int problem_unknowns(const struct camera_problem *problem)
{
	return model_unknowns(problem->views);
}

static inline bool problem_flat(const struct camera_problem *problem, int view)
{
	return problem->shape[view].out < SHAPE_FLAT;
}

/* Projects the points to px[count], NAN for those without an image. Returns how many have none. */
int problem_expect(const struct camera_problem *problem, const double *x, double (*px)[2]);

/* RMS distance between seen and projected points in use, px; infinite where one has no image. */
double problem_rms(const struct camera_problem *problem, const double *x);

/*
 * Minimises from x, holding the unknowns marked in fixed. Returns what least_squares_solve()
 * returns; fit may be NULL. loss_scale: 0 for plain squares.
 */
int problem_descend(const struct camera_problem *problem, double *x, const bool *fixed,
		    double loss_scale, struct least_squares_fit *fit, struct fault *fault);

/* Computes the Jacobian of the projections, jacobian[2 count][unknowns], which must be 0
 * beforehand. */
void problem_slopes(const struct camera_problem *problem, const double *x, double *jacobian);

/* Writes the name of an unknown: "focal", or "view 2 rotation x" where there are several views. */
void problem_name(const struct camera_problem *problem, int unknown, char *name, int room);

struct camera_start {
	/* Given: centre and aspect always; focal (above 0) and kappa1 if known. */
	double shared[MODEL_SHARED];
	bool known; /* focal and kappa1 are given */
};

/*
 * Guesses all unknowns: tries some focal lengths, each with the poses that fit the views best
 * (camera_pose()), and keeps what fits best. An unknown kappa1 stays as it is given.
 *
 * x[problem_unknowns()]. Returns 0; -ERANGE: no guess (too few points, on a line, or in no order
 * that a camera sees); -ENOMEM.
 */
int camera_guess(const struct camera_problem *problem, const struct camera_start *start, double *x);

/* Finds the pose (as the unknowns of a view) in which points at these places are seen in these
 * directions, in focal lengths from the axis. False: there is none. */
bool camera_pose(int count, const double (*place)[3], const double (*seen)[2],
		 double pose[MODEL_OF_VIEW]);

/* Computes the pose of a view whose plane is tilted the other way about the line of sight, which
 * looks the same from afar. */
void camera_tilt(const struct camera_problem *problem, int view, const double *x, double *tilted);

#endif
