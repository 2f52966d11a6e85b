/* SPDX-License-Identifier: MIT */
/* The surroundings that a report holds everything against: what both cameras see of them, and the
 * finished picture, path traced. */
#ifndef INLAY_BAKE_REPORT_REPORT_LIGHTING_H
#define INLAY_BAKE_REPORT_REPORT_LIGHTING_H

#include "bake/scene/scene.h"
#include "hal/frame/frame.h"
#include "hal/frame/view.h"
#include "hal/optics/panorama.h"

/* Radiance of white ground, in its brightest channel: as a camera would be set. */
#define REPORT_WHITE 0.6

struct report_lighting {
	char name[64];
	struct image image;
	struct panorama panorama; /* exposed */
	double peak_ratio;	  /* the brightest texel of the sky over its mean */
	struct image fisheye;	  /* linear radiance, upright, a square */
	struct canvas background; /* 8 bits, sRGB */
	struct picture background_picture;
	double *truth;	     /* [height][width][3]: 0..255, sRGB, not rounded; NULL: none */
	double noise_levels; /* of it */
	double seconds;	     /* that it took */
};

struct report_lighting_settings {
	const char *path; /* a panorama; NULL: */
	int made;	  /* one of report_sky_names */
	int fisheye_side;
	int truth_samples; /* 0: no truth */
	int threads, seed;
	bool quiet;
};

/* scene NULL: no truth, and a background of this size that comes from no camera. -EINVAL: the file
 * holds code values; what reading and rendering give. To be freed in any case. */
int report_lighting_open(struct report_lighting *lighting, const struct scene *scene, int width,
			 int height, const struct report_lighting_settings *settings,
			 struct fault *fault);
void report_lighting_close(struct report_lighting *lighting); /* idempotent; zeroed is fine */

#endif
