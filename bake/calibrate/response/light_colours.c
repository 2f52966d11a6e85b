/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_colours.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bake/calibrate/estimate/least_squares.h"
#include "hal/base/number.h"
#include "hal/base/text_file.h"

#define ELEMENTS 9

struct match {
	const struct light_colour_pair *pairs;
	int count;
	double scale;
};

static double sum_of_row(const double x[3])
{
	return x[0] + x[1] + x[2];
}

static double relative_difference(const struct match *m, const double matrix[ELEMENTS], int patch,
				  int c)
{
	const struct light_colour_pair *p = &m->pairs[patch];
	double made = 0;

	for (int k = 0; k < 3; k++)
		made += m->scale * matrix[3 * c + k] * p->fisheye[k];
	return (made - p->background[c]) / (sum_of_row(p->background) / 3);
}

static bool colours_evaluate(void *context, const double *x, double *residual)
{
	const struct match *m = context;

	for (int i = 0; i < 3 * m->count; i++)
		residual[i] = relative_difference(m, x, i / 3, i % 3);
	return true;
}

static void take_elements(struct light_colours *found)
{
	static const char *const names[] = {"red", "green", "blue"};

	for (int e = 0; e < ELEMENTS; e++) {
		struct parameter *p = &found->estimate.parameter[e];

		snprintf(p->name, sizeof(p->name), "%s from %s", names[e / 3], names[e % 3]);
		p->value = found->matrix[e];
	}
}

/* Scales the matrix so that grey keeps its brightness, and moves the factor to scale. */
static void normalize_rows(struct light_colours *found)
{
	double sum = 0;

	for (int e = 0; e < ELEMENTS; e++)
		sum += found->matrix[e] / 3;
	found->scale *= sum;
	for (int e = 0; e < ELEMENTS; e++)
		found->matrix[e] /= sum;
	for (int k = 0; k < ELEMENTS * ELEMENTS; k++)
		found->estimate.covariance[k] /= sum * sum;
}

static int colours_solve(struct light_colours *found, struct match *m, struct fault *fault)
{
	double x[ELEMENTS] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, scale[ELEMENTS];
	struct least_squares_fit fit = {.covariance = NULL};
	const struct least_squares problem = {.parameters = ELEMENTS,
					      .residuals = 3 * m->count,
					      .evaluate = colours_evaluate,
					      .context = m,
					      .scale = scale,
					      .group = 3};
	int err;

	for (int k = 0; k < ELEMENTS; k++)
		scale[k] = 1;
	err = least_squares_solve(&problem, x, &fit, fault);
	if (err == -ERANGE)
		found->condition = INFINITY;
	else if (err == 0)
		found->condition = fit.condition;
	if (err == 0 || err == -ERANGE) {
		memcpy(found->matrix, x, sizeof(x));
		if (err == 0)
			memcpy(found->estimate.covariance, fit.covariance,
			       ELEMENTS * ELEMENTS * sizeof(*fit.covariance));
		found->estimate.residuals = 3 * m->count;
		found->estimate.freedom = 3 * m->count - ELEMENTS;
		found->estimate.sigma = fit.sigma;
		err = 0;
	}
	least_squares_free(&fit);
	return err;
}

static void colours_compare(struct light_colours *found, const struct match *m)
{
	static const double identity[ELEMENTS] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
	struct match now = *m;

	now.scale = found->scale;
	for (int k = 0; k < m->count; k++) {
		double squares = 0;

		for (int c = 0; c < 3; c++) {
			found->before += pow(relative_difference(&now, identity, k, c), 2);
			squares += pow(relative_difference(&now, found->matrix, k, c), 2);
		}
		found->after += squares;
		found->residual[k] = sqrt(squares / 3);
	}
	found->before = sqrt(found->before / (3 * m->count));
	found->after = sqrt(found->after / (3 * m->count));
}

