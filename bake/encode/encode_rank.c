/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_rank.h"

#include <cblas.h>
#include <errno.h>
#include <float.h>
#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/random.h"
#include "hal/basis/basis_layout.h"

/* Directions beyond those wanted, and rounds: the found space then holds the wanted ones. */
#define SPARE 8
#define WIDTH (RANK_MOST + SPARE)
#define ROUNDS 2
#define RIDGE 1e-5 /* of the mean of the diagonal: coarse lights that few others meet */
/* Coefficients and patterns are stored as multiples of this, as their lowest bit is noise, which
 * does not compress. With a coarser unit the search misses the error asked for so often that its
 * results are larger. */
#define UNIT 2

static int coarse_stride(int coarse)
{
	return basis_panels16(coarse) * BASIS_LINE16;
}

/* ---- the metric ---- */

int rank_metric_create(struct rank_metric *metric, const struct encode_settings *settings)
{
	const size_t k = (size_t)settings->coarse;

	*metric = (struct rank_metric){.weight = NULL};
	if (settings->coarse == settings->lights)
		return 0;
	metric->factor = calloc(k * k, sizeof(*metric->factor));
	metric->mean_weight = calloc(k, sizeof(*metric->mean_weight));
	metric->mean_share = calloc((size_t)settings->lights, sizeof(*metric->mean_share));
	return metric->factor && metric->mean_weight && metric->mean_share ? 0 : -ENOMEM;
}

/*
 * Lights that patterns miss have columns, so patterns need not try to reach each of them. But what
 * they come to together is what soft light is made of, and few columns are read where patterns have
 * that: so the weight that lights of a group have lost goes to their mean, by the shares by which a
 * group's column is made (hal/basis/basis_groups.h).
 */
static void find_means(struct rank_metric *metric, const struct encode_settings *settings,
		       const struct part *part)
{
	const struct basis_groups *groups = settings->groups;

	for (int g = 0; g < groups->count; g++) {
		const uint16_t *light = groups->light + groups->first[g];
		const int count = (int)(groups->first[g + 1] - groups->first[g]);
		double lost = 0, shares = 0;

		for (int n = 0; n < count; n++) {
			const int i = light[n];
			const double less = (double)part->weight[i] - (double)metric->weight[i];
			const double share = part->share && less > 0 ? part->share[i] : 0;

			metric->mean_share[i] = (float)share;
			lost += share > 0 ? less : 0;
			shares += share;
		}
		for (int n = 0; n < count && shares > 0; n++)
			metric->mean_share[light[n]] /= (float)shares;
		metric->mean_weight[g] = shares > 0 ? RANK_MEAN_WEIGHT * (float)lost : 0;
	}
}

/* P W P^T gains what the mean of a group's lights does in it. */
static void add_mean(struct rank_metric *metric, const struct encode_settings *settings, int g)
{
	const struct basis_groups *groups = settings->groups;
	const uint16_t *first = groups->light + groups->first[g];
	const uint16_t *end = groups->light + groups->first[g + 1];

	for (const uint16_t *i = first; i < end; i++)
		for (const uint16_t *j = first; j < end; j++) {
			const struct basis_coarse *x = &settings->gather[*i],
						  *y = &settings->gather[*j];
			const float by = metric->mean_weight[g] * metric->mean_share[*i] *
					 metric->mean_share[*j] * 0x1p-30F;

			for (int a = 0; a < 3 && by > 0; a++)
				for (int b = 0; b < 3; b++)
					metric->factor[x->index[a] * (size_t)settings->coarse +
						       y->index[b]] += by * (float)x->weight[a] *
								       (float)y->weight[b];
		}
}

