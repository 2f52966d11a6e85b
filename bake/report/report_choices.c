/* SPDX-License-Identifier: MIT */
/* Choices that need no other bake: the threshold and the column cut. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/report/report_parts.h"

#define TRIALS_MAX 64

/* A sweep: trials that differ in one choice, and their table, whose first columns say in what. */
struct sweep {
	struct report *report;
	struct report_trial trial[TRIALS_MAX];
	int count;
	struct report_table table;
};

static void sweep_begin(struct sweep *s, struct report *r, const char *name)
{
	s->report = r;
	s->count = 0;
	report_table_begin(&s->table, name);
}

/* Adds a trial of the setting in use. The caller changes the returned way. */
static struct report_way *sweep_add(struct sweep *s, const char *name)
{
	struct report_trial *trial = &s->trial[s->count++];

	memset(trial, 0, sizeof(*trial));
	trial->way = report_way_plain(s->report->used);
	snprintf(trial->name, sizeof(trial->name), "%s", name);
	return &trial->way;
}

static int sweep_run(struct sweep *s)
{
	return report_trials_run(s->trial, s->count, &s->report->stage, &s->report->scope,
				 s->report->fault);
}

static int sweep_end(struct sweep *s, int err)
{
	struct report *r = s->report;

	if (!err)
		err = report_page_table(&r->page, r->page.body, &s->table, r->fault);
	report_table_free(&s->table);
	return err;
}

/* Chooses one of the trials, of which the preferred ones come first (report_trial_choose()).
 * Returns its index. */
static int sweep_choose(struct sweep *s, const char *order)
{
	const struct report_trial *trial[TRIALS_MAX];

	for (int k = 0; k < s->count; k++)
		trial[k] = &s->trial[k];
	return report_trial_choose(s->report, trial, s->count, order);
}

static double used_share(const struct report *r, const struct report_trial *trial)
{
	double sum = 0;

	for (int l = 0; l < r->stage.lightings; l++)
		sum += trial->lights[l] / r->stage.lightings;
	return 100 * sum / trial->way.bake->basis.info.lights;
}

/* ---- threshold ---- */

static const double levels[] = {0, 4, 16, 48, 96, 128, 160, 192, 208, 224, 240};

#define LEVELS ((int)(sizeof(levels) / sizeof(*levels)))

static int plot_threshold(struct sweep *s)
{
	static const char *const names[] = {"given back as ambient", "dropped"};
	struct report *r = s->report;
	struct report_plot plot;

	report_plot_begin(&plot, "threshold-error", "lights used, % (mean over the surroundings)",
			  "RMS error against double precision, levels");
	plot.y_log = true;
	for (int mode = 0; mode < THRESHOLD_MODE_COUNT; mode++) {
		report_plot_series(&plot, names[mode], STYLE_LINE, mode + 1);
		for (int k = LEVELS - 1; k >= 0; k--) {
			const struct report_trial *trial = &s->trial[mode * LEVELS + k];
			struct report_point *point = report_plot_point(&plot, used_share(r, trial),
								       trial->precise.all.rms);

			if (mode == THRESHOLD_DROP && point->x < 99)
				snprintf(point->label, sizeof(point->label), "%.0f", levels[k]);
			point->ringed = k == 0 && mode == THRESHOLD_AMBIENT;
		}
	}
	return report_page_plot(
		&r->page, r->page.body, &plot,
		"Error by share of lights that reach the threshold (its grey level beside each point). Ring: the setting in use, no threshold.",
		r->fault);
}

/* Advises a threshold, but none that drops light: what that darkens depends on the surroundings. */
static void choose_threshold(struct sweep *s)
{
	struct report *r = s->report;
	const struct report_trial *trial[TRIALS_MAX];
	char level[32];
	int index[TRIALS_MAX] = {0}, count = 0, found;

	for (int k = 0; k < s->count; k++) {
		if (k && (used_share(r, &s->trial[k]) >= 99.9 ||
			  s->trial[k].way.threshold_mode == THRESHOLD_DROP))
			continue;
		trial[count] = &s->trial[k];
		index[count++] = k;
	}
	found = index[report_trial_choose(r, trial, count, "none")];
	snprintf(level, sizeof(level), "%.0f", levels[found % LEVELS]);
	report_advise(r, REPORT_KIOSK, "lights", "threshold", level, NULL);
	report_advise(r, REPORT_KIOSK, "lights", "threshold_mode",
		      threshold_mode_names[found / LEVELS], NULL);
	report_advice_show(r);
}

