/* SPDX-License-Identifier: MIT */
/*
 * The result of a geometric calibration in the form that reports, JSON and tests read, whatever the
 * lens: points, parameters, figures, uncertainty over the picture. The solvers fill it; report/
 * shows it.
 */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_FINDING_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_FINDING_H

#include <stdio.h>

#include "bake/calibrate/estimate/estimate.h"
#include "bake/calibrate/estimate/verdict.h"
#include "bake/calibrate/observe/observations.h"

#define FINDING_FIGURES_MAX 24

/* One figure in the user's terms. */
struct finding_figure {
	char key[32];	/* name in JSON: "object_error_px" */
	char label[96]; /* for people: "uncertainty at the object's place" */
	char unit[8];
	double value;
};

struct finding {
	const char *what;		 /* "camera", "fisheye" */
	char model[64];			 /* "Tsai, undistorted from distorted", "equidistant" */
	int width, height;		 /* of the picture */
	const struct observations *seen; /* borrowed */
	/* [seen->count]: where the model projects each point, px */
	double (*expected)[2];
	double *weight; /* [seen->count]: weights of the robust loss, 0..1; below 0.1: an outlier */
	struct estimate estimate;
	double rms_px;	 /* RMS distance between seen and expected, without outliers */
	double worst_px; /* the largest such distance */
	struct finding_figure figure[FINDING_FIGURES_MAX];
	int figures;
	struct verdict verdict;
	/*
	 * Uncertainty of the model at px: one standard deviation, in px, of the projection of a
	 * thing that is seen at px and lies at the distance of the observed points. Negative: px is
	 * outside of what the model sees.
	 */
	double (*uncertainty)(const void *context, const double px[2]);
	/* Projects a point of the world of a view into its picture. False: it has no image. NULL:
	 * not known. */
	bool (*project)(const void *context, int view, const double world[3], double px[2]);
	const void *context; /* first argument of both; borrowed */
};

/* Creates a finding with room for the points of seen, trusted so far. -ENOMEM. */
int finding_create(struct finding *finding, const char *what, const struct observations *seen);
void finding_free(struct finding *finding); /* idempotent; zeroed is fine */

/* Doubts the finding if a view lists the same point at the same place twice. */
void finding_doubt_twins(struct finding *finding);

/* Prints the verdict and, if a lens was found, its residuals and figures, as lines that begin with
 * before. */
void finding_print(FILE *to, const char *before, const struct finding *finding);

/* Adds a figure; more than FINDING_FIGURES_MAX would end the program: that is then too small. */
void finding_add(struct finding *finding, const char *key, const char *label, const char *unit,
		 double value);

#endif