int rank_metric_set(struct rank_metric *metric, const struct encode_settings *settings,
		    const struct part *part, const float *weight)
{
	const size_t k = (size_t)settings->coarse;
	double trace = 0;

	metric->weight = weight;
	metric->pixels = part->pixels;
	for (int p = 0; p < part->pixels; p++)
		metric->root[p] = sqrtf(part->pixel_weight[p]);
	if (!metric->factor)
		return 0;
	memset(metric->factor, 0, k * k * sizeof(*metric->factor));
	for (int i = 0; i < settings->lights; i++) {
		const struct basis_coarse *g = &settings->gather[i];

		for (int a = 0; a < 3; a++)
			for (int b = 0; b < 3; b++)
				metric->factor[g->index[a] * k + g->index[b]] +=
					weight[i] * (float)g->weight[a] * (float)g->weight[b] *
					0x1p-30F;
	}
	find_means(metric, settings, part);
	for (int g = 0; g < settings->groups->count; g++)
		if (metric->mean_weight[g] > 0)
			add_mean(metric, settings, g);
	for (size_t a = 0; a < k; a++)
		trace += (double)metric->factor[a * k + a];
	for (size_t a = 0; a < k; a++)
		metric->factor[a * k + a] += (float)(RIDGE * trace / (double)k);
	return LAPACKE_spotrf(LAPACK_ROW_MAJOR, 'L', (int)k, metric->factor, (int)k) == 0 ? 0
											  : -EDOM;
}

void rank_metric_free(struct rank_metric *metric)
{
	free(metric->factor);
	free(metric->mean_weight);
	free(metric->mean_share);
	*metric = (struct rank_metric){0};
}

/* ---- room ---- */

int rank_patterns_create(struct rank_patterns *p, const struct encode_settings *settings)
{
	const size_t n = (size_t)settings->lights;

	*p = (struct rank_patterns){.stride = coarse_stride(settings->coarse)};
	p->at_light = calloc(RANK_MOST * n, sizeof(*p->at_light));
	p->coefficient = calloc(RANK_MOST * PART_ROWS, sizeof(*p->coefficient));
	p->pattern = calloc(RANK_MOST * (size_t)p->stride, sizeof(*p->pattern));
	p->stored = calloc(RANK_MOST * PART_ROWS, sizeof(*p->stored));
	return p->at_light && p->coefficient && p->pattern && p->stored ? 0 : -ENOMEM;
}

void rank_patterns_free(struct rank_patterns *p)
{
	free(p->at_light);
	free(p->coefficient);
	free(p->pattern);
	free(p->stored);
	*p = (struct rank_patterns){0};
}

int rank_scratch_create(struct rank_scratch *s, const struct encode_settings *settings)
{
	const size_t k = (size_t)settings->coarse;
	const size_t longest = k > PART_ROWS ? k : PART_ROWS;

	s->coarse = calloc(k * PART_ROWS, sizeof(*s->coarse));
	s->left = calloc(longest * WIDTH, sizeof(*s->left));
	s->right = calloc(longest * WIDTH, sizeof(*s->right));
	s->mixed = calloc(longest * WIDTH, sizeof(*s->mixed));
	return s->coarse && s->left && s->right && s->mixed ? 0 : -ENOMEM;
}

void rank_scratch_free(struct rank_scratch *s)
{
	free(s->coarse);
	free(s->left);
	free(s->right);
	free(s->mixed);
	*s = (struct rank_scratch){0};
}

/* ---- finding ---- */

/* to[row] = or += by * from[row], as much as the row's pixel counts. */
static void take_rows(const struct rank_metric *metric, float by, const float *from, float *to,
		      int rows, bool add)
{
	for (int first = 0; first < rows; first += metric->pixels)
		for (int p = 0; p < metric->pixels; p++) {
			const float is = by * metric->root[p] * from[first + p];

			to[first + p] = add ? to[first + p] + is : is;
		}
}

static void project_mean(const struct encode_settings *settings, const struct rank_metric *metric,
			 int g, const float *value, float *coarse, int rows)
{
	const struct basis_groups *groups = settings->groups;
	float mean[PART_ROWS] = {0};

	for (uint32_t n = groups->first[g]; n < groups->first[g + 1]; n++) {
		const float *from = value + (size_t)groups->light[n] * (size_t)rows;
		const float share = metric->mean_share[groups->light[n]];

		for (int r = 0; r < rows && share > 0; r++)
			mean[r] += share * from[r];
	}
	for (uint32_t n = groups->first[g]; n < groups->first[g + 1]; n++) {
		const struct basis_coarse *gather = &settings->gather[groups->light[n]];
		const float by = metric->mean_weight[g] * metric->mean_share[groups->light[n]];

		for (int a = 0; a < 3; a++)
			if (by * (float)gather->weight[a] > 0)
				take_rows(metric, by * (float)gather->weight[a] * 0x1p-15F, mean,
					  coarse + (size_t)gather->index[a] * (size_t)rows, rows,
					  true);
	}
}