int report_threshold(struct report *r)
{
	static struct sweep s;
	int err;

	sweep_begin(&s, r, "threshold");
	for (int mode = 0; mode < THRESHOLD_MODE_COUNT; mode++) {
		for (int k = 0; k < LEVELS; k++) {
			char name[96];
			struct report_way *way;

			snprintf(name, sizeof(name), "%u lights, threshold %.0f, %s",
				 r->used->basis.info.lights, levels[k], threshold_mode_names[mode]);
			way = sweep_add(&s, name);
			way->threshold = transfer_decode(TRANSFER_SRGB, levels[k] / 255);
			way->threshold_mode = (enum threshold_mode)mode;
		}
	}
	err = sweep_run(&s);
	report_table_column(&s.table, "mode", "mode", NULL);
	report_table_column(&s.table, "threshold_level", "threshold", "grey level");
	report_table_column(&s.table, "lights_used_percent", "lights", "% used");
	report_result_columns(r, &s.table);
	for (int k = 0; k < s.count; k++) {
		report_text(&s.table, "%s", threshold_mode_names[k / LEVELS]);
		report_number(&s.table, levels[k % LEVELS]);
		report_number(&s.table, used_share(r, &s.trial[k]));
		report_result_cells(r, &s.table, &s.trial[k]);
		if (!k)
			report_table_mark(&s.table);
		else if (!err && used_share(r, &s.trial[k]) < 99.9)
			report_candidate_add(r, &s.trial[k], false);
	}
	report_heading(r->page.body, "What does the threshold bring?");
	report_paragraph(
		r->page.body,
		"A light none of whose channels reaches the threshold is left out. "
		"\"drop\" is the thesis's way; \"ambient\" gives what was left out back as "
		"even light. Errors are against double precision with every light; white ground has radiance %.2g, 1 is grey level 255 of sRGB.",
		REPORT_WHITE);
	if (!err)
		err = plot_threshold(&s);
	err = sweep_end(&s, err);
	if (!err)
		choose_threshold(&s);
	return err;
}

/* ---- column cut ---- */

#define LEAST_CUT 1e-3 /* multiples of it are tried where nothing is cut */
#define MOST_CUT 0.1   /* that a scene file may ask for */

static double cut_times(double own, double factor)
{
	return fmin((own > 0 ? own : LEAST_CUT) * factor, MOST_CUT);
}

/* Advises a multiple of the cut that is in use. The program's own cut falls with the root of the
 * number of lights, so it is a multiple of the advised dome's. */
static void advise_cut(struct report *r, double factor)
{
	const double own = report_advised_dome(r)->basis.info.column_cut;
	const double used = r->render.column_cut;
	const double cut = factor == 1 ? used : cut_times(own, factor);
	char text[32], in_use[32];

	if (r->advised_frequency != r->render.frequency && factor != 1)
		report_paragraph(
			r->page.body,
			"That is %.3g times the cut in use; the line is for the lights that are advised, whose own cut is %.2g.",
			factor, own);
	snprintf(text, sizeof(text), "%.2g", cut);
	snprintf(in_use, sizeof(in_use), "%.2g", used);
	report_advise(r, REPORT_SCENE, "render", "column_cut", text, in_use);
	report_advice_show(r);
}

int report_column_cut(struct report *r)
{
	/* the file's own first: it is preferred to others that are as near and as fast */
	static const double factors[] = {1, 0, 0.25, 0.5, 2, 4, 8, 16};
	static struct sweep s;
	struct report_plot plot;
	const double own = r->used->basis.info.column_cut;
	int err;

	sweep_begin(&s, r, "column-cut");
	for (size_t k = 0; k < sizeof(factors) / sizeof(*factors); k++) {
		const double cut = k ? cut_times(own, factors[k]) : own;
		char name[96];

		snprintf(name, sizeof(name), "%u lights, cut %.2g", r->used->basis.info.lights,
			 cut);
		sweep_add(&s, name)->column_cut = cut;
	}
	err = sweep_run(&s);
	report_table_column(&s.table, "column_cut", "cut", "of white");
	report_result_columns(r, &s.table);
	report_plot_begin(&plot, "column-cut", "RMS error against double precision, levels",
			  "time of a frame, ms");
	report_plot_series(&plot, NULL, STYLE_POINTS, 1);
	for (int k = 0; k < s.count; k++) {
		const double cut = s.trial[k].way.column_cut;
		struct report_point *point = report_time_point(&plot, s.trial[k].precise.all.rms,
							       &s.trial[k]);

		snprintf(point->label, sizeof(point->label), "%.2g", cut);
		point->ringed = !k;
		report_number(&s.table, cut);
		report_result_cells(r, &s.table, &s.trial[k]);
		if (!k)
			report_table_mark(&s.table);
		else if (!err)
			report_candidate_add(r, &s.trial[k], false);
	}
	report_heading(r->page.body, "What does leaving out small columns bring?");
	report_paragraph(
		r->page.body,
		"A column of a single light that changes no pixel by more than its block's share of the cut, as linear light or in the shadow's ratio, is left out of that frame.");
	if (err)
		report_plot_free(&plot);
	else
		err = report_page_plot(
			&r->page, r->page.body, &plot,
			"Time against error, the cut beside each point, and the time's quartiles. Ring: the file's own.",
			r->fault);
	err = sweep_end(&s, err);
	if (!err)
		advise_cut(r, factors[sweep_choose(&s, "the file's own")]);
	return err;
}
