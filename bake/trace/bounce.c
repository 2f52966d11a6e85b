/* SPDX-License-Identifier: MIT */
#include "bake/trace/bounce.h"

#include <cblas.h>
#include <errno.h>
#include <lapacke.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/blas.h"
#include "bake/base/random.h"

#define RANK_FEW 16 /* this rank is tried first; more is seldom needed */
/* Subspace iteration finds RANK_SPARE vectors more than are wanted, in ITERATIONS rounds; Halko,
 * Martinsson and Tropp 2011 recommend 5 to 10 and 1 to 2. */
#define RANK_SPARE 4
#define ITERATIONS 2
/* A singular vector is noise if the other half confirms less than this share of it. With R rows and
 * C columns the cosine of pure noise is about 1 / (sqrt(R) + sqrt(C)): 0.017 with 768 and 1,000. */
#define WEIGHT_LEAST 0.05

/* Truncated singular value decomposition: X ~ sum over k of value[k] left[k] right[k]^T. */
struct bounce_factors {
	float *left;  /* [rank][rows] */
	float *right; /* [rank][lights] */
	float *value; /* [rank] */
};

/* The memory of struct bounce, divided into arrays. */
struct bounce_scratch {
	int rows, lights, rank;
	float *start; /* [rank][lights]: random, for subspace iteration */
	struct bounce_factors of[2];
	float *left, *right;	   /* as in struct bounce_factors */
	float *tau;		   /* [rank] */
	float *core, *turn, *back; /* [rank][rank] */
	struct bounce_aside aside;
};

static size_t floats_needed(size_t lights)
{
	const size_t k = BOUNCE_RANK_MAX;

	return 4 * k * lights + 3 * k * BOUNCE_ROWS_MAX + 3 * k + 3 * k * k +
	       bounce_aside_floats(lights);
}

static struct bounce_scratch scratch_deal(const struct bounce *bounce)
{
	const size_t k = BOUNCE_RANK_MAX, lights = (size_t)bounce->lights;
	struct bounce_scratch s = {.lights = bounce->lights};
	float *next = bounce->memory;

	s.start = next;
	next += k * lights;
	for (int half = 0; half < 2; half++) {
		s.of[half].left = next;
		next += k * BOUNCE_ROWS_MAX;
		s.of[half].right = next;
		next += k * lights;
		s.of[half].value = next;
		next += k;
	}
	s.left = next;
	next += k * BOUNCE_ROWS_MAX;
	s.right = next;
	next += k * lights;
	s.tau = next;
	next += k;
	s.core = next;
	s.turn = s.core + k * k;
	s.back = s.turn + k * k;
	bounce_aside_open(&s.aside, lights, s.back + k * k);
	return s;
}

int bounce_create(struct bounce *bounce, int lights)
{
	const size_t floats = (size_t)BOUNCE_RANK_MAX * (size_t)lights;

	bounce->lights = lights;
	bounce->memory = malloc(floats_needed((size_t)lights) * sizeof(float));
	if (!bounce->memory)
		return -ENOMEM;
	for (size_t i = 0; i < floats; i++)
		bounce->memory[i] = random_unit((uint32_t)random_hash(i, 0xb0ce, 0)) - 0.5f;
	blas_setup();
	return 0;
}

void bounce_free(struct bounce *bounce)
{
	free(bounce->memory);
	bounce->memory = NULL;
}

/* ---- leading singular vectors ---- */

/* Makes the columns of a column-major matrix orthonormal (QR). upper becomes R, unless it is NULL.
 * Returns 0 or LAPACK's error. */
static int orthonormalise_columns(struct bounce_scratch *s, float *columns, int length,
				  float *upper)
{
	const int k = s->rank;
	int info = LAPACKE_sgeqrf(LAPACK_COL_MAJOR, length, k, columns, length, s->tau);

	if (info)
		return info;
	for (int column = 0; upper && column < k; column++)
		for (int row = 0; row < k; row++)
			upper[column * k + row] =
				row <= column
					? columns[(size_t)column * (size_t)length + (size_t)row]
					: 0;
	return LAPACKE_sorgqr(LAPACK_COL_MAJOR, length, k, k, columns, length, s->tau);
}

/* left = X right */
static void times_rows(const struct bounce_scratch *s, const float *x, const float *right,
		       float *left)
{
	cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, s->rank, s->rows, s->lights, 1, right,
		    s->lights, x, s->lights, 0, left, s->rows);
}