static void doubt_colours(struct light_colours *found)
{
	double worst = 0;

	for (int e = 0; e < ELEMENTS; e++)
		worst = fmax(worst, estimate_deviation(&found->estimate, e));
	if (!(found->condition < 1e8))
		verdict_doubt(
			&found->verdict, "show red, green, blue and yellow too",
			"the patches are all grey, or of few colours: the matrix cannot be told from them");
	if (found->patches < 4)
		verdict_doubt(&found->verdict, "show six patches of different colours or more",
			      "so few patches fit any matrix");
	if (worst > 0.1)
		verdict_doubt(&found->verdict, "show more patches, and brighter colours",
			      "the matrix is known to %.2f only", worst);
	if (found->after > 0.1)
		verdict_doubt(
			&found->verdict,
			"see whether the patches are the same ones, in the same order and light",
			"no matrix fits: patches are off by %.0f %%", 100 * found->after);
}

int light_colours_find(struct light_colours *found, const struct light_colour_pair *pairs,
		       int count, struct fault *fault)
{
	struct match m = {.pairs = pairs, .count = count};
	double from = 0, to = 0;
	int err;

	*found = (struct light_colours){.patches = count};
	verdict_begin(&found->verdict);
	if (count < 3 || count > LIGHT_PATCHES_MAX)
		return fault_say(fault, -EINVAL, "there are %d patches, expected 3 to %d", count,
				 LIGHT_PATCHES_MAX);
	for (int k = 0; k < count; k++) {
		if (!(sum_of_row(pairs[k].fisheye) > 0) || !(sum_of_row(pairs[k].background) > 0))
			return fault_say(fault, -EINVAL, "patch %d is black", k + 1);
		from += sum_of_row(pairs[k].fisheye) / sum_of_row(pairs[k].background);
		to += 1;
	}
	m.scale = found->scale = to / from;
	if (estimate_create(&found->estimate, ELEMENTS) < 0)
		return fault_say(fault, -ENOMEM, "not enough memory");
	err = colours_solve(found, &m, fault);
	if (err)
		return err;
	normalize_rows(found);
	take_elements(found);
	colours_compare(found, &m);
	doubt_colours(found);
	return 0;
}

void light_colours_free(struct light_colours *found)
{
	estimate_free(&found->estimate);
}

/* Reads six numbers, or none on a blank line. Returns how many; -1: neither. */
static int read_patch_line(const char *line, double number[6])
{
	int count = 0;

	for (;;) {
		line += strspn(line, " \t\r,");
		if (!*line || *line == '#')
			return count == 0 || count == 6 ? count : -1;
		if (count == 6 || number_read(&line, &number[count]) || !(number[count] >= 0))
			return -1;
		count++;
	}
}

static int read_pairs(struct text_file *file, struct light_colour_pair *pairs, struct fault *fault)
{
	int count = 0, ret;

	while ((ret = text_file_next(file, fault)) > 0) {
		double number[6];
		const int got = read_patch_line(file->line, number);

		if (got < 0)
			return fault_say(
				fault, -EINVAL,
				"%s:%d: expected six numbers of at least 0: r g b of the fisheye, r g b of the background, linear",
				file->path, file->number);
		if (!got)
			continue;
		if (count == LIGHT_PATCHES_MAX)
			return fault_say(fault, -EINVAL,
					 "%s:%d: one patch too many, expected at most %d",
					 file->path, file->number, LIGHT_PATCHES_MAX);
		memcpy(pairs[count].fisheye, number, 3 * sizeof(*number));
		memcpy(pairs[count++].background, number + 3, 3 * sizeof(*number));
	}
	return ret < 0 ? ret : count;
}

int light_colours_read(const char *path, struct light_colour_pair pairs[LIGHT_PATCHES_MAX],
		       struct fault *fault)
{
	struct text_file file;
	int ret = text_file_open(&file, path, fault);

	if (ret < 0)
		return ret;
	ret = read_pairs(&file, pairs, fault);
	text_file_close(&file);
	return ret;
}
