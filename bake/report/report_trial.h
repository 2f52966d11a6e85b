/* SPDX-License-Identifier: MIT */
/* Trials: time, memory and error of one way to make the picture. */
#ifndef INLAY_BAKE_REPORT_REPORT_TRIAL_H
#define INLAY_BAKE_REPORT_REPORT_TRIAL_H

#include "bake/report/report_bake.h"
#include "hal/compositor/compositor.h"
#include "hal/measure/error.h"
#include "hal/measure/turns.h"

/* RMS of rounding to 8 bits, in levels: no picture is nearer to truth. */
#define REPORT_ROUNDING 0.289

struct report_way {
	struct report_bake *bake;
	double threshold; /* linear radiance */
	enum threshold_mode threshold_mode;
	enum compositor_mode mode;
	double column_cut; /* negative: the file's */
};

struct report_errors {
	struct composite_error each[REPORT_LIGHTINGS_MAX];
	/* Over all lightings: RMS and PSNR of all their pixels, the largest, the mean contrast. */
	struct composite_error all;
};

struct report_trial {
	struct report_way way;
	char name[96]; /* its label in the plot of all settings */
	/* filled in by report_trials_run(): */
	struct turns_spread ms;		     /* of a frame; means over the lightings */
	double read_mb;			     /* of the basis a frame, mean over the lightings */
	double lights[REPORT_LIGHTINGS_MAX]; /* how many are used */
	struct report_errors truth;	     /* RMS and PSNR without its noise */
	struct report_errors precise;	     /* against double precision */
};

/* The plain way: means over cells, no threshold, fast mode, the file's cut. */
struct report_way report_way_plain(struct report_bake *bake);

/*
 * Times all trials in turns (hal/measure/turns.h) under each lighting with one thread, and measures
 * the errors of their pictures over the pixels of the scope. -EIO, -ENOMEM.
 */
int report_trials_run(struct report_trial *trials, int count, struct report_stage *stage,
		      const struct scope *scope, struct fault *fault);

/* Makes the first frame of a way under a lighting. */
int report_trial_picture(const struct report_way *way, struct report_stage *stage, int lighting,
			 struct canvas *out, struct fault *fault);

#endif
