/* SPDX-License-Identifier: MIT */
#include "bake/report/report_parts.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "hal/base/log.h"

void report_step(struct report *r, const char *format, ...)
{
	char text[256];
	va_list list;

	r->step++;
	if (r->settings->quiet)
		return;
	va_start(list, format);
	vsnprintf(text, sizeof(text), format, list);
	va_end(list);
	log_info("step %d of %d: %s", r->step, r->steps, text);
}

/* ---- columns that every table of results has ---- */

const char *report_against(const struct report *r)
{
	return r->truth ? "path-traced truth" : "double precision";
}

double report_rms(const struct report *r, const struct report_trial *trial)
{
	return r->truth ? trial->truth.all.rms : trial->precise.all.rms;
}

void report_error_columns(struct report_table *t, const char *key, const char *against)
{
	static const struct {
		const char *key, *heading, *unit;
	} columns[] = {{"rms_levels", "RMS", NULL},
		       {"psnr_db", "PSNR", "dB"},
		       {"max_levels", "largest", "levels"},
		       {"contrast_percent", "shadow", "%"}};

	for (size_t k = 0; k < sizeof(columns) / sizeof(*columns); k++) {
		char name[64];

		snprintf(name, sizeof(name), "%s_%s", key, columns[k].key);
		report_table_column(t, name, columns[k].heading,
				    columns[k].unit ? columns[k].unit : against);
	}
}

void report_result_columns(const struct report *r, struct report_table *t)
{
	report_table_column(t, "median_ms", "time", "ms");
	report_table_column(t, "read_mb", "read", "MB");
	if (r->truth)
		report_error_columns(t, "truth", "to truth");
	report_error_columns(t, "double", "to double");
	for (int l = 0; l < r->stage.lightings; l++) {
		char key[80];

		if (r->truth) {
			snprintf(key, sizeof(key), "truth_rms_levels:%.60s",
				 r->stage.lighting[l].name);
			report_table_column(t, key, NULL, NULL);
		}
		snprintf(key, sizeof(key), "double_rms_levels:%.60s", r->stage.lighting[l].name);
		report_table_column(t, key, NULL, NULL);
	}
}

void report_error_cells(struct report_table *t, const struct composite_error *error)
{
	report_number(t, error ? error->rms : NAN);
	report_number(t, error ? error->psnr_db : NAN);
	report_number(t, error ? error->max : NAN);
	report_number(t, error ? 100 * error->contrast : NAN);
}

void report_result_cells(const struct report *r, struct report_table *t,
			 const struct report_trial *trial)
{
	const bool against_truth = !trial->way.thesis;

	report_number(t, trial->median_ms);
	report_number(t, trial->read_mb);
	if (r->truth)
		report_error_cells(t, against_truth ? &trial->truth.all : NULL);
	report_error_cells(t, &trial->precise.all);
	for (int l = 0; l < r->stage.lightings; l++) {
		if (r->truth)
			report_number(t, against_truth ? trial->truth.each[l].rms : NAN);
		report_number(t, trial->precise.each[l].rms);
	}
}

/* ---- settings to choose from ---- */

void report_candidate_add(struct report *r, const struct report_trial *trial, bool in_use)
{
	struct report_candidate *to = &r->candidate[r->candidates];

	if (r->candidates == REPORT_CANDIDATES_MAX)
		return;
	r->candidates++;
	*to = (struct report_candidate){
		.ms = trial->median_ms,
		.rms = report_rms(r, trial),
		.mb = trial->way.mode == COMPOSITOR_EXACT ? trial->way.bake->exact_mb
							  : trial->way.bake->shown_mb,
		.in_use = in_use,
	};
	snprintf(to->name, sizeof(to->name), "%s", trial->name);
}
