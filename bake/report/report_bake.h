/* SPDX-License-Identifier: MIT */
/* An open bake of a report's scene, and what all ways to use it share. */
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
	struct render_settings settings; /* of the bake, where the report has made it */
	struct render_report report;
	struct basis basis;
	bool exact; /* there is an exact layer */
	/* The bake whose exact layer is the reference of errors; NULL: this one. It has the same
	 * lights and must outlive this bake. */
	struct report_bake *reference;
	double shown_mb, exact_mb;
	double patterns, columns; /* of the shown layer, means over its pixels */
	/* made on first use: */
	struct dome dome;
	float (*radiance)[3];		       /* [lightings][lights] */
	double *precise[REPORT_LIGHTINGS_MAX]; /* [height][width][3], as truth */
};

/* Bakes into a temporary file in folder, which is unlinked before this returns. The open basis
 * keeps it. */
int report_bake_make(struct report_bake *bake, struct scene *scene,
		     const struct render_settings *settings, const char *folder,
		     struct fault *fault);

void report_bake_close(struct report_bake *bake); /* idempotent; zeroed is fine */

/* Processor time of the bake, in s. NAN: the report has not made it. */
double report_bake_seconds(const struct report_bake *bake);

/* Radiance of the lights under a lighting: [lights], owned by the bake.
 * NULL with a fault. */
const float (*report_bake_radiance(struct report_bake *bake, const struct report_stage *stage,
				   int lighting, struct fault *fault))[3];

/* The picture of report_bake_layer() in double precision, with all lights: [height][width][3],
 * owned by the bake. NULL with a fault. */
const double *report_bake_precise(struct report_bake *bake, const struct report_stage *stage,
				  int lighting, struct fault *fault);

/* The exact layer, or the shown one where there is no exact one. */
const struct basis_layer *report_bake_layer(const struct report_bake *bake);

#endif