/* Columns over the coarse lights in which a sum of squares is the weighted sum of squared errors.
 */
static void rank_project(const struct encode_settings *settings, const struct rank_metric *metric,
			 const float *value, float *coarse, int rows)
{
	if (metric->factor)
		memset(coarse, 0, (size_t)settings->coarse * (size_t)rows * sizeof(*coarse));
	for (int i = 0; i < settings->lights; i++) {
		const float *from = value + (size_t)i * (size_t)rows;

		if (!metric->factor)
			take_rows(metric, sqrtf(metric->weight[i]), from,
				  coarse + (size_t)i * (size_t)rows, rows, false);
		for (int a = 0; metric->factor && a < 3; a++) {
			const struct basis_coarse *g = &settings->gather[i];
			const float w = metric->weight[i] * (float)g->weight[a] * 0x1p-15F;

			if (w > 0)
				take_rows(metric, w, from,
					  coarse + (size_t)g->index[a] * (size_t)rows, rows, true);
		}
	}
	for (int g = 0; metric->factor && g < settings->groups->count; g++)
		if (metric->mean_weight[g] > 0)
			project_mean(settings, metric, g, value, coarse, rows);
	if (metric->factor)
		cblas_strsm(CblasRowMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit,
			    settings->coarse, rows, 1, metric->factor, settings->coarse, coarse,
			    rows);
}

/* So that squares neither overflow nor vanish. */
static float rank_normalise(float *value, size_t count)
{
	float most = 0;

	for (size_t k = 0; k < count; k++)
		most = fabsf(value[k]) > most ? fabsf(value[k]) : most;
	if (!(most >= FLT_MIN))
		return 0;
	for (size_t k = 0; k < count; k++)
		value[k] /= most;
	return most;
}

static void rank_orthonormalise(float *columns, int length, int count)
{
	float tau[WIDTH];

	LAPACKE_sgeqrf(LAPACK_COL_MAJOR, length, count, columns, length, tau);
	LAPACKE_sorgqr(LAPACK_COL_MAJOR, length, count, count, columns, length, tau);
}

/*
 * Subspace iteration (Halko, Martinsson and Tropp 2011, algorithm 4.4): left [count][K] becomes an
 * orthonormal basis of what the matrix mostly is, right [count][rows] the matrix in it.
 */
static void rank_iterate(struct rank_scratch *s, int k, int rows, int count)
{
	struct random random = {random_hash(0x7061747465726e73, (uint64_t)k, (uint64_t)rows)};

	for (int i = 0; i < count * rows; i++)
		s->right[i] = random_next(&random) - 0.5F;
	for (int round = 0; round < ROUNDS; round++) {
		rank_orthonormalise(s->right, rows, count);
		cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, k, count, rows, 1, s->coarse,
			    rows, s->right, rows, 0, s->left, k);
		rank_orthonormalise(s->left, k, count);
		cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, rows, count, k, 1, s->coarse,
			    rows, s->left, k, 0, s->right, rows);
	}
}

/* Turns both sides so that the strongest come first. */
static void sort_out(struct rank_scratch *s, int k, int rows, int count)
{
	float gram[WIDTH * WIDTH], size[WIDTH], turned[WIDTH * WIDTH];

	cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, count, count, rows, 1, s->right, rows,
		    s->right, rows, 0, gram, count);
	if (LAPACKE_ssyev(LAPACK_COL_MAJOR, 'V', 'U', count, gram, count, size) != 0)
		return;
	for (int j = 0; j < count; j++)
		memcpy(turned + j * count, gram + (count - 1 - j) * count,
		       (size_t)count * sizeof(*gram));
	cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, rows, count, count, 1, s->right,
		    rows, turned, count, 0, s->mixed, rows);
	memcpy(s->right, s->mixed, (size_t)rows * (size_t)count * sizeof(*s->right));
	cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, k, count, count, 1, s->left, k,
		    turned, count, 0, s->mixed, k);
	memcpy(s->left, s->mixed, (size_t)k * (size_t)count * sizeof(*s->left));
}

