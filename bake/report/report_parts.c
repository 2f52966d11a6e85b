/* SPDX-License-Identifier: MIT */
#include "bake/report/report_parts.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

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

/*
 * Noise that makes the errors of two trials equal, in levels. A file that is baked as advised has
 * the noise `hidden`, which hides smaller differences. The noise of truth and bake, one number a
 * pixel, leaves the square of an error over all pixels uncertain by
 *     u = 2 sqrt(truth^2 + bake^2) rms / sqrt(pixels)
 * and the noise that counts is sqrt(hidden^2 + 2 u), 2 u for both trials.
 */
static double trial_noise(const struct report *r, const struct report_trial *trial)
{
	const struct report_bake *bake = trial->way.bake;
	const double pixels = (double)(r->scope.objects + r->scope.shadows) * r->stage.lightings;
	const double samples = bake->settings.samples > 0 ? bake->settings.samples
							  : r->render.samples;
	const double own = r->bake_noise * sqrt(r->render.samples / samples);
	const double u = 2 * hypot(r->truth_noise, own) * trial->truth.all.rms / sqrt(pixels);

	return sqrt(r->hidden * r->hidden + 2 * u);
}

struct report_result report_result_of(const struct report *r, const struct report_trial *trial)
{
	return (struct report_result){
		.ms = trial->ms.median,
		.ms_low = trial->ms.low,
		.ms_high = trial->ms.high,
		.rms = trial->truth.all.rms,
		.noise = trial_noise(r, trial),
	};
}

void report_time_columns(struct report_table *t)
{
	report_table_column(t, "median_ms", "time", "ms");
	report_table_column(t, "low_ms", "1st quartile", "ms");
	report_table_column(t, "high_ms", "3rd", "ms");
}

void report_time_cells(struct report_table *t, const struct report_trial *trial)
{
	report_number(t, trial->ms.median);
	report_number(t, trial->ms.low);
	report_number(t, trial->ms.high);
}

void report_error_columns(struct report_table *t, const char *key, const char *against, bool brief)
{
	static const struct {
		const char *key, *heading, *unit;
		bool brief; /* shown also where the page is brief */
	} columns[] = {{"rms_levels", "RMS", NULL, true},
		       {"psnr_db", NULL, NULL, false},
		       {"max_levels", "largest", "levels", true},
		       {"contrast_percent", "shadow", "%", false}};

	for (size_t k = 0; k < sizeof(columns) / sizeof(*columns); k++) {
		char name[64];

		snprintf(name, sizeof(name), "%s_%s", key, columns[k].key);
		report_table_column(t, name, brief && !columns[k].brief ? NULL : columns[k].heading,
				    columns[k].unit ? columns[k].unit : against);
	}
}

void report_result_columns(const struct report *r, struct report_table *t)
{
	report_time_columns(t);
	report_table_column(t, "read_mb", "read", "MB");
	report_error_columns(t, "truth", "to truth", false);
	report_error_columns(t, "double", "to double", true);
	for (int l = 0; l < r->stage.lightings; l++) {
		char key[80];

		snprintf(key, sizeof(key), "truth_rms_levels:%.60s", r->stage.lighting[l].name);
		report_table_column(t, key, NULL, NULL);
		snprintf(key, sizeof(key), "double_rms_levels:%.60s", r->stage.lighting[l].name);
		report_table_column(t, key, NULL, NULL);
	}
}

void report_error_cells(struct report_table *t, const struct composite_error *error)
{
	report_number(t, error->rms);
	report_number(t, error->psnr_db);
	report_number(t, error->max);
	report_number(t, 100 * error->contrast);
}

void report_result_cells(const struct report *r, struct report_table *t,
			 const struct report_trial *trial)
{
	report_time_cells(t, trial);
	report_number(t, trial->read_mb);
	report_error_cells(t, &trial->truth.all);
	report_error_cells(t, &trial->precise.all);
	for (int l = 0; l < r->stage.lightings; l++) {
		report_number(t, trial->truth.each[l].rms);
		report_number(t, trial->precise.each[l].rms);
	}
}

struct report_point *report_time_point(struct report_plot *plot, double x,
				       const struct report_trial *trial)
{
	struct report_point *point = report_plot_point(plot, x, trial->ms.median);

	point->y_low = trial->ms.low;
	point->y_high = trial->ms.high;
	return point;
}

/* ---- settings to choose from ---- */

void report_candidate_add(struct report *r, const struct report_trial *trial, bool in_use)
{
	struct report_candidate *to = &r->candidate[r->candidates];

	if (r->candidates == REPORT_CANDIDATES_MAX)
		return;
	r->candidates++;
	*to = (struct report_candidate){
		.result = report_result_of(r, trial),
		.mb = trial->way.mode == COMPOSITOR_EXACT ? trial->way.bake->exact_mb
							  : trial->way.bake->shown_mb,
		.in_use = in_use,
	};
	snprintf(to->name, sizeof(to->name), "%s", trial->name);
}

/* Choices that a paragraph lists; it counts the others. */
#define LISTED 4

