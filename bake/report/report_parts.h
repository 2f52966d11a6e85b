/* SPDX-License-Identifier: MIT */
/* What the sections of a report share. Private to bake/report/. */
#ifndef INLAY_BAKE_REPORT_REPORT_PARTS_H
#define INLAY_BAKE_REPORT_REPORT_PARTS_H

#include "bake/base/report_page.h"
#include "bake/report/report.h"
#include "bake/report/report_trial.h"
#include "bake/scene/scene.h"

#define REPORT_SWEEP_MAX 12
#define REPORT_CANDIDATES_MAX 128

/* A setting that could be used, and its results with one thread. */
struct report_candidate {
	char name[96];
	double ms, rms; /* of a frame; against truth, or double precision where there is no truth */
	double mb;	/* of the basis */
	bool in_use;
	bool front; /* on the Pareto front: no other is both faster and more accurate */
};

struct report {
	const struct report_settings *settings;
	struct scene *scene; /* NULL: the report is of a basis file alone */
	struct report_page page;
	struct report_stage stage;
	struct scope scope;
	int threads;				   /* the most that are tried */
	bool truth;				   /* whether there is path-traced truth */
	struct render_settings render;		   /* of the setting in use */
	struct report_bake bake[REPORT_SWEEP_MAX]; /* by number of lights */
	int bakes;
	struct report_bake *used;   /* the bake of the setting in use */
	struct report_trial in_use; /* the trial of the setting in use */
	struct report_bake given;   /* the file in use, if there is one */
	struct report_candidate candidate[REPORT_CANDIDATES_MAX];
	int candidates;
	int step, steps;
	struct fault *fault;
};

/* Logs the number and the name of the step that begins, unless the report is quiet. */
void report_step(struct report *report, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* Add the columns of time, memory and errors to a table; add the cells of a trial in these
 * columns. */
void report_result_columns(const struct report *report, struct report_table *table);
void report_result_cells(const struct report *report, struct report_table *table,
			 const struct report_trial *trial);

/* Add the columns of RMS, PSNR, largest error and shadow's error; add their cells. key and against
 * name the reference: "truth" in the CSV, "to truth" in the page. error NULL: it does not apply. */
void report_error_columns(struct report_table *table, const char *key, const char *against);
void report_error_cells(struct report_table *table, const struct composite_error *error);

/* A trial's RMS error against truth, or double precision where there is no truth; the reference's
 * name. */
double report_rms(const struct report *report, const struct report_trial *trial);
const char *report_against(const struct report *report);

/* Adds a trial to the settings that the summary compares. */
void report_candidate_add(struct report *report, const struct report_trial *trial, bool in_use);

#endif
