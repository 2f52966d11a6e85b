/* SPDX-License-Identifier: MIT */
/* A report while it is made. Private to bake/report/. */
#ifndef INLAY_BAKE_REPORT_REPORT_PARTS_H
#define INLAY_BAKE_REPORT_REPORT_PARTS_H

#include "bake/base/report_page.h"
#include "bake/report/report.h"
#include "bake/report/report_plot.h"
#include "bake/report/report_trial.h"
#include "bake/scene/scene.h"

/* The setting in use, 8 domes, 3 errors and a bake of fewer samples; a fast and an exact way of
 * each, and those that need no other bake. */
#define REPORT_BAKES_MAX 16
#define REPORT_TRIALS_MAX REPORT_POINTS_MAX

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

#endif
