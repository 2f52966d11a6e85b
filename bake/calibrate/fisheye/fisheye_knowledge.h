/* SPDX-License-Identifier: MIT */
/* What is known of a fisheye lens: where it shows things, how well, and what that means over the
 * whole of its image circle. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_KNOWLEDGE_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_KNOWLEDGE_H

#include "bake/calibrate/estimate/finding.h"
#include "bake/calibrate/fisheye/fisheye_optics.h"

enum { KNOWLEDGE_COUNT = OPTICS_COUNT + 3 };

struct oriented_lens {
	struct optics optics;
	double rotation[9]; /* world to camera */
};

struct lens_knowledge {
	struct oriented_lens lens;
	double field_rad;
	int width, height; /* of the picture; 0: not known */
	/* Of the optics' numbers, then of turns about the camera's axes, rad. */
	double covariance[KNOWLEDGE_COUNT][KNOWLEDGE_COUNT];
	bool halved;
	struct oriented_lens half[2]; /* from odd and from even points */
};

/* The whole and a half: the lens that the parameters make. Everything else is 0. */
void knowledge_begin(struct lens_knowledge *knowledge, const struct optics *optics,
		     const double rotation[9]);

/* As struct finding has them; context is a struct lens_knowledge. */
double knowledge_uncertainty(const void *context, const double px[2]);
double knowledge_disagreement(const void *context, const double px[2]);

struct circle_errors {
	double mean_px, most_px; /* one standard deviation of where a direction is seen */
	double most_deg;	 /* the same on the sky */
	double halves_px;	 /* the largest disagreement of the halves; 0 without halves */
};

/* Over the part of the image circle that lies in the picture. */
struct circle_errors knowledge_errors(const struct lens_knowledge *knowledge);

/* The angle from the axis at which the lens shows px, degrees; NAN beyond what it shows. */
double knowledge_angle_deg(const struct lens_knowledge *knowledge, const double px[2]);

/* Adds the circle's figures to a finding, and what reports call. */
void knowledge_publish(const struct lens_knowledge *knowledge, struct finding *finding);

#endif
