/* SPDX-License-Identifier: MIT */
/* One of the surroundings in which a report measures: what both cameras see of it, and the
 * path-traced composite. */
#ifndef INLAY_BAKE_REPORT_REPORT_LIGHTING_H
#define INLAY_BAKE_REPORT_REPORT_LIGHTING_H

#include "bake/scene/scene.h"
#include "hal/frame/frame.h"
#include "hal/frame/view.h"
#include "hal/optics/panorama.h"

/* Panoramas are exposed so that white ground has this radiance in its brightest channel, as a
 * camera would be set. */
#define REPORT_WHITE 0.6

struct report_lighting {
	char name[64];
	struct image image;
	struct panorama panorama; /* scaled to REPORT_WHITE */
	struct image fisheye;	  /* linear radiance, upright, a square */
	struct canvas background; /* 8 bits, sRGB */
	struct picture background_picture;
	struct canvas composite; /* by the setting in use */
	double *truth;		 /* [height][width][3]: 0..255, sRGB, not rounded */
	double *half[2];	 /* the same of either half of the samples, whose mean truth is */
	double truth_noise, bake_noise; /* standard errors in levels, once they are measured */
};

struct report_lighting_settings {
	const char *path; /* of a panorama; NULL: a made one */
	int made;	  /* its index in report_sky_names */
	int fisheye_side;
	int truth_samples;
	int threads, seed;
	bool quiet;
};

/* -EINVAL: the panorama holds code values; or the error of reading or rendering. The caller closes
 * the lighting also after a failure. */
int report_lighting_open(struct report_lighting *lighting, const struct scene *scene,
			 const struct report_lighting_settings *settings, struct fault *fault);
void report_lighting_close(struct report_lighting *lighting); /* idempotent; zeroed is fine */

#endif
