/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_report.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#include "bake/base/report_page.h"
#include "hal/base/json.h"

struct light_page {
	struct report_page page;
	FILE *file; /* light.json */
	struct json json;
	struct fault *fault;
	int err; /* first error; later calls then do nothing */
};

static void begin_page(struct light_page *r, const char *folder, const char *what,
		       const struct verdict *verdict, struct fault *fault)
{
	char path[PATH_MAX + 16], sentence[VERDICT_SENTENCE_MAX];

	*r = (struct light_page){.fault = fault};
	r->err = report_page_open(&r->page, folder, fault);
	if (r->err)
		return;
	snprintf(path, sizeof(path), "%s/light.json", r->page.temporary);
	r->file = fopen(path, "w");
	if (!r->file) {
		r->err = -errno;
		fault_say(fault, r->err, "%s: %s", path, strerror(-r->err));
		return;
	}
	json_begin(&r->json, r->file);
	json_text(&r->json, "what", what);
	verdict_write_json(&r->json, verdict);
	verdict_sentence(verdict, sentence, sizeof(sentence));
	report_heading(r->page.body, "%s", what);
	report_paragraph(r->page.body, "Verdict: %s.", sentence);
}

/* Adds a figure to the page and to JSON. */
static void report_figure(struct light_page *r, const char *key, const char *label, double value,
			  const char *unit)
{
	if (r->err)
		return;
	json_number(&r->json, key, value);
	report_paragraph(r->page.body, "%s: %.4g%s%s", label, value, *unit ? " " : "", unit);
}

static void report_numbers(struct light_page *r, const char *key, const double *value, int count)
{
	if (!r->err)
		json_numbers(&r->json, key, value, count);
}

static void show_table(struct light_page *r, struct table *table)
{
	if (!r->err)
		r->err = report_page_table(&r->page, table, r->fault);
	table_free(table);
}

static int finish_page(struct light_page *r, const char *title)
{
	if (r->file) {
		if (!r->err)
			json_end(&r->json);
		if (!r->err && ferror(r->file))
			r->err = fault_say(r->fault, -EIO, "light.json cannot be written");
		if (fclose(r->file) != 0 && !r->err)
			r->err = fault_say(r->fault, -EIO, "light.json cannot be written");
	}
	if (!r->err)
		r->err = report_page_commit(&r->page, title, r->fault);
	report_page_abandon(&r->page);
	return r->err;
}

int light_report_black(const char *folder, const struct light_black *black, struct fault *fault)
{
	struct light_page r;

	begin_page(&r, folder, "Black level", &black->verdict, fault);
	report_figure(&r, "black_level", "Code value that is no light", black->level, "");
	report_figure(&r, "deviation", "One standard deviation of it", black->deviation, "");
	report_figure(&r, "noise", "Noise of a pixel, one standard deviation", black->noise,
		      "codes");
	report_figure(&r, "lightest", "Mean of the lightest part of the picture", black->lightest,
		      "");
	report_numbers(&r, "channels", black->channel, 3);
	return finish_page(&r, "Black level");
}

/* ---- response ---- */

static void tabulate_exposures(struct light_page *r, const struct light_response *found)
{
	struct table table;

	table_begin(&table, "exposures");
	table_column(&table, "exposure", "exposure", NULL);
	table_column(&table, "time", "time", NULL);
	table_column(&table, "time_deviation_percent", "its deviation", "%");
	table_column(&table, "offset_percent", "off from all by", "%");
	table_column(&table, "scatter_percent", "scatter", "%");
	for (int j = 0; j < found->exposures; j++) {
		table_number(&table, j + 1);
		table_number(&table, found->time[j]);
		table_number(&table, 100 * found->time_deviation[j]);
		table_number(&table, 100 * found->offset[j]);
		table_number(&table, 100 * found->scatter[j]);
	}
	show_table(r, &table);
}

int light_report_response(const char *folder, const struct light_response *found,
			  struct fault *fault)
{
	struct light_page r;

	begin_page(&r, folder, "Response", &found->verdict, fault);
	report_figure(&r, "samples", "Places of the scene", found->samples, "");
	report_figure(&r, "from_percent", "Lowest code value seen", 100 * found->from, "%");
	report_figure(&r, "to_percent", "Highest code value seen", 100 * found->to, "%");
	report_figure(&r, "sigma", "What is left over, in what noise explains", found->sigma, "");
	report_figure(&r, "held_out", "The same of exposures that were held out", found->held_out,
		      "");
	report_figure(&r, "pieces", "Pieces of the curve", found->spline.pieces, "");
	tabulate_exposures(&r, found);
	report_numbers(&r, "response", found->curve.knot, TRANSFER_KNOTS);
	report_numbers(&r, "response_deviation", found->deviation, TRANSFER_KNOTS);
	report_numbers(&r, "times", found->time, found->exposures);
	report_numbers(&r, "level_offset", found->level_offset, LIGHT_LEVELS);
	report_numbers(&r, "level_scatter", found->level_scatter, LIGHT_LEVELS);
	report_numbers(&r, "channel_off", found->channel_off, 3);
	report_numbers(&r, "channel_deviation", found->channel_deviation, 3);
	return finish_page(&r, "Response");
}

/* ---- gain, colours ---- */

int light_report_gain(const char *folder, const struct light_gain *found,
		      const struct light_pair *pairs, struct fault *fault)
{
	struct table table;
	struct light_page r;

	begin_page(&r, folder, "Gain", &found->verdict, fault);
	report_figure(&r, "gain", "Gain: the fisheye's units to the background camera's",
		      found->gain, "");
	report_figure(&r, "deviation", "One standard deviation of it", found->deviation, "");
	report_numbers(&r, "balance", found->balance, 3);
	table_begin(&table, "pairs");
	table_column(&table, "pair", "pair", NULL);
	table_column(&table, "gain", "its own gain", NULL);
	table_column(&table, "weight", "weight", NULL);
	table_column(&table, "uneven_percent", "patch uneven by", "%");
	table_column(&table, "clipped_sky_percent", "of the sky clipped", "%");
	for (int k = 0; k < found->pairs; k++) {
		table_number(&table, k + 1);
		table_number(&table, found->ratio[k]);
		table_number(&table, found->weight[k]);
		table_number(&table, 100 * pairs[k].patch.uneven);
		table_number(&table, 100 * pairs[k].clipped_sky);
	}
	show_table(&r, &table);
	report_numbers(&r, "ratios", found->ratio, found->pairs);
	return finish_page(&r, "Gain");
}

int light_report_colours(const char *folder, const struct light_colours *found, struct fault *fault)
{
	struct table table;
	struct light_page r;

	begin_page(&r, folder, "Colours", &found->verdict, fault);
	report_figure(&r, "before_percent", "Patches differ, before", 100 * found->before, "%");
	report_figure(&r, "after_percent", "Patches differ, after", 100 * found->after, "%");
	report_figure(&r, "scale", "Background over fisheye, of grey", found->scale, "");
	report_figure(&r, "condition", "Condition of the equations", found->condition, "");
	table_begin(&table, "colours");
	table_column(&table, "element", "element", NULL);
	table_column(&table, "value", "value", NULL);
	table_column(&table, "deviation", "deviation", NULL);
	for (int e = 0; e < 9; e++) {
		table_text(&table, "%s", found->estimate.parameter[e].name);
		table_number(&table, found->matrix[e]);
		table_number(&table, estimate_deviation(&found->estimate, e));
	}
	show_table(&r, &table);
	report_numbers(&r, "colours", found->matrix, 9);
	report_numbers(&r, "residuals", found->residual, found->patches);
	return finish_page(&r, "Colours");
}
