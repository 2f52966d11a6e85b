/* SPDX-License-Identifier: MIT */
/*
 * What a geometric calibration found, in the form that reports, JSON and tests read, whatever the
 * lens: marks, parameters, what is uncertain where. The solvers fill it, report.c shows it.
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
	char key[32];	/* in JSON: "object_error_px" */
	char label[96]; /* for people: "uncertainty at the object's place" */
	char unit[8];
	double value;
};

struct finding {
	const char *what;		 /* "camera", "fisheye" */
	char model[64];			 /* "Tsai, undistorted from distorted", "equidistant" */
	int width, height;		 /* of the picture */
	const struct observations *seen; /* borrowed */
	double (*expected)[2];		 /* [seen->count]: where the model puts each point, px */
	double *weight; /* [seen->count]: 0..1 of the robust loss; below 0.1 an outlier */
	struct estimate estimate;
	double rms_px;	 /* of the points' distances from where they are expected, outliers left out
			  */
	double worst_px; /* the same, the largest */
	struct finding_figure figure[FINDING_FIGURES_MAX];
	int figures;
	struct verdict verdict;
	/*
	 * One standard deviation, in px, of where the model sees a thing that appears at px and
	 * lies at the distance of what was observed. Negative: px is outside of what the model
	 * sees.
	 */
	double (*uncertainty)(const void *context, const double px[2]);
	/* Distance in px between the models fitted to odd and to even points, at px; NULL: too few
	 * points for two halves. */
	double (*disagreement)(const void *context, const double px[2]);
	const void *context; /* of both; borrowed */
};

/* Room for the points of seen. -ENOMEM. */
int finding_create(struct finding *finding, const char *what, const struct observations *seen);
void finding_free(struct finding *finding); /* idempotent; zeroed is fine */

/* Doubts the same point at the same place twice in a view. */
void finding_doubt_twins(struct finding *finding);

/* The verdict and, if a lens was found, how well it fits and the figures: lines, each after this.
 */
void finding_print(FILE *to, const char *before, const struct finding *finding);

/* At most FINDING_FIGURES_MAX. */
void finding_add(struct finding *finding, const char *key, const char *label, const char *unit,
		 double value);

#endif
