/* SPDX-License-Identifier: MIT */
/* A fisheye lens with its uncertainty: the projection, its covariance, and the errors over the
 * image circle that follow. */
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
	int width, height; /* size of the picture; 0: not known */
	/* Covariance of the optics' numbers, then of turns about the camera's axes, rad. */
	double covariance[KNOWLEDGE_COUNT][KNOWLEDGE_COUNT];
};

/* Starts with a lens and its rotation. Everything else is 0. */
void knowledge_begin(struct lens_knowledge *knowledge, const struct optics *optics,
		     const double rotation[9]);

/* Callback of struct finding; context is a struct lens_knowledge. */
double knowledge_uncertainty(const void *context, const double px[2]);

struct circle_errors {
	double mean_px, most_px; /* standard deviation of the projection of a direction */
	double most_deg;	 /* the largest, as an angle in the world */
};

/* Computes the errors over the part of the image circle that lies in the picture. */
struct circle_errors knowledge_errors(const struct lens_knowledge *knowledge);

/* Returns the angle from the axis that px shows, degrees; NAN beyond the lens's range. */
double knowledge_angle_deg(const struct lens_knowledge *knowledge, const double px[2]);

/* Adds the circle's figures and the callbacks to a finding. */
void knowledge_publish(const struct lens_knowledge *knowledge, struct finding *finding);

#endif
