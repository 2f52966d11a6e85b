/* SPDX-License-Identifier: MIT */
/* Section: how many lights. */
#include <stdio.h>

#include "bake/report/report_parts.h"

enum { FAST, EXACT, WAYS };

static void describe_way(struct report_trial *trial, struct report_bake *bake, int which)
{
	static const char *const names[WAYS] = {"", ", exact layer"};

	trial->way = report_way_plain(bake);
	trial->way.mode = which == EXACT && bake->exact ? COMPOSITOR_EXACT : COMPOSITOR_FAST;
	snprintf(trial->name, sizeof(trial->name), "%u lights%s", bake->basis.info.lights,
		 names[which]);
}

static void fill_lights_table(const struct report *r, const struct report_trial *trials,
			      struct report_table *t)
{
	static const char *const modes[WAYS] = {"fast", "exact"};

	report_table_column(t, "lights", "lights", NULL);
	report_table_column(t, "frequency", "f", NULL);
	report_table_column(t, "way", "way", NULL);
	report_table_column(t, "basis_mb", "basis", "MB");
	report_table_column(t, "bake_s", "bake", "processor s");
	report_table_column(t, "bake_noise_levels", NULL, NULL);
	report_result_columns(r, t);
	for (int b = 0; b < r->bakes; b++) {
		const struct report_bake *bake = &r->bake[b];

		for (int k = 0; k < WAYS; k++) {
			const struct report_trial *trial = &trials[WAYS * b + k];

			report_number(t, bake->basis.info.lights);
			report_number(t, bake->settings.frequency);
			report_text(t, "%s", modes[k]);
			report_number(t, k == EXACT ? bake->exact_mb : bake->shown_mb);
			report_number(t, report_bake_seconds(bake));
			report_number(t, bake->report.info.noise_levels);
			report_result_cells(r, t, trial);
			if (bake == r->used && k == FAST)
				report_table_mark(t);
		}
	}
}

static void light_ticks(const struct report *r, struct report_plot *plot)
{
	for (int b = 0; b < r->bakes; b++)
		plot->x_tick[plot->x_ticks++] = r->bake[b].basis.info.lights;
}

static int plot_errors(struct report *r, const struct report_trial *trials)
{
	struct report_plot plot;

	report_plot_begin(&plot, "lights-error", "number of lights",
			  "RMS error against truth, 8-bit levels");
	plot.x_log = plot.y_log = true;
	light_ticks(r, &plot);
	for (int l = 0; l < r->stage.lightings; l++) {
		report_plot_series(&plot, r->stage.lighting[l].name, STYLE_LINE, l + 1);
		for (int b = 0; b < r->bakes; b++)
			report_plot_point(&plot, r->bake[b].basis.info.lights,
					  trials[WAYS * b + FAST].truth.each[l].rms)
				->ringed = &r->bake[b] == r->used;
	}
	return report_page_plot(
		&r->page, r->page.body, &plot,
		"Error of the finished picture by number of lights. Rings: the setting in use.",
		r->fault);
}

static int plot_times(struct report *r, const struct report_trial *trials)
{
	static const struct {
		int way, colour;
		const char *name;
	} lines[] = {{EXACT, 3, "exact"}, {FAST, 1, "fast"}};
	struct report_plot plot;

	report_plot_begin(&plot, "lights-time", "number of lights", "time of a frame, ms");
	plot.x_log = plot.y_log = true;
	light_ticks(r, &plot);
	for (size_t k = 0; k < sizeof(lines) / sizeof(*lines); k++) {
		report_plot_series(&plot, lines[k].name, STYLE_LINE, lines[k].colour);
		for (int b = 0; b < r->bakes; b++) {
			const int at = WAYS * b + lines[k].way;

			report_time_point(&plot, r->bake[b].basis.info.lights, &trials[at])
				->ringed = &r->bake[b] == r->used && lines[k].way == FAST;
		}
	}
	return report_page_plot(
		&r->page, r->page.body, &plot,
		"Time of a frame by number of lights, one thread, with its quartiles. Ring: the setting in use.",
		r->fault);
}

static int show_lights(struct report *r, const struct report_trial *trials)
{
	struct report_table table;
	int err;

	report_heading(r->page.body, "How many lights?");
	report_paragraph(r->page.body,
			 "Each number of lights is a bake of its own. Times are of one thread.");
	err = plot_errors(r, trials);
	if (!err)
		err = plot_times(r, trials);
	report_table_begin(&table, "lights");
	fill_lights_table(r, trials, &table);
	if (!err)
		err = report_page_table(&r->page, r->page.body, &table, r->fault);
	report_table_free(&table);
	return err;
}

/* Advises a dome. */
static void choose_lights(struct report *r, const struct report_trial *trials)
{
	const struct report_trial *way[REPORT_SWEEP_MAX];
	int found;

	for (int b = 0; b < r->bakes; b++)
		way[b] = &trials[WAYS * b + FAST];
	found = report_trial_choose(r, way, r->bakes, "the coarsest dome");
	if (found == r->bakes - 1)
		report_paragraph(
			r->page.body,
			"It is the finest dome that was tried; --frequency tries finer ones.");
	r->advised_frequency = r->bake[found].settings.frequency;
	report_advise_number(r, REPORT_SCENE, "dome", "frequency", r->advised_frequency,
			     r->render.frequency);
	report_advice_show(r);
}

int report_lights(struct report *r)
{
	static struct report_trial trials[REPORT_SWEEP_MAX * WAYS];
	int err;

	for (int b = 0; b < r->bakes; b++)
		for (int k = 0; k < WAYS; k++)
			describe_way(&trials[WAYS * b + k], &r->bake[b], k);
	err = report_trials_run(trials, r->bakes * WAYS, &r->stage, &r->scope, r->fault);
	for (int b = 0; b < r->bakes; b++)
		if (&r->bake[b] == r->used)
			r->in_use = trials[WAYS * b + FAST];
	if (!err)
		err = show_lights(r, trials);
	if (!err)
		choose_lights(r, trials);
	for (int k = 0; !err && k < r->bakes * WAYS; k++)
		report_candidate_add(r, &trials[k],
				     &r->bake[k / WAYS] == r->used && k % WAYS == FAST);
	return err;
}