/* As multiples of UNIT; returns what 1 stands for. */
static double rank_store(const float *from, int count, int16_t *to)
{
	double most = 0, step;

	for (int k = 0; k < count; k++)
		most = fmax(most, fabs((double)from[k]));
	step = most / (32767 / UNIT * UNIT);
	for (int k = 0; k < count; k++)
		to[k] = step > 0 ? (int16_t)(lrint((double)from[k] / step / UNIT) * UNIT) : 0;
	return step;
}

/* False when it is nothing, or more than the format allows. */
static bool rank_quantise(struct rank_patterns *p, const struct encode_settings *settings, int j,
			  const float *coefficient, const float *pattern, double size)
{
	int16_t *rows = p->stored + (size_t)j * PART_ROWS;
	int16_t *lights = p->pattern + (size_t)j * (size_t)p->stride;
	float *at = p->at_light + (size_t)j * (size_t)settings->lights;
	const double row_step = rank_store(coefficient, p->rows, rows) * size;
	const double light_step = rank_store(pattern, settings->coarse, lights);
	const double step = row_step * light_step;
	double sum = 0;

	for (int k = 0; k < settings->coarse; k++)
		sum += abs(lights[k]);
	if (!(step >= (double)FLT_MIN) || step * 32767 * sum > 0.99 * BASIS_VALUE_MAX)
		return false;
	p->scale[j] = (float)step;
	for (int r = 0; r < p->rows; r++)
		p->coefficient[(size_t)j * (size_t)p->rows + (size_t)r] =
			(float)(row_step * rows[r]);
	for (int i = 0; i < settings->lights; i++) {
		const struct basis_coarse *g = &settings->gather[i];
		double y = 0;

		for (int a = 0; settings->gather && a < 3; a++)
			y += lights[g->index[a]] * (double)g->weight[a] / BASIS_COARSE_ONE;
		at[i] = (float)(light_step * (settings->gather ? y : lights[i]));
	}
	return true;
}

/* Back from where a sum of squares was the weighted one. */
static void rank_unweigh(const struct rank_metric *metric, struct rank_scratch *s, int k, int rows,
			 int count)
{
	if (metric->factor)
		cblas_strsm(CblasColMajor, CblasLeft, CblasUpper, CblasNoTrans, CblasNonUnit, k,
			    count, 1, metric->factor, k, s->left, k);
	for (int j = 0; j < count; j++) {
		float *pattern = s->left + (size_t)j * (size_t)k;
		float *row = s->right + (size_t)j * (size_t)rows;

		for (int i = 0; !metric->factor && i < k; i++)
			pattern[i] /= sqrtf(metric->weight[i]);
		for (int r = 0; r < rows; r++)
			row[r] /= metric->root[r % metric->pixels];
	}
}

void rank_find(struct rank_patterns *p, const struct encode_settings *settings,
	       const struct rank_metric *metric, struct rank_scratch *s, const float *value,
	       int rows, int most)
{
	const int k = settings->coarse;
	const int shortest = k < rows ? k : rows;
	const int count = shortest < most + SPARE ? shortest : most + SPARE;
	float size;

	p->count = 0;
	p->rows = rows;
	rank_project(settings, metric, value, s->coarse, rows);
	size = rank_normalise(s->coarse, (size_t)k * (size_t)rows);
	if (!(size > 0))
		return;
	rank_iterate(s, k, rows, count);
	sort_out(s, k, rows, count);
	rank_unweigh(metric, s, k, rows, count);
	while (p->count < count && p->count < most &&
	       rank_quantise(p, settings, p->count, s->right + (size_t)p->count * (size_t)rows,
			     s->left + (size_t)p->count * (size_t)k, (double)size))
		p->count++;
}
