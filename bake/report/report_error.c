/* SPDX-License-Identifier: MIT */
/* Section: what a smaller or larger error of the encoding costs. */
#include <stdio.h>

#include "bake/report/report_parts.h"
#include "bake/report/report_sections.h"

static const double factors[] = {0.25, 0.5, 1, 2, 4, 8};
static const double factors_quick[] = {1, 4};

struct error_sweep {
	struct report_bake bake[sizeof(factors) / sizeof(*factors)];
	struct report_trial trial[sizeof(factors) / sizeof(*factors)];
	const double *factor;
	int count;
};

static int make_error_bakes(struct report *r, struct error_sweep *e)
{
	int err = 0;

	for (int k = 0; !err && k < e->count; k++) {
		struct render_settings settings = r->used->settings;
		struct report_bake *bake = &e->bake[k];

		settings.target.rms *= e->factor[k];
		settings.target.max *= e->factor[k];
		settings.target.cell *= e->factor[k];
		settings.exact = false;
		report_step(r, "bake with an error of %.3g levels", settings.target.rms);
		err = report_bake_make(bake, r->scene, &settings, r->page.temporary, r->fault);
		bake->reference = r->used;
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
	for (int k = 0; k < e->count; k++) {
		const struct report_bake *bake = &e->bake[k];
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
		if (e->factor[k] == 1)
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
	for (int k = 0; k < e->count; k++) {
		struct report_point *point = report_plot_point(&p, e->trial[k].precise.all.rms,
							       memory ? e->bake[k].shown_mb
								      : e->trial[k].median_ms);

		snprintf(point->label, sizeof(point->label), "%.3g",
			 e->bake[k].settings.target.rms);
		point->ringed = e->factor[k] == 1;
	}
	return report_page_plot(
		&r->page, r->page.body, &p,
		memory ? "Size of the fast basis against the error that it makes; the "
			 "RMS asked for beside each point. Ring: the setting in use."
		       : "Time of a frame against the same.",
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
		"scene; the surroundings here are none of those. Errors are against the "
		"exact layer of the setting in use in double precision, from the same rays.");
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

int report_declared_error(struct report *r)
{
	static struct error_sweep e;
	int err;

	if (!r->scene)
		return 0;
	e = (struct error_sweep){.factor = factors, .count = sizeof(factors) / sizeof(*factors)};
	if (r->settings->quick) {
		e.factor = factors_quick;
		e.count = sizeof(factors_quick) / sizeof(*factors_quick);
	}
	err = make_error_bakes(r, &e);
	if (!err)
		err = report_trials_run(e.trial, e.count, &r->stage, &r->scope, r->fault);
	if (!err)
		err = show_error_sweep(r, &e);
	for (int k = 0; k < e.count; k++) {
		if (!err && e.factor[k] != 1)
			report_candidate_add(r, &e.trial[k], false);
		report_bake_close(&e.bake[k]);
	}
	return err;
}
