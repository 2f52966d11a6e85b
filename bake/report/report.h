/* SPDX-License-Identifier: MIT */
/*
 * The report of a scene: what each choice costs in time and memory, and how wrong the picture gets,
 * against double precision and against path-traced truth. One page, and every figure as CSV.
 */
#ifndef INLAY_BAKE_REPORT_REPORT_H
#define INLAY_BAKE_REPORT_REPORT_H

#include "bake/report/report_bake.h"
#include "hal/base/fault.h"
#include "hal/options/options.h"

struct report_settings {
	const char *input;	      /* a scene file */
	const char *pose;	      /* of the scene, by name or number; NULL: its first */
	const char *folder;	      /* of the report; appears when it is complete */
	struct option_list panoramas; /* none: made surroundings (report_sky.c) */
	int width, height;	      /* of pictures that are baked and traced; 0: chosen */
	int samples;		      /* a pixel, of bakes; 0: chosen */
	int truth_samples;	      /* 0: chosen */
	int most_frequency;	      /* of the domes that are tried; 0: chosen */
	int repeat;		      /* of each timing; 0: chosen */
	int threads;		      /* for baking and tracing; 0: one for each processor */
	bool quiet;
};

/* Writes the report. -errno with a fault; then the folder is as before. */
int report_run(const struct report_settings *settings, struct fault *fault);

#endif
