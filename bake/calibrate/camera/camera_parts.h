/* SPDX-License-Identifier: MIT */
/* Shared by the parts of a camera's calibration: solving, figures, verdict. */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_PARTS_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_PARTS_H

#include "bake/calibrate/camera/camera.h"
#include "bake/calibrate/camera/camera_problem.h"

/* Least noise of corners that verdicts assume, px: points that fit better do so by chance. */
#define CAMERA_NOISE_LEAST 0.03

/* Name of the figure that --tolerance limits, in reports and verdicts. */
#define CAMERA_OBJECT_ERROR "uncertainty at the object's place"

struct camera_private {
	const struct observations *seen;
	struct camera_task task;
	struct camera_problem problem;
	double centre[2];	    /* first guess of the axis, px, y down */
	double centre_deviation[2]; /* its standard deviation, px, used where the centre is held */
	double aspect;		    /* first guess of s */
	double aspect_deviation;    /* its standard deviation, used where s is held */
	double diagonal;	    /* of the picture, or of the points' bounding box, px */
	double *x;		    /* [problem_unknowns()]: the solution */
	bool *fixed;		    /* [problem_unknowns()]: held in the solution */
	struct least_squares_fit fit;
	int guess_error, fit_error; /* 0, or why there is no solution */
	struct fault why;
	bool mirrored; /* points in space: only their mirror image fits */
	/* rms of the solution that looks the same from afar, px; infinite: none. For a lone plane
	 * it is tilted the other way; for points in space it is their mirror image. */
	double other_tilt;
	double *half[2]; /* solutions of odd and even points, or NULL */
	double depth;	 /* mean depth of the reference view's points */
	double object[3], radius;
	/* Covariances [unknowns][unknowns]: from a held centre; from a held s; total, with the
	 * points' noise. */
	double *held, *held_aspect, *covariance;
	/* Total covariance with at least CAMERA_NOISE_LEAST of noise, and widened for few
	 * points. */
	double *cautious;
	double object_error; /* uncertainty at the object by cautious, px: --tolerance limits it */
	double noise_error;  /* the same if everything held were exact */
};

/* First guess and descents; fills x, fixed, fit, errors and halves. Returns 0 whatever is found;
 * -ENOMEM. */
int camera_solve(struct camera_private *own);

/* Fills held and held_aspect. -ENOMEM. */
int camera_hold(struct camera_private *own);

/* Computes the 2 x 2 covariance (xx, xy, yy), px^2, of the image of a world point in the reference
 * view. False: the point has no image, or nothing is known about it. */
bool camera_spread(const struct camera_private *own, const double *covariance,
		   const double world[3], double spread[3]);

/* Returns the standard deviation along the longest axis of such a covariance. */
double camera_spread_length(const double spread[3]);

/* Projects a point in the reference view, px. False: it has no image. */
bool camera_sees(const struct camera_private *own, const double world[3], double px[2]);

/* Returns the largest standard deviation at the object, px: at its place and at those of six points
 * at its radius that are in the picture. Infinite: its place has no image, or nothing is known of
 * it. */
double camera_object_error(const struct camera_private *own, const double *covariance);

/* Adds the figures to the finding: in px, in the scene and on the ground. */
void camera_figures(struct camera_solution *solution);

/* Callbacks of struct finding; context is struct camera_private. */
double camera_uncertainty(const void *context, const double px[2]);
double camera_disagreement(const void *context, const double px[2]);

void camera_judge(struct camera_solution *solution);
/* Parts of it: the points as given, and how much of the picture they cover. */
void camera_judge_points(struct camera_solution *solution);
void camera_judge_coverage(struct camera_solution *solution);

#endif
