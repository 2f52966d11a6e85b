/* SPDX-License-Identifier: MIT */
#include "bake/trace/bounce.h"

#include <cblas.h>
#include <math.h>
#include <string.h>

#include "hal/basis/basis_format.h"

/* A plane counts as linearly dependent if less than this length of it, in pixels, remains beside
 * the others. Three pixels that are nearly in line leave 0.04. */
#define PLANE_LEAST 1e-3

size_t bounce_aside_floats(size_t lights)
{
	return (1 + 2 * BOUNCE_PLANES * BOUNCE_CHANNELS) * lights;
}

void bounce_aside_open(struct bounce_aside *aside, size_t lights, float *memory)
{
	aside->lights = lights;
	aside->profile = memory;
	aside->column[0] = aside->profile + lights;
	aside->column[1] = aside->column[0] + BOUNCE_PLANES * BOUNCE_CHANNELS * lights;
}

/* ---- sums ---- */

static void sum_rows(struct bounce_aside *aside, const struct bounce_halves *in)
{
	for (int h = 0; h < 2; h++)
		for (size_t row = 0; row < (size_t)in->rows; row++)
			aside->sum[row][h] = bounce_dot(in->half[h] + row * aside->lights, in->sky,
							aside->lights);
}

static double mean_sum(const struct bounce_aside *aside, const struct bounce_halves *in, size_t row)
{
	return in->share[0] * aside->sum[row][0] + in->share[1] * aside->sum[row][1];
}

/* Finds the profile of sum 1 that, times each row's sum, fits the rows of the mean best (least
 * squares). Returns false if there is no light, or it is not finite. */
static bool find_profile(struct bounce_aside *aside, const struct bounce_halves *in)
{
	const size_t lights = aside->lights, rows = (size_t)in->rows;
	double square = 0;

	for (size_t row = 0; row < rows; row++)
		square += mean_sum(aside, in, row) * mean_sum(aside, in, row);
	if (!isfinite(square) || square == 0)
		return false;
	memset(aside->profile, 0, lights * sizeof(*aside->profile));
	for (int h = 0; h < 2; h++)
		for (size_t row = 0; row < rows; row++)
			cblas_saxpy((int)lights,
				    (float)(in->share[h] * mean_sum(aside, in, row) / square),
				    in->half[h] + row * lights, 1, aside->profile, 1);
	return true;
}

/* Subtracts sums times profile, and scales. Returns the squared difference of the halves' sums
 * times profile; *difference becomes that of the halves themselves. */
static double set_sums_aside(const struct bounce_aside *aside, const struct bounce_halves *in,
			     double *difference)
{
	const size_t lights = aside->lights;
	double profile_square = 0, sums_difference = 0;

	*difference = 0;
	for (size_t i = 0; i < lights; i++)
		profile_square += pow((double)aside->profile[i] * (double)in->scale[i], 2);
	for (size_t row = 0; row < (size_t)in->rows; row++) {
		const double *sum = aside->sum[row];
		float *a = in->half[0] + row * lights, *b = in->half[1] + row * lights;

		for (size_t i = 0; i < lights; i++) {
			const float d = (a[i] - b[i]) * in->scale[i];

			*difference += (double)d * (double)d;
			a[i] = (a[i] - (float)sum[0] * aside->profile[i]) * in->scale[i];
			b[i] = (b[i] - (float)sum[1] * aside->profile[i]) * in->scale[i];
		}
		sums_difference += pow(sum[0] - sum[1], 2) * profile_square;
	}
	return sums_difference;
}

/* ---- planes ---- */

static float plane_at(int k, uint16_t pixel)
{
	const int along = k == 1 ? pixel % BASIS_TILE : pixel / BASIS_TILE;

	return k ? (float)along - 0.5F * (BASIS_TILE - 1) : 1;
}

static void find_planes(struct bounce_aside *aside, const struct bounce_halves *in)
{
	const int pixels = in->rows / BOUNCE_CHANNELS;

	aside->planes = 0;
	for (int k = 0; k < BOUNCE_PLANES; k++) {
		float *at = aside->plane[aside->planes];
		double size;

		for (int p = 0; p < pixels; p++)
			at[p] = plane_at(k, in->pixel[p]);
		for (int j = 0; j < aside->planes; j++)
			cblas_saxpy(pixels, (float)-bounce_dot(at, aside->plane[j], (size_t)pixels),
				    aside->plane[j], 1, at, 1);
		size = sqrt(bounce_dot(at, at, (size_t)pixels));
		if (size < PLANE_LEAST)
			continue;
		cblas_sscal(pixels, (float)(1 / size), at, 1);
		aside->planes++;
	}
}

