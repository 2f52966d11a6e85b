/* SPDX-License-Identifier: MIT */
/* The summary: the setting in use, what it costs, how accurate it is, and which settings are
 * better. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/report/report_parts.h"
#include "bake/report/report_sections.h"

/* Errors closer to each other than this factor count as equal. */
#define WORTH 1.01
/* Times closer to each other than this factor cannot be told apart. */
#define SAME_TIME 1.05

static int faster_first(const void *a, const void *b)
{
	const struct report_candidate *x = a, *y = b;

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

/* Whether c is another setting that is neither faster nor more accurate than the one in use, by
 * more than chance may make it. */
static bool is_like_used(const struct report_candidate *used, const struct report_candidate *c)
{
	return used && c != used && used->ms <= c->ms * SAME_TIME && used->rms <= c->rms * WORTH;
}

static void find_front(struct report *r)
{
	const struct report_candidate *used;
	double best = INFINITY;

	qsort(r->candidate, (size_t)r->candidates, sizeof(*r->candidate), faster_first);
	used = candidate_in_use(r);
	for (int k = 0; k < r->candidates; k++) {
		struct report_candidate *c = &r->candidate[k];

		c->front = !is_like_used(used, c) && c->rms * WORTH < best;
		if (c->front)
			best = c->rms;
	}
}

/* The most accurate of the other settings that take at most ms and are off by at most rms, or
 * NULL. */
static const struct report_candidate *candidate_better(const struct report *r, double ms,
						       double rms)
{
	const struct report_candidate *found = NULL;

	for (int k = 0; k < r->candidates; k++) {
		const struct report_candidate *c = &r->candidate[k];

		if (!c->in_use && c->ms <= ms && c->rms <= rms && (!found || c->rms < found->rms))
			found = c;
	}
	return found;
}

static void suggest_candidate(FILE *to, const char *what, const struct report_candidate *c)
{
	char ms[32], rms[32], mb[32];

	if (!c)
		return;
	report_rounded(c->ms, ms, sizeof(ms));
	report_rounded(c->rms, rms, sizeof(rms));
	report_rounded(c->mb, mb, sizeof(mb));
	report_paragraph(to, "%s: %s (%s ms, RMS %s, basis %s MB).", what, c->name, ms, rms, mb);
}

static int show_front(struct report *r)
{
	struct report_plot plot;

	report_plot_begin(&plot, "pareto", "time of a frame, ms, one thread", "");
	snprintf(plot.y_label, sizeof(plot.y_label), "RMS error against %s, levels",
		 report_against(r));
	plot.x_log = plot.y_log = true;
	report_plot_series(&plot, NULL, STYLE_POINTS, 0);
	for (int k = 0; k < r->candidates; k++)
		if (!r->candidate[k].front)
			report_plot_point(&plot, r->candidate[k].ms, r->candidate[k].rms);
	report_plot_series(&plot, NULL, STYLE_STEPS, 1);
	for (int k = 0; k < r->candidates; k++) {
		const struct report_candidate *c = &r->candidate[k];
		struct report_point *point;

		if (!c->front)
			continue;
		point = report_plot_point(&plot, c->ms, c->rms);
		snprintf(point->label, sizeof(point->label), "%.40s", c->name);
	}
	report_plot_series(&plot, NULL, STYLE_POINTS, 2);
	if (candidate_in_use(r)) {
		struct report_point *point = report_plot_point(&plot, candidate_in_use(r)->ms,
							       candidate_in_use(r)->rms);

		point->ringed = true;
		snprintf(point->label, sizeof(point->label), "in use");
	}
	return report_page_plot(&r->page, r->page.head, &plot,
				"Every setting that was tried. Blue: the Pareto front, that is, no "
				"other is as fast and nearer by 1 % or more (5 % of time is "
				"chance). Ring: the setting in use.",
				r->fault);
}

static int show_candidates(struct report *r)
{
	struct report_table table;
	int err;

	report_table_begin(&table, "settings");
	report_table_column(&table, "setting", "setting", NULL);
	report_table_column(&table, "median_ms", "time", "ms");
	report_table_column(&table, "rms_levels", "RMS", "levels");
	report_table_column(&table, "basis_mb", "basis", "MB");
	report_table_column(&table, "front", "Pareto front", NULL);
	report_table_column(&table, "in_use", "in use", NULL);
	for (int k = 0; k < r->candidates; k++) {
		const struct report_candidate *c = &r->candidate[k];

		report_text(&table, "%s", c->name);
		report_number(&table, c->ms);
		report_number(&table, c->rms);
		report_number(&table, c->mb);
		report_text(&table, "%s", c->front ? "yes" : "");
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
	char ms[32], rms[32], mb[32], exact[32];

	report_rounded(used->ms, ms, sizeof(ms));
	report_rounded(used->rms, rms, sizeof(rms));
	report_rounded(bake->shown_mb, mb, sizeof(mb));
	report_rounded(bake->exact_mb, exact, sizeof(exact));
	report_paragraph(
		r->page.head,
		"In use: %u lights (frequency %u) read as means over their cells, no "
		"threshold, fast mode, columns cut at %.2g, one thread. It declares an RMS "
		"error of %.2g levels under skies and %.2g under single cells.",
		info->lights, info->dome_frequency, info->column_cut, info->sky_rms,
		info->cell_rms);
	report_paragraph(
		r->page.head,
		"It costs %s ms a frame of %u x %u pixels and %s MB of memory%s%s%s, and is "
		"off from %s by an RMS of %s levels over what the object changes, all "
		"surroundings taken together.",
		ms, info->width, info->height, mb, bake->exact ? " (the exact layer " : "",
		bake->exact ? exact : "", bake->exact ? " MB)" : "", report_against(r), rms);
}

static int show_surroundings(struct report *r)
{
	struct report_table t;
	int err;

	report_paragraph(r->page.head, "The setting in use, in each surrounding:");
	report_table_begin(&t, "surroundings");
	report_table_column(&t, "surrounding", "surrounding", NULL);
	report_table_column(&t, "sky_peak_over_mean", "brightest / mean", "of the sky");
	if (r->truth) {
		report_error_columns(&t, "truth", "to truth");
		report_table_column(&t, "truth_noise_levels", "noise of it", "levels");
		report_table_column(&t, "truth_s", NULL, NULL);
	}
	report_error_columns(&t, "double", "to double");
	for (int l = 0; l < r->stage.lightings; l++) {
		const struct report_lighting *lighting = &r->stage.lighting[l];

		report_text(&t, "%s", lighting->name);
		report_number(&t, lighting->peak_ratio);
		if (r->truth) {
			report_error_cells(&t, &r->in_use.truth.each[l]);
			report_number(&t, lighting->noise_levels);
			report_number(&t, lighting->seconds);
		}
		report_error_cells(&t, &r->in_use.precise.each[l]);
	}
	err = report_page_table(&r->page, r->page.head, &t, r->fault);
	report_table_free(&t);
	return err;
}

int report_summary(struct report *r)
{
	const struct report_candidate *used;
	int err;

	find_front(r);
	used = candidate_in_use(r);
	if (used) {
		const struct report_candidate *nearer = candidate_better(r, used->ms,
									 used->rms / WORTH);
		const struct report_candidate *faster = candidate_better(r, used->ms / SAME_TIME,
									 used->rms * WORTH);

		describe_use(r, used);
		suggest_candidate(r->page.head, "Nearer in no more time", nearer);
		suggest_candidate(r->page.head, "Faster and no further off", faster);
		suggest_candidate(r->page.head, "The nearest of all",
				  candidate_better(r, INFINITY, INFINITY));
		if (!nearer && !faster)
			report_paragraph(
				r->page.head,
				"No other setting that was tried is nearer in no more time, "
				"or faster and no further off.");
	}
	err = show_surroundings(r);
	if (!err)
		err = show_front(r);
	return err ? err : show_candidates(r);
}
