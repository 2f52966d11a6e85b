/* SPDX-License-Identifier: MIT */
/* First guesses in closed form from chosen points. Private to camera_guess*.c. */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_GUESS_CLOSED_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_GUESS_CLOSED_H

#include "bake/calibrate/camera/camera_guess.h"

#define GUESS_POINTS 200 /* number of points that suffices to judge a guess */

/* Points of one view as the closed forms use them. */
struct gathered {
	int count;
	double (*place)[3];  /* world axes */
	double (*plane)[2];  /* in the view's own axes */
	double (*sensor)[2]; /* without distortion */
};

struct guesser {
	const struct camera_problem *problem;
	const struct camera_start *start;
	double shared[MODEL_SHARED]; /* under trial; focal is 1 while it is not known */
	int *chosen;		     /* [count]: indices of points, view after view */
	int *chosen_first;	     /* [views + 1] */
	struct gathered points;	     /* room for the largest view */
	double (*h)[9];		     /* [views] */
	bool *has_h;
	double *error; /* [count] */
	double *best;
};

/* Error below which a guess is good enough, px. */
double guess_good_enough(const struct guesser *g);

/* Computes a guess from the chosen points for one kappa1 (the known one, if it is known). Returns
 * 0; -ERANGE, -EDOM: the points do not determine one; -ENOMEM. */
int guess_from_chosen(struct guesser *g, double kappa, double *x);

#endif
