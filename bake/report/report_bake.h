/* SPDX-License-Identifier: MIT */
/* A bake of a report's scene, and what all ways to use it share. */
#ifndef INLAY_BAKE_REPORT_REPORT_BAKE_H
#define INLAY_BAKE_REPORT_REPORT_BAKE_H

#include "bake/scene/scene.h"
#include "bake/tiles/render.h"
#include "hal/basis/basis.h"
#include "hal/frame/frame.h"
#include "hal/frame/view.h"
#include "hal/lights/sampler.h"
#include "hal/mirror/mirror_map.h"
#include "hal/optics/panorama.h"

/* Panoramas are exposed so that white ground has this radiance in its brightest channel, as a
 * camera would be set. */
#define REPORT_WHITE 0.6

struct report_lighting {
	char name[64];
	struct image image;
	struct panorama panorama; /* scaled to REPORT_WHITE */
	struct image fisheye;	  /* linear radiance, upright, a square */
	struct mirror_map mirror; /* the same as mirrors show it */
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

#define REPORT_LIGHTINGS_MAX 8

/* The surroundings in which pictures are measured, all of one size. */
struct report_stage {
	int width, height, lightings;
	struct report_lighting lighting[REPORT_LIGHTINGS_MAX];
	struct pool *all;	  /* one thread for each processor, for what is not timed */
	int repeat;		  /* how often each frame is timed */
	int64_t timed_ns, ran_ns; /* of frames with one thread: by the clock, by the processor */
};

struct report_bake {
	char name[48]; /* what differs from the setting in use, as a line of the scene file */
	struct render_settings settings;
	struct render_report report;
	struct basis basis;
	double seconds;	      /* processor time that it took */
	float (*radiance)[3]; /* [lightings][lights] */
	/* Its pictures in double precision, of the exact layer and all lights:
	 * [height][width][3], as truth. Those of a bake without an exact layer are those of
	 * another, which owns them. */
	double *precise[REPORT_LIGHTINGS_MAX];
};

/* Bakes into a temporary file in folder, which is unlinked before this returns: the open basis
 * keeps it. name and settings are set before. reference: a bake of the same lights with an exact
 * layer, for one without, which must outlive it. */
int report_bake_make(struct report_bake *bake, struct scene *scene,
		     const struct report_bake *reference, struct report_stage *stage,
		     const char *folder, struct fault *fault);

void report_bake_close(struct report_bake *bake); /* idempotent; zeroed is fine */

#endif
