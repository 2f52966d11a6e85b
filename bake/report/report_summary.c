/* SPDX-License-Identifier: MIT */
/* The summary: the setting in use, what it costs, how accurate it is, and which settings are
 * better. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/report/report_parts.h"

static int faster_first(const void *a, const void *b)
{
	const struct report_result *x = &((const struct report_candidate *)a)->result;
	const struct report_result *y = &((const struct report_candidate *)b)->result;

	return x->ms != y->ms ? (x->ms > y->ms) - (x->ms < y->ms)
			      : (x->rms > y->rms) - (x->rms < y->rms);
}

static const struct report_candidate *candidate_in_use(const struct report *r)
{
	for (int k = 0; k < r->candidates; k++)
		if (r->candidate[k].in_use)
			return &r->candidate[k];
	return NULL;
}

/* Sorts the candidates and finds those on the Pareto front. */
static void find_front(struct report *r, bool *front)
{
	struct report_result result[REPORT_CANDIDATES_MAX];

	qsort(r->candidate, (size_t)r->candidates, sizeof(*r->candidate), faster_first);
	for (int k = 0; k < r->candidates; k++)
		result[k] = r->candidate[k].result;
	for (int k = 0; k < r->candidates; k++)
		front[k] = report_is_front(result, r->candidates, k);
}

static int show_front(struct report *r, const bool *front)
{
	const struct report_candidate *used = candidate_in_use(r);
	struct report_plot plot;

	report_plot_begin(&plot, "pareto", "time of a frame, ms, one thread",
			  "RMS error against path-traced truth, levels");
	plot.x_log = plot.y_log = true;
	report_plot_series(&plot, NULL, STYLE_POINTS, 0);
	for (int k = 0; k < r->candidates; k++)
		if (!front[k])
			report_plot_point(&plot, r->candidate[k].result.ms,
					  r->candidate[k].result.rms);
	report_plot_series(&plot, NULL, STYLE_POINTS, 1);
	for (int k = 0; k < r->candidates; k++) {
		const struct report_candidate *c = &r->candidate[k];
		struct report_point *point;

		if (!front[k])
			continue;
		point = report_plot_point(&plot, c->result.ms, c->result.rms);
		snprintf(point->label, sizeof(point->label), "%.40s", c->name);
	}
	report_plot_series(&plot, NULL, STYLE_POINTS, 2);
	if (used) {
		struct report_point *point = report_plot_point(&plot, used->result.ms,
							       used->result.rms);

		point->ringed = true;
		snprintf(point->label, sizeof(point->label), "in use");
	}
	return report_page_plot(
		&r->page, r->page.head, &plot,
		"Every setting that was tried. Blue: the Pareto front, that is, no "
		"other is faster and as near, or nearer and as fast; as fast and as near is what noise and spread cannot tell apart. Ring: the setting in use.",
		r->fault);
}

static int show_candidates(struct report *r, const bool *front)
{
	struct report_table table;
	int err;

	report_table_begin(&table, "settings");
	report_table_column(&table, "setting", "setting", NULL);
	report_time_columns(&table);
	report_table_column(&table, "rms_levels", "RMS", "levels");
	report_table_column(&table, "noise_levels", "noise of it", "levels");
	report_table_column(&table, "basis_mb", "basis", "MB");
	report_table_column(&table, "front", "Pareto front", NULL);
	report_table_column(&table, "in_use", "in use", NULL);
	for (int k = 0; k < r->candidates; k++) {
		const struct report_candidate *c = &r->candidate[k];

		report_text(&table, "%s", c->name);
		report_number(&table, c->result.ms);
		report_number(&table, c->result.ms_low);
		report_number(&table, c->result.ms_high);
		report_number(&table, c->result.rms);
		report_number(&table, c->result.noise);
		report_number(&table, c->mb);
		report_text(&table, "%s", front[k] ? "yes" : "");
		report_text(&table, "%s", c->in_use ? "yes" : "");
		if (c->in_use)
			report_table_mark(&table);
	}
	fputs("<details><summary>All settings, the fastest first</summary>\n", r->page.head);
	err = report_page_table(&r->page, r->page.head, &table, r->fault);
	fputs("</details>\n", r->page.head);
	report_table_free(&table);
	return err;
}

static void describe_use(struct report *r, const struct report_candidate *used)
{
	const struct report_bake *bake = r->used;
	const struct basis_info_chunk *info = &bake->basis.info;
	char ms[32], low[32], high[32], rms[32], mb[32], exact[32];

	report_rounded(used->result.ms, ms, sizeof(ms));
	report_rounded(used->result.ms_low, low, sizeof(low));
	report_rounded(used->result.ms_high, high, sizeof(high));
	report_rounded(used->result.rms, rms, sizeof(rms));
	report_rounded(bake->shown_mb, mb, sizeof(mb));
	report_rounded(bake->exact_mb, exact, sizeof(exact));
	report_paragraph(
		r->page.head,
		"In use: %u lights (frequency %u) read as means over their cells, no "
		"threshold, fast mode, columns cut at %.2g, one thread. It declares an RMS error of %.2g levels under skies and %.2g under single cells.",
		info->lights, info->dome_frequency, info->column_cut, info->sky_rms,
		info->cell_rms);
	report_paragraph(
		r->page.head,
		"It costs %s ms (quartiles %s to %s) a frame of %u x %u pixels, %.0f ns for each "
		"pixel that the object changes, and %s MB of memory%s%s%s. It is off from "
		"path-traced truth by an RMS of %s levels over what the object changes, all surroundings taken together.",
		ms, low, high, info->width, info->height,
		1e6 * used->result.ms / (double)(r->scope.objects + r->scope.shadows), mb,
		bake->exact ? " (the exact layer " : "", bake->exact ? exact : "",
		bake->exact ? " MB)" : "", rms);
}

static int show_surroundings(struct report *r)
{
	struct report_table t;
	int err;

	report_paragraph(r->page.head, "The setting in use, in each surrounding:");
	report_table_begin(&t, "surroundings");
	report_table_column(&t, "surrounding", "surrounding", NULL);
	report_table_column(&t, "sky_peak_over_mean", "brightest / mean", "of the sky");
	report_error_columns(&t, "truth", "to truth", false);
	report_table_column(&t, "truth_noise_levels", "noise", "of truth");
	report_table_column(&t, "bake_noise_levels", "noise", "of the bake");
	report_table_column(&t, "truth_s", NULL, NULL);
	report_error_columns(&t, "double", "to double", true);
	for (int l = 0; l < r->stage.lightings; l++) {
		const struct report_lighting *lighting = &r->stage.lighting[l];

		report_text(&t, "%s", lighting->name);
		report_number(&t, lighting->peak_ratio);
		report_error_cells(&t, &r->in_use.truth.each[l]);
		report_number(&t, lighting->noise_levels);
		report_number(&t, r->bake_noise_in[l]);
		report_number(&t, lighting->seconds);
		report_error_cells(&t, &r->in_use.precise.each[l]);
	}
	err = report_page_table(&r->page, r->page.head, &t, r->fault);
	report_table_free(&t);
	return err;
}

int report_summary(struct report *r)
{
	const struct report_candidate *used;
	bool front[REPORT_CANDIDATES_MAX];
	int err;

	find_front(r, front);
	used = candidate_in_use(r);
	if (used)
		describe_use(r, used);
	for (int file = 0; file < REPORT_FILES; file++)
		report_advice_gather(r, (enum report_file)file);
	err = show_surroundings(r);
	if (!err)
		err = show_front(r, front);
	return err ? err : show_candidates(r, front);
}
