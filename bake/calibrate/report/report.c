/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/report/report.h"

#include <stdio.h>

#include "bake/calibrate/report/report_parts.h"

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
