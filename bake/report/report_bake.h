/* SPDX-License-Identifier: MIT */
/* A bake of a report's scene, and what all ways to use it share. */
#ifndef INLAY_BAKE_REPORT_REPORT_BAKE_H
#define INLAY_BAKE_REPORT_REPORT_BAKE_H

#include "bake/report/report_lighting.h"
#include "bake/tiles/render.h"
#include "hal/basis/basis.h"
#include "hal/lights/sampler.h"

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
		     const struct report_bake *reference, const struct report_stage *stage,
		     const char *folder, struct fault *fault);

void report_bake_close(struct report_bake *bake); /* idempotent; zeroed is fine */

#endif