/* right = X^T left */
static void times_columns(const struct bounce_scratch *s, const float *x, const float *left,
			  float *right)
{
	cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, s->rank, s->lights, s->rows, 1, left,
		    s->rows, x, s->lights, 0, right, s->lights);
}

/* Decomposes X by subspace iteration from random vectors (Halko, Martinsson and Tropp 2011).
 * Returns 0 or LAPACK's error. */
static int bounce_factorise(struct bounce_scratch *s, const float *x, struct bounce_factors *out)
{
	const int k = s->rank;
	int info;

	times_rows(s, x, s->start, s->left);
	info = orthonormalise_columns(s, s->left, s->rows, NULL);
	for (int pass = 0; pass < ITERATIONS && !info; pass++) {
		times_columns(s, x, s->left, s->right);
		times_rows(s, x, s->right, s->left);
		info = orthonormalise_columns(s, s->left, s->rows, NULL);
	}
	if (info)
		return info;
	times_columns(s, x, s->left, s->right);
	info = orthonormalise_columns(s, s->right, s->lights, s->core);
	if (!info)
		info = LAPACKE_sgesdd(LAPACK_COL_MAJOR, 'A', k, k, s->core, k, out->value, s->turn,
				      k, s->back, k);
	if (info)
		return info;
	cblas_sgemm(CblasColMajor, CblasNoTrans, CblasTrans, s->rows, k, k, 1, s->left, s->rows,
		    s->back, k, 0, out->left, s->rows);
	cblas_sgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, s->lights, k, k, 1, s->right,
		    s->lights, s->turn, k, 0, out->right, s->lights);
	return 0;
}

/* ---- comparing the halves ---- */

/* The filter's weights, and the correlations that they come from. */
struct bounce_verdict {
	int kept;
	double weight[BOUNCE_RANK_MAX];	  /* weights of a half's singular vectors; falling */
	double found[2][BOUNCE_RANK_MAX]; /* left^T X right, where X is the other half */
};

/* weight[k] = (found[0][k] + found[1][k]) / (value of half 0 + value of half 1), never rising */
static void find_weights(struct bounce_scratch *s, float *const half[2], struct bounce_verdict *v)
{
	const size_t lights = (size_t)s->lights;
	double limit = 1;

	for (int h = 0; h < 2; h++) {
		times_columns(s, half[!h], s->of[h].left, s->right);
		for (size_t k = 0; k < (size_t)s->rank; k++)
			v->found[h][k] = bounce_dot(s->right + k * lights,
						    s->of[h].right + k * lights, lights);
	}
	v->kept = 0;
	for (int k = 0; k < s->rank; k++) {
		const double own = (double)s->of[0].value[k] + (double)s->of[1].value[k];

		limit = own > 0 ? fmin(limit, (v->found[0][k] + v->found[1][k]) / own) : 0;
		if (limit < WEIGHT_LEAST)
			break;
		v->weight[v->kept++] = limit;
	}
}

/* Returns the inner product <A', B'> of the filtered halves. */
static double filtered_dot(const struct bounce_scratch *s, const struct bounce_verdict *v)
{
	const size_t lights = (size_t)s->lights, rows = (size_t)s->rows;
	double sum = 0;

	for (size_t j = 0; j < (size_t)v->kept; j++)
		for (size_t k = 0; k < (size_t)v->kept; k++)
			sum += v->weight[j] * (double)s->of[0].value[j] * v->weight[k] *
			       (double)s->of[1].value[k] *
			       bounce_dot(s->of[0].left + j * rows, s->of[1].left + k * rows,
					  rows) *
			       bounce_dot(s->of[0].right + j * lights, s->of[1].right + k * lights,
					  lights);
	return sum;
}

/*
 * Estimates the squared error of the filtered mean of halves A and B, whose filtered forms are A'
 * and B'. `aside` is the squared error of the sums and planes that were set aside.
 *     light lost = <A - A', B - B'>, as the noise of the halves is independent
 *     noise kept = |A' - B'|^2 / 4
 */
