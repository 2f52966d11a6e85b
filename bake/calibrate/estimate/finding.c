/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/finding.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int finding_create(struct finding *finding, const char *what, const struct observations *seen)
{
	const size_t n = (size_t)seen->count;

	*finding = (struct finding){
		.what = what, .width = seen->width, .height = seen->height, .seen = seen};
	verdict_begin(&finding->verdict);
	finding->expected = calloc(n ? n : 1, sizeof(*finding->expected));
	finding->weight = calloc(n ? n : 1, sizeof(*finding->weight));
	if (!finding->expected || !finding->weight) {
		finding_free(finding);
		return -ENOMEM;
	}
	return 0;
}

void finding_free(struct finding *finding)
{
	free(finding->expected);
	free(finding->weight);
	estimate_free(&finding->estimate);
	*finding = (struct finding){0};
}

void finding_print(FILE *to, const char *before, const struct finding *finding)
{
	const struct observations *seen = finding->seen;
	char sentence[VERDICT_SENTENCE_MAX];

	verdict_sentence(&finding->verdict, sentence, sizeof(sentence));
	fprintf(to, "%s%s\n", before, sentence);
	if (!finding->estimate.count)
		return;
	fprintf(to, "%s%s: %d points in %d %s, rms %.4g px, worst %.4g px\n", before,
		finding->model, seen->count, seen->views, seen->views == 1 ? "view" : "views",
		finding->rms_px, finding->worst_px);
	for (int k = 0; k < finding->figures; k++) {
		const struct finding_figure *figure = &finding->figure[k];

		if (isfinite(figure->value))
			fprintf(to, "%s%s: %.6g%s%s\n", before, figure->label, figure->value,
				figure->unit[0] ? " " : "", figure->unit);
		else
			fprintf(to, "%s%s: not known\n", before, figure->label);
	}
}

void finding_add(struct finding *finding, const char *key, const char *label, const char *unit,
		 double value)
{
	struct finding_figure *figure = &finding->figure[finding->figures];

	assert(finding->figures < FINDING_FIGURES_MAX);
	snprintf(figure->key, sizeof(figure->key), "%s", key);
	snprintf(figure->label, sizeof(figure->label), "%s", label);
	snprintf(figure->unit, sizeof(figure->unit), "%s", unit);
	figure->value = value;
	finding->figures++;
}

static bool same_observation(const struct observation *a, const struct observation *b)
{
	return !memcmp(a->world, b->world, sizeof(a->world)) &&
	       !memcmp(a->px, b->px, sizeof(a->px));
}

void finding_doubt_twins(struct finding *finding)
{
	const struct observations *seen = finding->seen;

	for (int v = 0; v < seen->views; v++) {
		const struct observation *point = seen->point + seen->view[v].first;

		for (int i = 0; i < seen->view[v].count; i++)
			for (int j = 0; j < i; j++) {
				if (!same_observation(&point[j], &point[i]))
					continue;
				verdict_doubt(
					&finding->verdict, "list every point once",
					"%s and %s are one point listed twice, which makes the result look surer than it is",
					point[j].name, point[i].name);
				return;
			}
	}
}
