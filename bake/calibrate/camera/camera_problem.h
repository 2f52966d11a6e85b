/* SPDX-License-Identifier: MIT */
/* What there is to solve: a model, the points of some views, and where they should be seen. */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_PROBLEM_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_PROBLEM_H

#include "bake/calibrate/camera/camera_model.h"
#include "bake/calibrate/estimate/least_squares.h"
#include "bake/calibrate/observe/observations.h"

/* Of the robust loss, in sigmas: 95 % of what plain squares make of good points. */
#define CAMERA_LOSS 2.4
/* Below this share of the length, points are taken for a plane or a line. */
#define SHAPE_FLAT 1e-3

/* How the points of a view lie in the world. */
struct view_shape {
	double middle[3];
	double axes[9];	    /* rows: along the points, across, out of their plane */
	double size;	    /* root mean square distance from the middle; 1 where all are one */
	double across, out; /* spread along the second and third axis over that along the first */
};

struct camera_problem {
	struct camera_model model;
	const struct observation *point; /* [count], borrowed */
	double (*place)[3];		 /* [count]: world less its view's middle */
	const bool *unused;		 /* [count], borrowed: left out; NULL: none */
	int count;
	struct view_shape *shape; /* [views] */
	int *first;		  /* [views + 1]: points of a view */
	int views, first_view;	  /* the point's own view less this counts from 0 */
	double reach; /* largest distance of a point from the given centre, sensor units, > 0 */
};

/* centre: px, down. Views without points are allowed. -ENOMEM. */
int problem_create(struct camera_problem *problem, const struct observations *seen,
		   const struct camera_model *model, const double centre[2]);
void problem_free(struct camera_problem *problem);

/* The same for one view, borrowing everything; it has model_unknowns(1). */
struct camera_problem problem_of_view(const struct camera_problem *problem, int view);

static inline int problem_unknowns(const struct camera_problem *problem)
{
	return model_unknowns(problem->views);
}

static inline bool problem_flat(const struct camera_problem *problem, int view)
{
	return problem->shape[view].out < SHAPE_FLAT;
}

/* Where the model sees the points, [count]; px of those it does not see are NAN. How many it does
 * not. */
int problem_expect(const struct camera_problem *problem, const double *x, double (*px)[2]);

/* Root mean square distance, px, of the used points; infinite where one is not seen. */
double problem_rms(const struct camera_problem *problem, const double *x);

/*
 * Descends from x with the unknowns of fixed held. As least_squares_solve(); fit may be NULL.
 * loss_scale: 0 for plain squares. stay: x is left as it is.
 */
int problem_descend(const struct camera_problem *problem, double *x, const bool *fixed,
		    double loss_scale, bool stay, struct least_squares_fit *fit,
		    struct fault *fault);

/* Slopes of all of them: jacobian[2 count][unknowns], 0 to begin with. */
void problem_slopes(const struct camera_problem *problem, const double *x, double *jacobian);

/* "focal", "view 2 rotation x"; the view is named where there are several. */
void problem_name(const struct camera_problem *problem, int unknown, char *name, int room);

#endif