static double filtered_error(const struct bounce_scratch *s, float *const half[2],
			     const struct bounce_verdict *v, double aside)
{
	const size_t count = (size_t)s->rows * (size_t)s->lights;
	const double shared = filtered_dot(s, v);
	double lost = bounce_dot(half[0], half[1], count) + shared, difference = -2 * shared;

	for (int k = 0; k < v->kept; k++)
		for (int h = 0; h < 2; h++) {
			const double value = v->weight[k] * (double)s->of[h].value[k];

			lost -= value * v->found[h][k];
			difference += value * value;
		}
	return fmax(lost, 0) + difference / 4 + aside;
}

/* Decomposes both halves and sets the verdict. Returns 0 or LAPACK's error. */
static int bounce_judge(struct bounce_scratch *s, float *const half[2], struct bounce_verdict *v)
{
	const int most = s->rows < s->lights ? s->rows : s->lights;
	static const int ranks[] = {RANK_FEW, BOUNCE_RANK_MAX};

	for (int k = 0; k < 2; k++) {
		s->rank = ranks[k] < most ? ranks[k] : most;
		for (int h = 0; h < 2; h++) {
			const int info = bounce_factorise(s, half[h], &s->of[h]);

			if (info)
				return info;
		}
		find_weights(s, half, v);
		if (s->rank == most || v->kept <= s->rank - RANK_SPARE)
			break;
	}
	return 0;
}

/* ---- the filter ---- */

/* Sets half[0] to the mean, half[1] to its noise. */
static void set_mean(const struct bounce_halves *in, size_t lights)
{
	const float share[2] = {(float)in->share[0], (float)in->share[1]};
	const float noise_scale = (float)sqrt(in->share[0] * in->share[1]);

	for (size_t i = 0; i < (size_t)in->rows * lights; i++) {
		const float a = in->half[0][i], b = in->half[1][i];

		in->half[0][i] = share[0] * a + share[1] * b;
		in->half[1][i] = noise_scale * (a - b);
	}
}

/* Returns the weight of a singular vector in the mean of both halves. If r is the share of light in
 * the vector of one half, it is 2 r / (1 + r) in that of the mean (Spearman 1910, Brown 1910). */
static float weight_of_mean(const struct bounce_verdict *v, int k)
{
	return (float)(2 * v->weight[k] / (1 + v->weight[k]));
}

/* Multiplies left vectors by value, weight and factor, and sets `to` to left^T right, or adds
 * it. */
static void add_leading(const struct bounce_scratch *s, struct bounce_factors *f,
			const struct bounce_verdict *v, float factor, bool set, float *to)
{
	for (int k = 0; k < v->kept; k++)
		cblas_sscal(s->rows, factor * weight_of_mean(v, k) * f->value[k],
			    f->left + (size_t)k * (size_t)s->rows, 1);
	cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, s->rows, s->lights, v->kept, 1,
		    f->left, s->rows, f->right, s->lights, set ? 0 : 1, to, s->lights);
}

/* Replaces the mean by its leading part, and its noise by that of the halves' leading parts.
 * Returns 0 or LAPACK's error. */
static int filter_mean(struct bounce_scratch *s, const struct bounce_halves *in,
		       const struct bounce_verdict *v)
{
	const float noise_scale = (float)sqrt(in->share[0] * in->share[1]);
	int info;

	add_leading(s, &s->of[0], v, noise_scale, true, in->half[1]);
	add_leading(s, &s->of[1], v, -noise_scale, false, in->half[1]);
	info = bounce_factorise(s, in->half[0], &s->of[0]);
	if (!info)
		add_leading(s, &s->of[0], v, 1, true, in->half[0]);
	return info;
}

int bounce_filter(struct bounce *bounce, const struct bounce_halves *in)
{
	struct bounce_scratch s = scratch_deal(bounce);
	const size_t lights = (size_t)bounce->lights;
	const size_t bytes = (size_t)in->rows * lights * sizeof(float);
	struct bounce_verdict v = {.kept = 0};
	double noise, aside;
	int kept = -1;

	s.rows = in->rows;
	if (!bounce_set_aside(&s.aside, in, &noise, &aside)) {
		set_mean(in, lights);
		return -1;
	}
	if (!bounce_judge(&s, in->half, &v) && filtered_error(&s, in->half, &v, aside) < noise)
		kept = v.kept;
	set_mean(in, lights);
	for (int h = 0; h < 2 && kept == 0; h++)
		memset(in->half[h], 0, bytes);
	if (kept > 0 && filter_mean(&s, in, &v))
		kept = -1;
	bounce_put_back(&s.aside, in, kept >= 0);
	return kept;
}
