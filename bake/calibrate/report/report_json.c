/* SPDX-License-Identifier: MIT */
/* Writes a finding as JSON, for programs. */
#include <limits.h>
#include <math.h>
#include <stdio.h>

#include "bake/calibrate/report/report_parts.h"
#include "hal/base/json.h"
#include "hal/base/output.h"

static void write_estimate(struct json *json, const struct estimate *e)
{
	json_array(json, "parameters");
	for (int k = 0; k < e->count; k++) {
		const struct parameter *p = &e->parameter[k];

		json_object(json, NULL);
		json_text(json, "name", p->name);
		json_text(json, "unit", p->unit);
		json_number(json, "value", p->value);
		json_bool(json, "fixed", p->fixed);
		json_number(json, "deviation", estimate_deviation(e, k));
		json_end(json);
	}
	json_end(json);
	json_array(json, "covariance");
	for (int k = 0; k < e->count; k++)
		json_numbers(json, NULL, e->covariance + (size_t)k * (size_t)e->count, e->count);
	json_end(json);
	json_number(json, "residuals", e->residuals);
	json_number(json, "freedom", e->freedom);
	json_number(json, "sigma_px", e->sigma);
}

static void write_figures(struct json *json, const struct finding *f)
{
	json_object(json, "figures");
	for (int k = 0; k < f->figures; k++) {
		json_object(json, f->figure[k].key);
		json_text(json, "label", f->figure[k].label);
		json_text(json, "unit", f->figure[k].unit);
		json_number(json, "value", f->figure[k].value);
		json_end(json);
	}
	json_end(json);
}

static void write_points(struct json *json, const struct shown *s)
{
	const struct observations *seen = s->finding->seen;

	json_array(json, "views");
	for (int v = 0; v < seen->views; v++) {
		json_object(json, NULL);
		json_text(json, "file", seen->view[v].name);
		json_number(json, "points", seen->view[v].count);
		json_number(json, "rms_px", s->view[v].rms);
		json_number(json, "worst_px", s->view[v].worst);
		json_number(json, "outliers", s->view[v].outliers);
		json_end(json);
	}
	json_end(json);
	json_array(json, "points");
	for (int k = 0; k < seen->count; k++) {
		const struct observation *p = &seen->point[k];

		json_object(json, NULL);
		json_text(json, "name", p->name);
		json_number(json, "view", p->view);
		json_numbers(json, "world", p->world, 3);
		json_numbers(json, "seen_px", p->px, 2);
		json_numbers(json, "expected_px", s->finding->expected[k], 2);
		json_numbers(json, "residual_px", s->residual[k], 2);
		json_number(json, "weight", s->finding->weight[k]);
		json_bool(json, "outlier", s->outlier[k]);
		json_end(json);
	}
	json_end(json);
}

int report_json_write(const struct shown *s, const char *folder, struct fault *fault)
{
	const struct finding *f = s->finding;
	struct output out = {.stream = NULL};
	char path[PATH_MAX];
	struct json json;
	int err;

	snprintf(path, sizeof(path), "%s/calibration.json", folder);
	err = output_open(&out, path, fault);
	if (err)
		return err;
	json_begin(&json, out.stream);
	json_text(&json, "what", f->what);
	json_text(&json, "model", f->model);
	json_number(&json, "width", s->width);
	json_number(&json, "height", s->height);
	verdict_write_json(&json, &f->verdict);
	json_number(&json, "rms_px", s->modelled ? f->rms_px : NAN);
	json_number(&json, "worst_px", s->modelled ? f->worst_px : NAN);
	json_number(&json, "outliers", s->outliers);
	write_figures(&json, f);
	write_estimate(&json, &f->estimate);
	write_points(&json, s);
	json_end(&json);
	err = output_commit(&out, fault);
	output_abandon(&out);
	return err;
}
