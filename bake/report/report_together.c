/* SPDX-License-Identifier: MIT */
/* Section: all that the sections before have advised for the picture, in one bake. Each of them has
 * been tried alone, and errors add up. */
#include <stdio.h>

#include "bake/report/report_parts.h"
#include "bake/report/report_sections.h"

enum { IN_USE, TOGETHER, BOTH };

/* Finds the bake that is advised among those of the numbers of lights, or makes it. Its errors
 * against double precision are then those to the exact layer of the one with as many lights. */
static int bake_advised(struct report *r, struct report_bake *made, struct report_bake **bake)
{
	struct render_settings settings = r->advised;
	struct report_bake *dome = report_advised_dome(r);
	int err;

	report_step(r, "bake of what is advised");
	*bake = dome;
	if (dome->settings.target.rms == settings.target.rms)
		return 0;
	settings.exact = false;
	if (settings.coarse > settings.frequency)
		settings.coarse = 0;
	*bake = made;
	err = report_bake_make(made, r->scene, &settings, r->page.temporary, r->fault);
	made->reference = dome;
	return err;
}

static int show_together(struct report *r, const struct report_trial *trial)
{
	struct report_table t;
	int err;

	report_table_begin(&t, "together");
	report_table_column(&t, "setting", "setting", NULL);
	report_table_column(&t, "basis_mb", "basis", "MB");
	report_table_column(&t, "bake_s", "bake", "processor s");
	report_result_columns(r, &t);
	for (int k = 0; k < BOTH; k++) {
		report_text(&t, "%s", trial[k].name);
		report_number(&t, trial[k].way.bake->shown_mb);
		report_number(&t, report_bake_seconds(trial[k].way.bake));
		report_result_cells(r, &t, &trial[k]);
		if (k == IN_USE)
			report_table_mark(&t);
	}
	err = report_page_table(&r->page, r->page.body, &t, r->fault);
	report_table_free(&t);
	return err;
}

static void judge_together(struct report *r, const struct report_trial *trial)
{
	const struct report_result used = report_result_of(r, &trial[IN_USE]);
	const struct report_result all = report_result_of(r, &trial[TOGETHER]);
	const bool faster = report_is_faster(&all, &used), slower = report_is_faster(&used, &all);
	const bool nearer = report_is_nearer(&all, &used), farther = report_is_nearer(&used, &all);

	report_paragraph(r->page.body,
			 "Beside the setting in use, what is advised is %s, and %s (noise %.2g "
			 "levels).%s",
			 faster	  ? "faster"
			 : slower ? "slower"
				  : "as fast",
			 nearer	   ? "nearer"
			 : farther ? "further off"
				   : "as near",
			 all.noise,
			 all.rms == used.rms ? " It makes the same picture."
			 : !faster && !nearer
				 ? " Take the lights for a nearer picture, or the other "
				   "lines for a faster one, not both."
				 : "");
}

int report_together(struct report *r)
{
	struct report_trial trial[BOTH] = {{.way = report_way_plain(r->used), .name = "in use"},
					   {.way = r->advised_way, .name = "advised"}};
	struct report_bake made = {.exact = false};
	int err;

	if (!r->scene)
		return 0;
	err = bake_advised(r, &made, &trial[TOGETHER].way.bake);
	if (!err)
		err = report_trials_run(trial, BOTH, &r->stage, &r->scope, r->fault);
	if (!err) {
		report_heading(r->page.body, "And all that is advised, together?");
		report_paragraph(
			r->page.body,
			"Each choice above was tried alone, with all else as in use. Here "
			"are all of them in one bake, with as many samples as the others.");
		err = show_together(r, trial);
	}
	if (!err) {
		judge_together(r, trial);
		report_candidate_add(r, &trial[TOGETHER], false);
	}
	report_bake_close(&made);
	return err;
}