/* Returns the Wiener weight of a slope, given by halves a and b. Adds to *error the squared noise
 * that stays and the squared light that is lost. */
static float weigh_slope(const float *a, const float *b, size_t count, double *error)
{
	const double both = bounce_dot(a, b, count), light = fmax(both, 0);
	const double difference = bounce_dot(a, a, count) + bounce_dot(b, b, count) - 2 * both;
	const double noise = fmax(difference, 0) / 4;
	const double weight = light > 0 ? light / (light + noise) : 0;

	*error += weight * weight * noise + (1 - weight) * (1 - weight) * light;
	return (float)weight;
}

/* Subtracts planes. Means keep weight 1; slopes have the Wiener weight of their halves. Returns the
 * squared error of the weighted planes. */
static double set_planes_aside(struct bounce_aside *aside, const struct bounce_halves *in)
{
	const int pixels = in->rows / BOUNCE_CHANNELS;
	const size_t count = BOUNCE_CHANNELS * aside->lights;
	const int size = (int)count;
	double error = 0;

	find_planes(aside, in);
	for (int h = 0; h < 2; h++) {
		cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, aside->planes, size, pixels,
			    1, aside->plane[0], BOUNCE_PIXELS_MAX, in->half[h], size, 0,
			    aside->column[h], size);
		cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, pixels, size, aside->planes,
			    -1, aside->plane[0], BOUNCE_PIXELS_MAX, aside->column[h], size, 1,
			    in->half[h], size);
	}
	aside->weight[0] = 1;
	for (size_t i = 0; i < count; i++)
		error += pow((double)aside->column[0][i] - (double)aside->column[1][i], 2) / 4;
	for (int k = 1; k < aside->planes; k++)
		aside->weight[k] = weigh_slope(aside->column[0] + (size_t)k * count,
					       aside->column[1] + (size_t)k * count, count, &error);
	return error;
}

/* ---- both ---- */

bool bounce_set_aside(struct bounce_aside *aside, const struct bounce_halves *in, double *noise,
		      double *error)
{
	double difference;

	sum_rows(aside, in);
	if (!find_profile(aside, in))
		return false;
	*error = set_sums_aside(aside, in, &difference) / 4;
	*error += set_planes_aside(aside, in);
	*noise = difference / 4;
	return true;
}

/* Restores `to`: removes its scale and adds share[h] times the sums and planes of half h. */
static void put_back(const struct bounce_aside *aside, const struct bounce_halves *in,
		     const double share[2], float *to)
{
	const int size = BOUNCE_CHANNELS * (int)aside->lights, pixels = in->rows / BOUNCE_CHANNELS;

	for (int h = 0; h < 2; h++)
		cblas_sgemm(CblasRowMajor, CblasTrans, CblasNoTrans, pixels, size, aside->planes,
			    (float)share[h], aside->plane[0], BOUNCE_PIXELS_MAX, aside->column[h],
			    size, 1, to, size);
	for (size_t row = 0; row < (size_t)in->rows; row++) {
		float *at = to + row * aside->lights;
		const float by =
			(float)(share[0] * aside->sum[row][0] + share[1] * aside->sum[row][1]);

		for (size_t i = 0; i < aside->lights; i++)
			at[i] = at[i] / in->scale[i] + by * aside->profile[i];
	}
}

void bounce_put_back(struct bounce_aside *aside, const struct bounce_halves *in, bool filtered)
{
	const double noise_share = sqrt(in->share[0] * in->share[1]);

	for (int k = 0; filtered && k < aside->planes; k++)
		cblas_sscal(in->rows / BOUNCE_CHANNELS, aside->weight[k], aside->plane[k], 1);
	put_back(aside, in, in->share, in->half[0]);
	put_back(aside, in, (const double[2]){noise_share, -noise_share}, in->half[1]);
}
