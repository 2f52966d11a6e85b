/* SPDX-License-Identifier: MIT */
/* Section: a basis file that is in use. Its settings become those in use, with which everything is
 * compared; its own frames are measured at their own size. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "bake/report/report_parts.h"
#include "bake/report/report_sections.h"

/* Reads the errors asked for from a file's provenance, as render writes them. */
static void find_target(const char *provenance, struct encode_target *target)
{
	const char *line = strstr(provenance, "target_levels = ");
	struct encode_target found;

	if (line && sscanf(line, "target_levels = rms %lf, max %lf, cell %lf", &found.rms,
			   &found.max, &found.cell) == 3)
		*target = found;
}

int report_given_open(struct report *r)
{
	const struct basis_info_chunk *info = &r->given.basis.info;
	struct dome dome;
	uint32_t lights;
	int err = report_bake_open(&r->given, r->settings->basis, r->fault);

	if (err)
		return err;
	if (info->poses > 1 && r->settings->pose)
		return fault_say(r->fault, -ENOTSUP, "%s: %u poses, expected one of pose %s alone",
				 r->settings->basis, info->poses, r->settings->pose);
	if (!info->dome_frequency)
		return fault_say(r->fault, -ENOTSUP, "%s: its lights are no dome's",
				 r->settings->basis);
	r->render.frequency = (int)info->dome_frequency;
	r->render.division = (int)info->dome_division;
	r->render.shape = (int)info->light_shape;
	err = fine_list_dome(r->render.fine, r->render.frequency, r->render.division,
			     r->render.shape, &dome, r->fault);
	if (err)
		return err;
	lights = (uint32_t)dome.count;
	dome_free(&dome);
	if (lights != info->lights)
		return fault_say(r->fault, -EINVAL,
				 "%s: %u lights, expected %u as the scene's dome has, finer parts "
				 "included",
				 r->settings->basis, info->lights, lights);
	r->render.column_cut = info->column_cut;
	find_target(r->given.basis.provenance, &r->render.target);
	return 0;
}

static int open_given_stage(struct report *r, struct report_stage *stage)
{
	int err = 0;

	*stage = (struct report_stage){.width = (int)r->given.basis.info.width,
				       .height = (int)r->given.basis.info.height,
				       .all = r->stage.all,
				       .repeat = r->stage.repeat};
	for (int k = 0; !err && k < r->stage.lightings; k++) {
		const struct report_lighting_settings settings = {
			.path = r->settings->panorama[k],
			.made = k,
			.fisheye_side = r->stage.lighting[k].fisheye.width};

		stage->lightings = k + 1;
		err = report_lighting_open(&stage->lighting[k], NULL, stage->width, stage->height,
					   &settings, r->fault);
	}
	return err;
}

static void fill_given_table(const struct report *r, const struct report_trial *trial, int count,
			     struct report_table *t)
{
	report_table_begin(t, "basis-file");
	report_table_column(t, "mode", "mode", NULL);
	report_table_column(t, "threads", "threads", NULL);
	report_table_column(t, "basis_mb", "basis", "MB");
	report_time_columns(t);
	report_table_column(t, "read_mb", "read", "MB");
	report_table_column(t, "double_rms_levels", "RMS", "to double");
	report_table_column(t, "double_psnr_db", "PSNR", "dB");
	report_table_column(t, "double_max_levels", "largest", "levels");
	for (int k = 0; k < count; k++) {
		const bool exact = trial[k].way.mode == COMPOSITOR_EXACT;

		report_text(t, "%s", compositor_mode_names[trial[k].way.mode]);
		report_number(t, trial[k].way.threads);
		report_number(t, exact ? r->given.exact_mb : r->given.shown_mb);
		report_time_cells(t, &trial[k]);
		report_number(t, trial[k].read_mb);
		report_number(t, trial[k].precise.all.rms);
		report_number(t, trial[k].precise.all.psnr_db);
		report_number(t, trial[k].precise.all.max);
		if (!k)
			report_table_mark(t);
	}
}

static int show_given(struct report *r, const struct report_trial *trial, int count)
{
	const struct basis_info_chunk *info = &r->given.basis.info;
	struct report_table table;
	int err;

	fill_given_table(r, trial, count, &table);
	report_heading(r->page.body, "What does the basis file in use cost as it is?");
	report_paragraph(r->page.body,
			 "%s at its own %u x %u pixels with %u lights; errors are against double "
			 "precision of %s. All else in this page is baked anew, with its number of "
			 "lights, errors and cut, in pictures small enough for it.",
			 r->settings->basis, info->width, info->height, info->lights,
			 r->given.exact ? "its exact layer" : "what it holds");
	err = report_page_table(&r->page, r->page.body, &table, r->fault);
	report_table_free(&table);
	return err;
}

int report_given(struct report *r)
{
	const int modes = r->given.exact ? 2 : 1, threads = r->threads > 1 ? 2 : 1;
	struct report_trial trial[4] = {{.read_mb = 0}};
	struct report_stage stage;
	struct scope scope = {.pixel = NULL};
	int err;

	if (!r->settings->basis)
		return 0;
	err = open_given_stage(r, &stage);
	if (!err && scope_create(&scope, &r->given.basis, report_bake_layer(&r->given)))
		err = fault_say(r->fault, -ENOMEM, "not enough memory");
	for (int k = 0; k < modes * threads; k++) {
		trial[k].way = report_way_plain(&r->given);
		trial[k].way.mode = k / threads ? COMPOSITOR_EXACT : COMPOSITOR_FAST;
		trial[k].way.threads = k % threads ? r->threads : 1;
	}
	if (!err)
		err = report_trials_run(trial, modes * threads, &stage, &scope, r->fault);
	if (!err)
		err = show_given(r, trial, modes * threads);
	scope_free(&scope);
	for (int k = 0; k < stage.lightings; k++)
		report_lighting_close(&stage.lighting[k]);
	return err;
}
