/* SPDX-License-Identifier: MIT */
/* Trials: time, memory and error of one way to make the picture. */
#ifndef INLAY_BAKE_REPORT_REPORT_TRIAL_H
#define INLAY_BAKE_REPORT_REPORT_TRIAL_H

#include "bake/report/report_bake.h"
#include "bake/report/report_rank.h"
#include "hal/compositor/compositor.h"
#include "hal/measure/measure.h"

struct report_errors {
	struct composite_error each[REPORT_LIGHTINGS_MAX];
	/* Over all lightings: RMS and PSNR of all their pixels, the largest, the mean contrast. */
	struct composite_error all;
};

struct report_trial {
	char name[64]; /* what differs from the setting in use, as lines of a file */
	const struct report_bake *bake;
	enum compositor_mode mode;
	double threshold, budget; /* struct light_selection */
	enum threshold_mode threshold_mode;
	double column_cut; /* of white */
	/* The results, over all lightings: */
	struct turns_spread ms;	      /* of a frame; means */
	double read_mb, used_percent; /* of the basis a frame; of the lights; means */
	struct report_errors truth;   /* RMS and PSNR without its noise */
	struct report_errors precise; /* against double precision */
};

/*
 * Times all trials in turns (hal/measure/measure.h) under each lighting with one thread, and
 * measures the errors of their pictures over the pixels of the scope. Those of the first trial are
 * left in the lightings. -EIO, -ENOMEM.
 */
int report_trials_run(struct report_trial *trials, int count, struct report_stage *stage,
		      const struct scope *scope, struct fault *fault);

/* The time and the error against truth. */
struct report_result report_result_of(const struct report_trial *trial);

#endif
