/* SPDX-License-Identifier: MIT */
/* Between the parts of a first guess: closed forms from chosen points, and which points to choose.
 */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_GUESS_PARTS_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_GUESS_PARTS_H

#include "bake/calibrate/camera/camera_guess.h"

#define GUESS_POINTS 200 /* enough to judge a guess by */

/* Points of one view as the closed forms take them. */
struct gathered {
	int count;
	double (*place)[3];  /* world axes */
	double (*plane)[2];  /* along the view's own axes */
	double (*sensor)[2]; /* without distortion */
};

struct guesser {
	const struct camera_problem *problem;
	const struct camera_start *start;
	double shared[MODEL_SHARED]; /* under trial; focal 1 while it is not known */
	int *chosen;		     /* [count]: indices of points, view after view */
	int *chosen_first;	     /* [views + 1] */
	struct gathered points;	     /* room for the largest view */
	double (*h)[9];		     /* [views] */
	bool *has_h;
	double *error; /* [count] */
	double *best;
};

/* Less than this leaves nothing to wonder about in a guess, px. */
double guess_good_enough(const struct guesser *g);

/* From the chosen points, kappa1 being this (or what is known). 0; -ERANGE, -EDOM: they say
 * nothing; -ENOMEM. */
int guess_from_chosen(struct guesser *g, double kappa, double *x);

#endif
