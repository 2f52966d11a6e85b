/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/report/report.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>

#include "bake/calibrate/report/report_parts.h"
#include "hal/base/json.h"
#include "hal/base/output.h"

/* Writes the verdict at the top: one sentence, marked by colour and by word. */
static void write_verdict(FILE *to, const struct verdict *verdict)
{
	char sentence[VERDICT_SENTENCE_MAX];

	verdict_sentence(verdict, sentence, sizeof(sentence));
	fprintf(to,
		"<p style=\"font-size:1.2em;border-left:.5em solid %s;padding-left:.7em\"><strong>%s</strong> ",
		verdict->trusted ? "#0072b2" : "#d55e00",
		verdict->trusted ? "Trusted." : "Not trusted.");
	if (verdict->trusted)
		fputs("The result may be used for the scene it was judged for.", to);
	else
		report_write_escaped(to, sentence);
	fputs("</p>\n", to);
}

static void write_summary(const struct shown *s)
{
	const struct observations *seen = s->finding->seen;

	write_verdict(s->page->body, &s->finding->verdict);
	report_paragraph(s->page->body, "%d points in %d views of %d x %d px.", seen->count,
			 seen->views, s->width, s->height);
	if (s->modelled)
		report_paragraph(s->page->body, "Model: %s. Outliers left out: %d.",
				 s->finding->model, s->outliers);
	else
		report_paragraph(s->page->body, "No model was found.");
}

static int write_sections(const struct shown *s, struct fault *fault)
{
	static const struct {
		int (*write)(const struct shown *s, struct fault *fault);
		bool of_model; /* needs a model */
	} sections[] = {
		{report_figures, true},	   {report_views, false},
		{report_residuals, true},  {report_parts_of_picture, false},
		{report_parameters, true},
	};
	int err = 0;

	for (size_t k = 0; k < sizeof(sections) / sizeof(*sections) && !err; k++)
		if (s->modelled || !sections[k].of_model)
			err = sections[k].write(s, fault);
	return err;
}

int calibration_report_write(const char *folder, const struct finding *finding,
			     const struct image *const *pictures, struct fault *fault)
{
	struct report_page page;
	struct shown shown;
	char title[128];
	int err = report_page_open(&page, folder, fault);

	if (err)
		return err;
	err = shown_begin(&shown, finding, pictures, &page, fault);
	if (!err) {
		write_summary(&shown);
		err = write_sections(&shown, fault);
		if (!err)
			err = report_json_write(&shown, page.temporary, fault);
		shown_free(&shown);
	}
	snprintf(title, sizeof(title), "Calibration of the %s", finding->what);
	if (!err)
		err = report_page_commit(&page, title, fault);
	report_page_abandon(&page);
	return err;
}

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
