/* SPDX-License-Identifier: MIT */
/* Section: how many lights, and how their radiance is read from the fisheye's picture. */
#include <stdio.h>

#include "bake/report/report_parts.h"
#include "bake/report/report_sections.h"

enum { CELL, NODE, EXACT, THESIS, WAYS };

/* The thesis's algorithm is tried in a full report. */
static int ways_of(const struct report *r)
{
	return r->settings->full ? WAYS : THESIS;
}

static int trial_index(const struct report *r, int bake, int way)
{
	return bake * ways_of(r) + way;
}

static void describe_way(struct report_trial *trial, struct report_bake *bake, int which)
{
	static const char *const names[WAYS] = {"", ", node", ", exact layer", ", thesis"};

	trial->way = report_way_plain(bake);
	trial->way.input = which == NODE ? INPUT_NODE : INPUT_CELL;
	trial->way.mode = which == EXACT && bake->exact ? COMPOSITOR_EXACT : COMPOSITOR_FAST;
	trial->way.thesis = which == THESIS;
	snprintf(trial->name, sizeof(trial->name), "%u lights%s", bake->basis.info.lights,
		 names[which]);
}

static void fill_lights_table(const struct report *r, const struct report_trial *trials,
			      struct report_table *t)
{
	static const char *const modes[WAYS] = {"fast", "fast", "exact", "thesis"};

	report_table_column(t, "lights", "lights", NULL);
	report_table_column(t, "frequency", "f", NULL);
	report_table_column(t, "way", "way", NULL);
	report_table_column(t, "estimator", "estimator", NULL);
	report_table_column(t, "basis_mb", "basis", "MB");
	report_table_column(t, "bake_s", "bake", "processor s");
	report_table_column(t, "bake_noise_levels", NULL, NULL);
	report_result_columns(r, t);
	for (int b = 0; b < r->bakes; b++) {
		const struct report_bake *bake = &r->bake[b];

		for (int k = 0; k < ways_of(r); k++) {
			const struct report_trial *trial = &trials[trial_index(r, b, k)];

			report_number(t, bake->basis.info.lights);
			report_number(t, bake->settings.frequency);
			report_text(t, "%s", modes[k]);
			report_text(t, "%s", k == NODE ? "node" : "cell");
			report_number(t, k == THESIS  ? trial->read_mb
					 : k == EXACT ? bake->exact_mb
						      : bake->shown_mb);
			report_number(t, report_bake_seconds(bake));
			report_number(t, bake->report.info.noise_levels);
			report_result_cells(r, t, trial);
			if (bake == r->used && k == CELL)
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
		for (int k = CELL; k <= NODE; k++) {
			char label[80];

			snprintf(label, sizeof(label), "%s%s", r->stage.lighting[l].name,
				 k == NODE ? ", node" : "");
			report_plot_series(&plot, label, k == NODE ? STYLE_DASHED : STYLE_LINE,
					   l + 1);
			for (int b = 0; b < r->bakes; b++) {
				const struct report_trial *trial = &trials[trial_index(r, b, k)];
				struct report_point *point =
					report_plot_point(&plot, r->bake[b].basis.info.lights,
							  trial->truth.each[l].rms);

				point->ringed = &r->bake[b] == r->used && k == CELL;
			}
		}
	}
	return report_page_plot(
		&r->page, r->page.body, &plot,
		"Error of the finished picture by number of lights. Solid: the mean "
		"over each light's cell; dashed: the picture at its node. Rings: the "
		"setting in use.",
		r->fault);
}

static int plot_times(struct report *r, const struct report_trial *trials)
{
	static const struct {
		int way, colour;
		const char *name;
	} lines[] = {{THESIS, 2, "thesis's algorithm"}, {EXACT, 3, "exact"}, {CELL, 1, "fast"}};
	struct report_plot plot;

	report_plot_begin(&plot, "lights-time", "number of lights", "time of a frame, ms");
	plot.x_log = plot.y_log = true;
	light_ticks(r, &plot);
	for (size_t k = 0; k < sizeof(lines) / sizeof(*lines); k++) {
		if (lines[k].way >= ways_of(r))
			continue;
		report_plot_series(&plot, lines[k].name, STYLE_LINE, lines[k].colour);
		for (int b = 0; b < r->bakes; b++) {
			const int at = trial_index(r, b, lines[k].way);

			report_time_point(&plot, r->bake[b].basis.info.lights, &trials[at])
				->ringed = &r->bake[b] == r->used && lines[k].way == CELL;
		}
	}
	return report_page_plot(
		&r->page, r->page.body, &plot,
		"Time of a frame by number of lights, one thread, with its quartiles. Ring: the "
		"setting in use.",
		r->fault);
}

static int show_lights(struct report *r, const struct report_trial *trials)
{
	struct report_table table;
	int err = 0;

	report_heading(r->page.body, "How many lights, and how are they sampled?");
	report_paragraph(
		r->page.body,
		"Each number of lights is a bake of its own. The fisheye picture gives "
		"each light the mean over its cell of the sky, or what it shows at the "
		"cell's node. Times are of one thread.%s",
		r->settings->full
			? " The thesis's algorithm has a byte for each light, pixel and "
			  "channel, sums in double precision, and its errors are in levels "
			  "of linear light."
			: "");
	if (r->truth)
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

/* Advises a dome, and how its lights are read. */
static void choose_lights(struct report *r, const struct report_trial *trials)
{
	const struct report_trial *way[REPORT_SWEEP_MAX];
	int found;

	for (int b = 0; b < r->bakes; b++)
		way[b] = &trials[trial_index(r, b, CELL)];
	found = report_trial_choose(r, way, r->bakes, "the coarsest dome", false);
	if (found == r->bakes - 1)
		report_paragraph(r->page.body, "It is the finest dome that was tried; "
					       "--frequency tries finer ones.");
	r->advised.frequency = r->bake[found].settings.frequency;
	r->advised.fine = r->bake[found].settings.fine;
	report_advise_number(r, REPORT_SCENE, "dome", "frequency", r->advised.frequency,
			     r->render.frequency);
	report_advice_show(r);
	report_paragraph(r->page.body, "Means over cells or the nodes alone, with the lights in "
				       "use:");
	for (int k = CELL; k <= NODE; k++)
		way[k] = &trials[trial_index(r, (int)(r->used - r->bake), k)];
	found = report_trial_choose(r, way, 2, "the mean over cells", false);
	r->advised_way.input = found ? INPUT_NODE : INPUT_CELL;
	report_advise(r, REPORT_KIOSK, "fisheye", "estimator", found ? "node" : "cell", NULL);
	report_advice_show(r);
}

int report_lights(struct report *r)
{
	static struct report_trial trials[REPORT_SWEEP_MAX * WAYS];
	int err;

	for (int b = 0; b < r->bakes; b++)
		for (int k = 0; k < ways_of(r); k++)
			describe_way(&trials[trial_index(r, b, k)], &r->bake[b], k);
	err = report_trials_run(trials, r->bakes * ways_of(r), &r->stage, &r->scope, r->fault);
	for (int b = 0; b < r->bakes; b++)
		if (&r->bake[b] == r->used)
			r->in_use = trials[trial_index(r, b, CELL)];
	if (!err)
		err = show_lights(r, trials);
	if (!err && r->truth)
		choose_lights(r, trials);
	for (int k = 0; !err && k < r->bakes * ways_of(r); k++)
		if (!trials[k].way.thesis)
			report_candidate_add(r, &trials[k],
					     &r->bake[k / ways_of(r)] == r->used &&
						     k % ways_of(r) == CELL);
	return err;
}
