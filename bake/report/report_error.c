/* SPDX-License-Identifier: MIT */
/* Section: what a smaller or larger error of the encoding costs. */
#include <stdio.h>

#include "bake/report/report_parts.h"

/* What the errors asked for are multiplied by; 1 is the setting in use. */
static const double factors[] = {0.5, 1, 2, 4};

#define FACTORS ((int)(sizeof(factors) / sizeof(*factors)))

struct error_sweep {
	struct report_bake made[FACTORS];
	struct report_bake *bake[FACTORS]; /* those, or the bake of the setting in use */
	struct report_trial trial[FACTORS];
};

int report_error_bakes(void)
{
	return FACTORS - 1;
}

static struct encode_target target_times(const struct report *r, double factor)
{
	struct encode_target target = r->used->settings.target;

	target.rms *= factor;
	target.max *= factor;
	target.cell *= factor;
	return target;
}

static int make_error_bakes(struct report *r, struct error_sweep *e)
{
	int err = 0;

	for (int k = 0; !err && k < FACTORS; k++) {
		struct render_settings settings = r->used->settings;
		struct report_bake *bake = &e->made[k];

		settings.target = target_times(r, factors[k]);
		settings.exact = false;
		e->bake[k] = r->used;
		if (factors[k] != 1) {
			e->bake[k] = bake;
			report_step(r, "bake with an error of %.3g levels", settings.target.rms);
			err = report_bake_make(bake, r->scene, &settings, r->page.temporary,
					       r->fault);
			bake->reference = r->used;
		}
		bake = e->bake[k];
		e->trial[k].way = report_way_plain(bake);
		snprintf(e->trial[k].name, sizeof(e->trial[k].name), "%u lights, error %.3g",
			 bake->basis.info.lights, settings.target.rms);
	}
	return err;
}

static void fill_error_table(const struct report *r, const struct error_sweep *e,
			     struct report_table *t)
{
	report_table_column(t, "asked_rms_levels", "asked RMS", "levels");
	report_table_column(t, "asked_cell_levels", "asked, cell", "levels");
	report_table_column(t, "declared_sky_rms", "declared RMS", "skies");
	report_table_column(t, "declared_sky_max", NULL, NULL);
	report_table_column(t, "declared_cell_rms", "declared RMS", "cells");
	report_table_column(t, "declared_cell_max", NULL, NULL);
	report_table_column(t, "patterns", "patterns", "mean");
	report_table_column(t, "columns", "columns", "mean");
	report_table_column(t, "basis_mb", "basis", "MB");
	report_result_columns(r, t);
	for (int k = 0; k < FACTORS; k++) {
		const struct report_bake *bake = e->bake[k];
		const struct basis_info_chunk *info = &bake->basis.info;

		report_number(t, bake->settings.target.rms);
		report_number(t, bake->settings.target.cell);
		report_number(t, info->sky_rms);
		report_number(t, info->sky_max);
		report_number(t, info->cell_rms);
		report_number(t, info->cell_max);
		report_number(t, bake->patterns);
		report_number(t, bake->columns);
		report_number(t, bake->shown_mb);
		report_result_cells(r, t, &e->trial[k]);
		if (factors[k] == 1)
			report_table_mark(t);
	}
}

static int plot_error_sweep(struct report *r, const struct error_sweep *e, const char *name,
			    bool memory)
{
	struct report_plot p;

	report_plot_begin(&p, name, "RMS error against double precision, levels",
			  memory ? "size of the basis, MB" : "time of a frame, ms");
	p.x_log = p.y_log = true;
	report_plot_series(&p, NULL, STYLE_LINE, memory ? 3 : 1);
	for (int k = 0; k < FACTORS; k++) {
		const double rms = e->trial[k].precise.all.rms;
		struct report_point *point = memory ? report_plot_point(&p, rms,
									e->bake[k]->shown_mb)
						    : report_time_point(&p, rms, &e->trial[k]);

		snprintf(point->label, sizeof(point->label), "%.3g",
			 e->bake[k]->settings.target.rms);
		point->ringed = factors[k] == 1;
	}
	return report_page_plot(
		&r->page, r->page.body, &p,
		memory ? "Size of the fast basis against the error that it makes; the RMS asked for beside each point. Ring: the setting in use."
		       : "Time of a frame against the same, with its quartiles.",
		r->fault);
}

static int show_error_sweep(struct report *r, const struct error_sweep *e)
{
	struct report_table table;
	int err;

	report_heading(r->page.body, "What does a smaller declared error cost?");
	report_paragraph(
		r->page.body,
		"The bake keeps as many patterns and columns in each tile as the error "
		"asked for needs, under skies and single cells that are the same for every "
		"scene; the surroundings here are none of those. Errors are against the exact layer of the setting in use in double precision, from the same rays.");
	err = plot_error_sweep(r, e, "error-memory", true);
	if (!err)
		err = plot_error_sweep(r, e, "error-time", false);
	report_table_begin(&table, "declared-error");
	fill_error_table(r, e, &table);
	if (!err)
		err = report_page_table(&r->page, r->page.body, &table, r->fault);
	report_table_free(&table);
	return err;
}

/* Advises an error: larger ones, whose files are smaller, before smaller ones. */
static void choose_error(struct report *r, const struct error_sweep *e)
{
	const struct report_trial *way[FACTORS];
	const struct encode_target *used = &r->render.target;
	struct encode_target target;
	int found;

	for (int k = 0; k < FACTORS; k++)
		way[k] = &e->trial[FACTORS - 1 - k];
	found = FACTORS - 1 - report_trial_choose(r, way, FACTORS, "the largest error");
	target = target_times(r, factors[found]);
	report_advise_number(r, REPORT_SCENE, "render", "error", target.rms, used->rms);
	if (used->max > 0)
		report_advise_number(r, REPORT_SCENE, "render", "error_max", target.max, used->max);
	report_advise_number(r, REPORT_SCENE, "render", "cell_error", target.cell, used->cell);
	report_advice_show(r);
}

int report_declared_error(struct report *r)
{
	static struct error_sweep e;
	int err;

	e = (struct error_sweep){.bake = {NULL}};
	err = make_error_bakes(r, &e);
	if (!err)
		err = report_trials_run(e.trial, FACTORS, &r->stage, &r->scope, r->fault);
	if (!err)
		err = show_error_sweep(r, &e);
	if (!err)
		choose_error(r, &e);
	for (int k = 0; k < FACTORS; k++) {
		if (!err && factors[k] != 1)
			report_candidate_add(r, &e.trial[k], false);
		report_bake_close(&e.made[k]);
	}
	return err;
}
