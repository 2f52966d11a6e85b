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

/* Subspace iteration finds SPARE directions more than are wanted, in ROUNDS rounds, so that the
 * space found holds the wanted ones. Halko, Martinsson and Tropp 2011 recommend 5 to 10 and 1 to 2
 * (README.md, "Constants", for what half of them costs). */
#define SPARE 8
#define WIDTH (RANK_MOST + SPARE)
#define ROUNDS 2
/* A column is linearly dependent on earlier ones if less than this share of its squared length
 * remains: the columns are of single precision, whose roundings squared are 2^-48 = 4e-15 a
 * term. */
#define LEAST_REST 1e-10
/* Ridge relative to the mean diagonal. It keeps P W P^T positive definite where a coarse light
 * gathers few lights. */
#define RIDGE 1e-5
/* Coefficients and patterns are stored as multiples of this, as their lowest bit is noise, which
 * does not compress. A coarser unit misses the error asked for so often that files become larger
 * (README.md, "Tried and left out"). */
#define UNIT 2

static int coarse_stride(int coarse)
{
	return basis_panels16(coarse) * BASIS_LINE16;
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

int rank_finder_create(struct rank_finder *f, const struct encode_settings *settings)
{
	const size_t k = (size_t)settings->coarse;
	const size_t longest = k > PART_ROWS ? k : PART_ROWS;
	const bool gathers = settings->coarse < settings->lights;

	*f = (struct rank_finder){.settings = settings};
	if (gathers)
		f->factor = calloc(k * k, sizeof(*f->factor));
	f->coarse = calloc(k * PART_ROWS, sizeof(*f->coarse));
	f->left = calloc(longest * WIDTH, sizeof(*f->left));
	f->right = calloc(longest * WIDTH, sizeof(*f->right));
	f->mixed = calloc(longest * WIDTH, sizeof(*f->mixed));
	return (f->factor || !gathers) && f->coarse && f->left && f->right && f->mixed ? 0
										       : -ENOMEM;
}

void rank_finder_free(struct rank_finder *f)
{
	free(f->factor);
	free(f->coarse);
	free(f->left);
	free(f->right);
	free(f->mixed);
	*f = (struct rank_finder){0};
}

/* ---- finding ---- */

/* Computes the Cholesky factor of P W P^T. P is stored in units of 2^-15, so that a product of two
 * has 2^-30. */
int rank_weigh(struct rank_finder *f, const struct part *part)
{
	const struct encode_settings *settings = f->settings;
	const size_t k = (size_t)settings->coarse;
	double trace = 0;

	f->part = part;
	for (int p = 0; p < part->pixels; p++)
		f->root[p] = sqrtf(part->limit.pixel_weight[p]);
	if (!f->factor)
		return 0;
	memset(f->factor, 0, k * k * sizeof(*f->factor));
	for (int i = 0; i < settings->lights; i++) {
		const struct basis_coarse *g = &settings->gather[i];

		for (int a = 0; a < 3; a++)
			for (int b = 0; b < 3; b++)
				f->factor[g->index[a] * k + g->index[b]] +=
					part->limit.weight[i] * (float)g->weight[a] *
					(float)g->weight[b] * 0x1p-30F;
	}
	for (size_t a = 0; a < k; a++)
		trace += (double)f->factor[a * k + a];
	for (size_t a = 0; a < k; a++)
		f->factor[a * k + a] += (float)(RIDGE * trace / (double)k);
	return LAPACKE_spotrf(LAPACK_ROW_MAJOR, 'L', (int)k, f->factor, (int)k) == 0 ? 0 : -EDOM;
}

/* to[row] += by * sqrt(h) * from[row], with h the weight of the row's pixel. */
static void add_rows(const struct rank_finder *f, float by, const float *from, float *to, int rows)
{
	for (int first = 0; first < rows; first += f->part->pixels)
		for (int p = 0; p < f->part->pixels; p++)
			to[first + p] += by * f->root[p] * from[first + p];
}

/* Computes Z = L^-1 P W A^T H^(1/2), A^T = value: a sum of squares of Z is the weighted sum of
 * squared errors. */
static void rank_project(struct rank_finder *f, const float *value, int rows)
{
	const struct encode_settings *settings = f->settings;

	memset(f->coarse, 0, (size_t)settings->coarse * (size_t)rows * sizeof(*f->coarse));
	for (int i = 0; i < settings->lights; i++) {
		const float *from = value + (size_t)i * (size_t)rows;
		const float weight = f->part->limit.weight[i];

		if (!f->factor)
			add_rows(f, sqrtf(weight), from, f->coarse + (size_t)i * (size_t)rows,
				 rows);
		for (int a = 0; f->factor && a < 3; a++) {
			const struct basis_coarse *g = &settings->gather[i];

			if (g->weight[a])
				add_rows(f, weight * (float)g->weight[a] * 0x1p-15F, from,
					 f->coarse + (size_t)g->index[a] * (size_t)rows, rows);
		}
	}
	if (f->factor)
		cblas_strsm(CblasRowMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit,
			    settings->coarse, rows, 1, f->factor, settings->coarse, f->coarse,
			    rows);
}

/* Divides by the largest magnitude, so that squares neither overflow nor vanish. Returns it, or 0
 * if it is 0. */
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

/* Replaces the columns A by orthonormal ones of the same span: Q = A L^-T with the Cholesky factor
 * L L^T = A^T A. L is in double precision, as squares need twice the digits. A column that depends
 * on earlier ones up to rounding becomes 0. */
static void rank_orthonormalise(float *columns, int length, int count)
{
	double factor[WIDTH][WIDTH];

	for (int a = 0; a < count; a++)
		for (int b = 0; b <= a; b++)
			factor[a][b] = cblas_dsdot(length, columns + a * length, 1,
						   columns + b * length, 1);
	for (int a = 0; a < count; a++) {
		float *own = columns + a * length;
		double rest = factor[a][a];

		for (int b = 0; b < a; b++) {
			for (int k = 0; k < b; k++)
				factor[a][b] -= factor[a][k] * factor[b][k];
			factor[a][b] *= factor[b][b];
			rest -= factor[a][b] * factor[a][b];
			for (int k = 0; k < length; k++)
				own[k] -= (float)factor[a][b] * columns[b * length + k];
		}
		/* The diagonal is stored inverted. */
		factor[a][a] = rest > LEAST_REST * factor[a][a] ? 1 / sqrt(rest) : 0;
		for (int k = 0; k < length; k++)
			own[k] *= (float)factor[a][a];
	}
}

/*
 * Subspace iteration (Halko, Martinsson and Tropp 2011, algorithm 4.4) on Z = coarse: left
 * [count][K] becomes an orthonormal basis Q of Z's dominant column space, right [count][rows] = Z^T
 * Q.
 */
static void rank_iterate(struct rank_finder *s, int k, int rows, int count)
{
	struct random random = {random_hash(0x7061747465726e73, (uint64_t)k, (uint64_t)rows)};

	for (int i = 0; i < count * rows; i++)
		s->right[i] = random_next(&random) - 0.5F;
	for (int round = 0; round < ROUNDS; round++) {
		/* The first round has random numbers, which are nearly orthogonal. */
		if (round)
			rank_orthonormalise(s->right, rows, count);
		cblas_sgemm(CblasColMajor, CblasTrans, CblasNoTrans, k, count, rows, 1, s->coarse,
			    rows, s->right, rows, 0, s->left, k);
		rank_orthonormalise(s->left, k, count);
		cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, rows, count, k, 1, s->coarse,
			    rows, s->left, k, 0, s->right, rows);
	}
}

