/* SPDX-License-Identifier: MIT */
/* Between the parts of a camera's calibration: solving, figures, verdict. */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_PARTS_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_PARTS_H

#include "bake/calibrate/camera/camera.h"
#include "bake/calibrate/camera/camera_problem.h"

/* Corners are never measured better than this: what verdicts assume of points that fit by chance,
 * px. */
#define CAMERA_NOISE_LEAST 0.03

/* The figure that --tolerance is of, as reports and the verdict call it. */
#define CAMERA_OBJECT_ERROR "uncertainty at the object's place"

struct camera_private {
	const struct observations *seen;
	struct camera_task task;
	struct camera_problem problem;
	double centre[2];	    /* where the axis was first taken to be, px, down */
	double centre_deviation[2]; /* one deviation of that, px: of a centre that is held */
	double aspect;		    /* where s was first taken to be */
	double aspect_deviation;    /* one deviation of that, of an s that is held */
	double diagonal;	    /* of the picture, or of what the points cover, px */
	double *x;		    /* [problem_unknowns()]: the solution */
	bool *fixed;		    /* [problem_unknowns()]: held in it */
	struct least_squares_fit fit;
	int guess_error, fit_error; /* 0, or why there is no solution */
	struct fault why;
	bool mirrored; /* points in space: their mirror image fits instead */
	/* rms of what looks the same from afar, px; infinite: none. The lone plane tilted the other
	 * way; of points in space their mirror image. */
	double other_tilt;
	double *half[2]; /* solutions of odd and even points, or NULL */
	double depth;	 /* mean distance along the view of the reference view's points */
	double object[3], radius;
	/* [unknowns][unknowns]: what the held centre brings to it; a held s; both and the points'
	 * noise. */
	double *held, *held_aspect, *covariance;
	/* Covariance with at least CAMERA_NOISE_LEAST of noise, and widened for few points. */
	double *cautious;
	double object_error; /* by it, px: what --tolerance is of */
	double noise_error;  /* the same were all that is held exact */
};

/* Guess and descents; fills x, fixed, fit, errors, halves. 0 whatever is found; -ENOMEM. */
int camera_solve(struct camera_private *own);

/* Fills held and held_aspect. -ENOMEM. */
int camera_hold(struct camera_private *own);

/* 2 x 2 covariance in the picture, px^2, of where a point of the reference view's world is seen.
 * False: it is not seen, or nothing is known about it. */
bool camera_spread(const struct camera_private *own, const double *covariance,
		   const double world[3], double spread[3]);

/* One standard deviation along the longest axis of a spread. */
double camera_spread_length(const double spread[3]);

/* Whether the reference view has an image of a point, and where, px. */
bool camera_sees(const struct camera_private *own, const double world[3], double px[2]);

/* The largest of the object: its place and those of six points at its radius that are in
 * the picture.
 * Infinite: its place is not seen, or nothing is known of it. */
double camera_object_error(const struct camera_private *own, const double *covariance);

/* Figures of finding.h, in px, in the scene and on the ground. */
void camera_figures(struct camera_solution *solution);

/* finding.h's callbacks; context is struct camera_private. */
double camera_uncertainty(const void *context, const double px[2]);
double camera_disagreement(const void *context, const double px[2]);

void camera_judge(struct camera_solution *solution);
/* Of it, what the points say before anything is found from them, and how much of the picture they
 * cover. */
void camera_judge_points(struct camera_solution *solution);
void camera_judge_coverage(struct camera_solution *solution);

#endif