/* Lists the trials that count as equally near. Returns their number. */
static int list_equals(const struct report_trial *const *trials, const bool *near, int count,
		       char *list, size_t room)
{
	int equal = 0;

	*list = '\0';
	for (int k = 0; k < count; k++) {
		const size_t used = strlen(list);

		if (near[k] && equal++ < LISTED)
			snprintf(list + used, room - used, "%s%s", used ? "; " : "",
				 trials[k]->name);
	}
	if (equal > LISTED)
		snprintf(list + strlen(list), room - strlen(list), "; and %d more", equal - LISTED);
	return equal;
}

/* Says what an advice costs and brings, if it is another picture than that in use. */
static void compare_with_use(struct report *r, const struct report_trial *trial)
{
	const struct report_result of = report_result_of(r, trial);
	const struct report_result used = report_result_of(r, &r->in_use);

	if (of.rms == used.rms)
		return;
	report_paragraph(
		r->page.body,
		"Beside the setting in use: %.3g ms in place of %.3g, a basis of %.3g MB in place of %.3g, RMS %.3g in place of %.3g.",
		of.ms, used.ms, trial->way.bake->shown_mb, r->used->shown_mb, of.rms, used.rms);
}

int report_trial_choose(struct report *r, const struct report_trial *const *trials, int count,
			const char *order)
{
	struct report_result results[REPORT_CHOICES_MAX] = {{.ms = 0}};
	bool near[REPORT_CHOICES_MAX];
	char list[512];
	int found;

	count = count < REPORT_CHOICES_MAX ? count : REPORT_CHOICES_MAX;
	for (int k = 0; k < count; k++)
		results[k] = report_result_of(r, trials[k]);
	found = report_choose(results, count, near);
	if (list_equals(trials, near, count, list, sizeof(list)) > 1)
		report_paragraph(
			r->page.body,
			"Called equal, as their errors differ by no more than the noise "
			"(%.2g levels): %s. Advised: %s. No other of these is faster by more than the spread of the times; of those as fast, %s is preferred.",
			results[found].noise, list, trials[found]->name, order);
	else
		report_paragraph(
			r->page.body,
			"Advised: %s, nearer than all others by more than the noise (%.2g levels).",
			trials[found]->name, results[found].noise);
	compare_with_use(r, trials[found]);
	return found;
}

struct report_bake *report_advised_dome(struct report *r)
{
	for (int b = 0; b < r->bakes; b++)
		if (r->bake[b].settings.frequency == r->advised_frequency)
			return &r->bake[b];
	return r->used;
}

/* ---- lines to paste ---- */

static const struct {
	const char *kind, *name;
} files[REPORT_FILES] = {[REPORT_SCENE] = {"scene", "the scene file"},
			 [REPORT_KIOSK] = {"kiosk", "the kiosk's configuration"}};

void report_advise(struct report *r, enum report_file file, const char *section, const char *key,
		   const char *value, const char *used)
{
	struct report_advice *to = &r->advice[r->advices];

	if (r->advices == REPORT_ADVICE_MAX)
		return;
	r->advices++;
	*to = (struct report_advice){.file = file};
	snprintf(to->section, sizeof(to->section), "%s", section);
	snprintf(to->key, sizeof(to->key), "%s", key);
	snprintf(to->value, sizeof(to->value), "%s", value);
	if (used && strcmp(used, value) != 0)
		snprintf(to->used, sizeof(to->used), "%s", used);
}

void report_advise_number(struct report *r, enum report_file file, const char *section,
			  const char *key, double value, double used)
{
	char text[32], other[32];

	snprintf(text, sizeof(text), "%.4g", value);
	snprintf(other, sizeof(other), "%.4g", used);
	report_advise(r, file, section, key, text, other);
}

static void write_line(FILE *to, const struct report_advice *advice)
{
	fprintf(to, "%s = %s", advice->key, advice->value);
	fprintf(to, advice->used[0] ? "  ; in use: %s\n" : "\n", advice->used);
}

/* Writes lines of a file as text to copy: those of the same section under one heading. */
static void write_lines(FILE *to, const struct report_advice *advice, int count,
			enum report_file file)
{
	fprintf(to, "<pre class=\"%s\">", files[file].kind);
	for (int k = 0; k < count; k++) {
		bool first = true;

		for (int before = 0; before < k; before++)
			first &= advice[before].file != file ||
				 strcmp(advice[before].section, advice[k].section) != 0;
		if (advice[k].file != file || !first)
			continue;
		fprintf(to, "[%s]\n", advice[k].section);
		for (int n = k; n < count; n++)
			if (advice[n].file == file && !strcmp(advice[n].section, advice[k].section))
				write_line(to, &advice[n]);
	}
	fputs("</pre>\n", to);
}

void report_advice_show(struct report *r)
{
	const struct report_advice *first = &r->advice[r->advices_shown];

	if (r->advices_shown == r->advices)
		return;
	report_paragraph(r->page.body, "In %s:", files[first->file].name);
	write_lines(r->page.body, first, r->advices - r->advices_shown, first->file);
	r->advices_shown = r->advices;
}

void report_advice_gather(struct report *r, enum report_file file)
{
	for (int k = 0; k < r->advices; k++) {
		if (r->advice[k].file != file)
			continue;
		report_paragraph(r->page.head, "All that is advised for %s:", files[file].name);
		write_lines(r->page.head, r->advice, r->advices, file);
		return;
	}
}
