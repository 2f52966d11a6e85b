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

/* What is known of the axis and of s before the points are looked at. */
struct camera_guess {
	double centre[2];	    /* first guess of the axis, px, y down */
	double centre_deviation[2]; /* its standard deviation, px, used where the centre is held */
	double aspect;		    /* first guess of s */
	double aspect_deviation;    /* its standard deviation, used where s is held */
};

struct camera_uncertainty {
	/* Covariances [unknowns][unknowns]: from a held centre; from a held s; total, with the
	 * points' noise. */
	double *held, *held_aspect, *covariance;
	/* Total covariance with at least CAMERA_NOISE_LEAST of noise, and widened for few
	 * points. */
	double *cautious;
	double object_error; /* uncertainty at the object by cautious, px: --tolerance limits it */
	double noise_error;  /* the same if everything held were exact */
};

struct camera_private {
	const struct observations *seen;
	struct camera_task task;
	struct camera_problem problem;
	struct camera_guess guess;
	double diagonal; /* of the picture, or of the points' bounding box, px */
	int radial;	 /* terms of the radial polynomial in use, 1 to MODEL_RADIAL */
	/* Terms that describe the lens better (camera_radial.c), and the rms of points that were
	 * left out and predicted with so many terms, px; 0: not tried. */
	int radial_wanted;
	double left_out[MODEL_RADIAL + 1];
	double *x;   /* [problem_unknowns()]: the solution */
	bool *fixed; /* [problem_unknowns()]: held in the solution */
	struct least_squares_fit fit;
	int guess_error, fit_error; /* 0, or why there is no solution */
	struct fault why;
	/* rms of the solution in which a lone plane is tilted the other way, which looks the same
	 * from afar, px; infinite: none. */
	double other_tilt;
	double depth; /* mean depth of the reference view's points */
	double object[3], radius;
	struct camera_uncertainty uncertainty;
};

/* First guess and descents; fills x, fixed, fit and errors. Returns 0 whatever is found;
 * -ENOMEM. */
int camera_solve(struct camera_private *own);

/* Decrease of the sum of squares, in units of the noise's variance, that more radial terms would
 * bring to first order. -ENOMEM. */
int camera_radial_gain(const struct camera_private *own, double *gain);

/* What the solution predicts of points that it was not fitted to: their loss (squared distance,
 * less for outliers), by view, or by fold where there are few views. */
struct camera_left_out {
	double *loss;
	int count;  /* views or folds */
	int points; /* predicted */
};

/* Leaves a fifth of the views, or of a lone view's points, out in turn, solves, and predicts them;
 * width: of the loss, px; 0: plain squares. -ENOMEM. */
int camera_leave_out(const struct camera_private *own, double width, struct camera_left_out *out);

/* Whether b predicts better than a: its loss is less by more than least, and by more than the
 * deviation of the difference. */
bool camera_predicts_better(const struct camera_left_out *a, const struct camera_left_out *b,
			    double least);

/* Distorted radius up to which the distortion grows; *reach: that of the farthest corner (or
 * point); sensor units. */
double camera_grows_to(const struct camera_private *own, double *reach);

/* The mean residual that noise explains least. */
struct camera_structure {
	bool ring;	       /* else a part of the picture */
	double mean_px;	       /* outwards in a ring; right or down in a part */
	double deviation_px;   /* that noise and differences between views make */
	double sigmas;	       /* their ratio */
	double from_px, to_px; /* radii of a ring */
	double at_px[2];       /* middle of a part */
	int group;	       /* private */
};

void camera_find_structure(const struct camera_private *own, struct camera_structure *found);

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
bool camera_project_view(const void *context, int view, const double world[3], double px[2]);

void camera_judge(struct camera_solution *solution);
/* Parts of it: the points as given, and how much of the picture they cover. */
void camera_judge_points(struct camera_solution *solution);
void camera_judge_coverage(struct camera_solution *solution);

#endif
