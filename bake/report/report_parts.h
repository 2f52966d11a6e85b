/* SPDX-License-Identifier: MIT */
/* What the sections of a report share. Private to bake/report*.c. */
#ifndef INLAY_BAKE_REPORT_REPORT_PARTS_H
#define INLAY_BAKE_REPORT_REPORT_PARTS_H

#include "bake/base/report_page.h"
#include "bake/report/report.h"
#include "bake/report/report_trial.h"
#include "bake/scene/scene.h"

#define REPORT_SWEEP_MAX 12
#define REPORT_CANDIDATES_MAX 128

/* A setting that could be used, by one thread. */
struct report_candidate {
	char name[96];
	double ms, rms; /* a frame; against truth (against double precision without one) */
	double mb;	/* of the basis */
	bool in_use;
	bool front; /* no other is both faster and nearer */
};

struct report {
	const struct report_settings *settings;
	struct scene *scene; /* NULL: of a basis file alone */
	struct report_page page;
	struct report_stage stage;
	struct scope scope;
	int threads;				   /* that are tried at most */
	bool truth;				   /* the stage has one */
	struct render_settings render;		   /* of the setting in use */
	struct report_bake bake[REPORT_SWEEP_MAX]; /* by number of lights */
	int bakes;
	struct report_bake *used;   /* one of them */
	struct report_trial in_use; /* as it came out */
	struct report_bake given;   /* the file in use, if there is one */
	struct report_candidate candidate[REPORT_CANDIDATES_MAX];
	int candidates;
	int step, steps;
	struct fault *fault;
};

/* Says how far the report has come. */
void report_step(struct report *report, const char *format, ...)
	__attribute__((format(printf, 2, 3)));

/* The columns of time, memory and errors, and a trial's cells of them. */
void report_result_columns(const struct report *report, struct report_table *table);
void report_result_cells(const struct report *report, struct report_table *table,
			 const struct report_trial *trial);

/* RMS, PSNR, the largest and the shadow's, against what: "truth" in the CSV, "to truth" in the
 * page. error NULL: does not apply. */
void report_error_columns(struct report_table *table, const char *key, const char *against);
void report_error_cells(struct report_table *table, const struct composite_error *error);

/* What a setting's picture is off by: against truth, else against double precision. */
double report_rms(const struct report *report, const struct report_trial *trial);
const char *report_against(const struct report *report);

/* For the plot of all settings. */
void report_candidate_add(struct report *report, const struct report_trial *trial, bool in_use);

#endif
