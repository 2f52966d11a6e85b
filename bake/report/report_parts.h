/* SPDX-License-Identifier: MIT */
/* A report while it is made. Private to bake/report/. */
#ifndef INLAY_BAKE_REPORT_REPORT_PARTS_H
#define INLAY_BAKE_REPORT_REPORT_PARTS_H

#include <stdbool.h>

#include "bake/base/report_page.h"
#include "bake/report/report.h"
#include "bake/report/report_bake.h"
#include "bake/report/report_rank.h"
#include "bake/scene/scene.h"
#include "hal/base/fault.h"
#include "hal/compositor/compositor.h"
#include "hal/image/image.h"
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
 * the errors of their pictures over the pixels of the scope. Those of the first trial are left in
 * the lightings. -EIO, -ENOMEM.
 */
int report_trials_run(struct report_trial *trials, int count, struct report_stage *stage,
		      const struct scope *scope, struct fault *fault);

/* The time and the error against truth. */
struct report_result report_result_of(const struct report_trial *trial);

/* The setting in use, 8 domes, 3 errors and a bake of fewer samples; a fast and an exact way of
 * each, and those that need no other bake. */
#define REPORT_BAKES_MAX 16
#define REPORT_TRIALS_MAX 64

struct report {
	const struct report_settings *settings;
	struct scene *scene;
	struct report_page page;
	struct report_stage stage;
	struct scope scope;
	int threads, truth_samples; /* for baking and tracing; of the truth */
	struct report_bake
		bake[REPORT_BAKES_MAX]; /* [0]: the setting in use; the last: few samples */
	int bakes;
	struct report_trial trial[REPORT_TRIALS_MAX]; /* [0]: the setting in use */
	int trials;
	double bake_noise, truth_noise; /* RMS over the surroundings, in levels */
	struct fault *fault;
};

/* Writes everything into the page. 0, or -errno with report->fault. */
int report_show(struct report *report);

/* "overcast", "sun", "lamps", NULL: from even light to light that comes from little of the sky. */
extern const char *const report_sky_names[];

/* Makes an equirectangular picture (hal/optics/panorama.h) of linear light, width x width / 2
 * pixels. -ENOMEM. */
int report_sky_make(struct image *image, int which, int width);

#endif
