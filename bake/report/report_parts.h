/* SPDX-License-Identifier: MIT */
/* What the sections of a report share. Private to bake/report/. */
#ifndef INLAY_BAKE_REPORT_REPORT_PARTS_H
#define INLAY_BAKE_REPORT_REPORT_PARTS_H

#include "bake/base/report_page.h"
#include "bake/report/report.h"
#include "bake/report/report_rank.h"
#include "bake/report/report_trial.h"
#include "bake/scene/scene.h"

#define REPORT_SWEEP_MAX 12
#define REPORT_CANDIDATES_MAX 128
#define REPORT_CHOICES_MAX 64 /* of report_trial_choose() */
#define REPORT_ADVICE_MAX 16

/* A setting that could be used, and its results with one thread. */
struct report_candidate {
	char name[96];
	struct report_result result;
	double mb; /* of the basis */
	bool in_use;
};

/* The files that an advice is for. */
enum report_file { REPORT_SCENE, REPORT_KIOSK, REPORT_FILES };

/* A line to paste: "key = value" of a section. */
struct report_advice {
	enum report_file file;
	char section[24], key[24], value[32];
	char used[32]; /* what the scene says if that differs; empty: the same, or not known */
};

struct report {
	const struct report_settings *settings;
	struct scene *scene;
	struct report_page page;
	struct report_stage stage;
	struct scope scope;
	int threads;				   /* for baking and tracing */
	struct render_settings render;		   /* of the setting in use */
	struct report_bake bake[REPORT_SWEEP_MAX]; /* by number of lights */
	int bakes;
	struct report_bake *used;   /* the bake of the setting in use */
	struct report_trial in_use; /* the trial of the setting in use */
	/* A bake like `used` with fewer samples and other random numbers, and the noise that both
	 * tell (report_samples.c), in levels: of the setting in use in each surrounding, and as
	 * RMS over the surroundings of bake and truth. */
	struct report_bake fewer;
	double bake_noise_in[REPORT_LIGHTINGS_MAX];
	double bake_noise, truth_noise;
	double hidden; /* the bake's noise with the samples that are advised */
	struct report_candidate candidate[REPORT_CANDIDATES_MAX];
	int candidates;
	int advised_frequency; /* of the dome */
	struct report_advice advice[REPORT_ADVICE_MAX];
	int advices, advices_shown;
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
 * name the reference: "truth" in the CSV, "to truth" in the page. brief: the page shows RMS and
 * largest alone. */
void report_error_columns(struct report_table *table, const char *key, const char *against,
			  bool brief);
void report_error_cells(struct report_table *table, const struct composite_error *error);

/* Add the columns of time alone, with its quartiles; add their cells. */
void report_time_columns(struct report_table *table);
void report_time_cells(struct report_table *table, const struct report_trial *trial);

/* Adds a point at a trial's time, with a bar between its quartiles. */
struct report_point *report_time_point(struct report_plot *plot, double x,
				       const struct report_trial *trial);

/* A trial's time, and its error against truth. */
struct report_result report_result_of(const struct report *report,
				      const struct report_trial *trial);

/* Adds a trial to the settings that the summary compares. */
void report_candidate_add(struct report *report, const struct report_trial *trial, bool in_use);

/*
 * Chooses one of some trials (report_choose()), the preferred ones first, and writes paragraphs
 * that say why. Returns its index. order: which of those as fast is preferred.
 */
int report_trial_choose(struct report *report, const struct report_trial *const *trials, int count,
			const char *order);

/* The bake with the lights that are advised, as far as it is known: of the setting in use
 * before. */
struct report_bake *report_advised_dome(struct report *report);

/* Adds a line to paste. used NULL: not known. */
void report_advise(struct report *report, enum report_file file, const char *section,
		   const char *key, const char *value, const char *used);
void report_advise_number(struct report *report, enum report_file file, const char *section,
			  const char *key, double value, double used);
/* Writes the lines that have been added since the last call. */
void report_advice_show(struct report *report);
/* Writes all lines for a file into the summary, by section. */
void report_advice_gather(struct report *report, enum report_file file);

/* ---- sections ---- */

/* Makes the bake of fewer samples and sets the noise of bakes and truth in *report. */
int report_samples_measure(struct report *report);

/* The number of bakes that report_declared_error() makes. */
int report_error_bakes(void);

/* Write one section each, in the order of the page. 0, or -errno with report->fault. */
int report_lights(struct report *report);
int report_samples(struct report *report);
int report_threshold(struct report *report);
int report_declared_error(struct report *report);
int report_column_cut(struct report *report);
int report_pictures(struct report *report);

/* Writes the summary. It stands first in the page, but needs the results of all sections. */
int report_summary(struct report *report);

#endif