/* Rotates both sides to the singular vectors, in order of falling singular value: the eigenvectors
 * of right right^T. */
static void rank_sort(struct rank_finder *s, int k, int rows, int count)
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

/* Rounds values to multiples of UNIT in 16 bits. Returns the value that the integer 1 stands
 * for. */
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

/* Quantises pattern j and its coefficients. Returns false if they are 0, or larger than the format
 * allows. */
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

/* Undoes rank_project(): pattern = L^-T left, row = H^(-1/2) right. */
static void rank_unweigh(struct rank_finder *f, int rows, int count)
{
	const int k = f->settings->coarse;

	if (f->factor)
		cblas_strsm(CblasColMajor, CblasLeft, CblasUpper, CblasNoTrans, CblasNonUnit, k,
			    count, 1, f->factor, k, f->left, k);
	for (int j = 0; j < count; j++) {
		float *pattern = f->left + (size_t)j * (size_t)k;
		float *row = f->right + (size_t)j * (size_t)rows;

		for (int i = 0; !f->factor && i < k; i++)
			pattern[i] /= sqrtf(f->part->limit.weight[i]);
		for (int r = 0; r < rows; r++)
			row[r] /= f->root[r % f->part->pixels];
	}
}

void rank_find(struct rank_patterns *p, struct rank_finder *f, const float *value, int rows,
	       int most)
{
	const int k = f->settings->coarse, shortest = k < rows ? k : rows;
	const int count = shortest < most + SPARE ? shortest : most + SPARE;
	float size;

	p->count = 0;
	p->rows = rows;
	rank_project(f, value, rows);
	size = rank_normalise(f->coarse, (size_t)k * (size_t)rows);
	if (!(size > 0))
		return;
	rank_iterate(f, k, rows, count);
	rank_sort(f, k, rows, count);
	rank_unweigh(f, rows, count);
	while (p->count < count && p->count < most &&
	       rank_quantise(p, f->settings, p->count, f->right + (size_t)p->count * (size_t)rows,
			     f->left + (size_t)p->count * (size_t)k, (double)size))
		p->count++;
}
