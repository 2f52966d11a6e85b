/* SPDX-License-Identifier: MIT */
#include "bake/judge/expose.h"

#include <cblas.h>
#include <math.h>

#include "hal/colour/transfer.h"

/* Limits are this share of the error asked for; the rest is for tables and single precision. */
#define MARGIN 0.99

/* Decodes sRGB by its own formulas, which continue below black and beyond white. */
static double light_of_level(double level)
{
	const double encoded = level / 255;

	return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

void levels_fill(struct levels *levels, double cell_error)
{
	/* Each table entry is the smaller limit of a step's two ends, so that interpolation inside
	 * the step never exceeds the true limit. */
	float rise[LEVELS_STEPS + 2], fall[LEVELS_STEPS + 2];

	for (int k = 0; k <= LEVELS_STEPS + 1; k++) {
		const double x = fmin((double)k / LEVELS_STEPS, 1);
		const double level = 255 * transfer_encode(TRANSFER_SRGB, x);

		levels->at[k] = (float)level;
		rise[k] = (float)(MARGIN * (light_of_level(level + cell_error) - x));
		fall[k] = (float)(MARGIN * (x - light_of_level(level - cell_error)));
	}
	for (int k = 0; k <= LEVELS_STEPS + 1; k++) {
		const int next = k <= LEVELS_STEPS ? k + 1 : k;

		levels->rise[k] = fminf(rise[k], rise[next]);
		levels->fall[k] = fminf(fall[k], fall[next]);
	}
}

/* ---- exposures ---- */

static const double *ground_of(const struct encode_settings *settings, const struct part *part,
			       int channel)
{
	return settings->ground +
	       ((size_t)part->ground * 3 + (size_t)channel) * (size_t)settings->lights;
}

static void expose_cells(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights;

	/* The ground may be as bright as white. */
	for (int c = 0; c < 3; c++)
		part->cell.offset[c] = part->kind == BASIS_KIND_V ? 1 : 0;
	for (int i = 0; i < n; i++) {
		const float *base = part->base + (size_t)i * (size_t)part->rows;
		const double w = settings->light[i].solid_angle_sr;
		double white = ensemble_projected_sr(&settings->light[i]) / M_PI;

		if (part->kind != BASIS_KIND_V)
			white = fmax(white, w * (double)part_largest(base, part->rows));
		part->cell.white[i] = (float)white;
		for (int c = 0; c < 3; c++)
			part->cell.slope[(size_t)c * (size_t)n + (size_t)i] =
				part->kind == BASIS_KIND_V ? -part->cell.offset[c]
				: white > 0		   ? (float)(w / white)
							   : 0;
	}
}

/* Exposes a V: X_i = u_i L_i / sum of u L, the share of the ground's light, and the offset is the
 * ground's light in the picture. */
static void expose_ground(struct part *part, const struct encode_settings *settings, int sky)
{
	const int n = settings->lights;
	double white = 0, all[3];

	for (int c = 0; c < 3; c++) {
		const float *l = settings->ensemble->radiance + (size_t)(sky * 3 + c) * (size_t)n;
		const double *u = ground_of(settings, part, c);
		double level = 0;

		all[c] = 0;
		for (int i = 0; i < n; i++) {
			all[c] += u[i] * (double)l[i];
			level += ensemble_projected_sr(&settings->light[i]) / M_PI * (double)l[i];
		}
		white = fmax(white, fmax(level, all[c]));
	}
	part->sky.white[sky] = white;
	for (int c = 0; c < 3; c++) {
		const float *l = settings->ensemble->radiance + (size_t)(sky * 3 + c) * (size_t)n;
		const double *u = ground_of(settings, part, c);
		float *x = part->sky.x + (size_t)(sky * 3 + c) * (size_t)n;

		for (int i = 0; i < n; i++)
			x[i] = all[c] > 0 ? (float)(u[i] * (double)l[i] / all[c]) : 0;
		part->sky.offset[sky][c] = settings->ensemble->strong[sky] ? 1
					   : white > 0			   ? (float)(all[c] / white)
									   : 0;
		part->sky.slope[sky][c] = -part->sky.offset[sky][c];
	}
}

/* Sets X = w L of the other kinds, not yet exposed. */
static void expose_light(struct part *part, const struct encode_settings *settings)
{
	const size_t n = (size_t)settings->lights, rows = 3 * (size_t)settings->ensemble->skies;

	for (size_t k = 0; k < rows; k++)
		for (size_t i = 0; i < n; i++)
			part->sky.x[k * n + i] =
				(float)((double)settings->ensemble->radiance[k * n + i] *
					settings->light[i].solid_angle_sr);
}

/* Computes the sum of X times value under all skies. */
static void sum_skies(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights, skies = settings->ensemble->skies;

	for (int c = 0; c < 3; c++)
		cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, skies, part->pixels, n, 1,
			    part->sky.x + (size_t)c * (size_t)n, 3 * n,
			    part->value + (part->channels == 3 ? c * part->pixels : 0), part->rows,
			    0, part->sky.value + c * part->pixels, 3 * part->pixels);
}

/* Computes what a pair shows: u - d. */
static void subtract_sums(const struct part *difference, struct part *whole, int skies)
{
	for (int k = 0; k < skies * 3 * whole->pixels; k++)
		whole->sky.own_base[k] = whole->sky.value[k] - difference->sky.value[k];
}

/* Returns the radiance that is shown as 1 under a sky: that of white ground or of the brightest
 * pixel, whichever is brighter. */
static double white_of(const struct part *part, const struct encode_settings *settings, int sky)
{
	const int n = settings->lights, rows = 3 * part->pixels;
	double white = (double)part_largest(part->sky.base + (size_t)sky * (size_t)rows, rows);

	for (int c = 0; c < 3; c++) {
		const float *x = part->sky.x + (size_t)(sky * 3 + c) * (size_t)n;
		double level = 0;

		for (int i = 0; i < n; i++)
			level += fmax(settings->light[i].direction[2], ENSEMBLE_LOWEST) / M_PI *
				 (double)x[i];
		white = fmax(white, level);
	}
	return white;
}

static void scale_sky(float *value, int sky, int count, float by)
{
	for (int k = 0; k < count; k++)
		value[(size_t)sky * (size_t)count + (size_t)k] *= by;
}

/* Multiplies X and sums by each sky's exposure. */
static void scale_light(struct part *part, const struct encode_settings *settings)
{
	for (int s = 0; s < settings->ensemble->skies; s++) {
		const double white = part->sky.white[s];
		const float by = white > 0
					 ? (float)((double)settings->ensemble->exposure[s] / white)
					 : 0;

		scale_sky(part->sky.x, s, 3 * settings->lights, by);
		scale_sky(part->sky.value, s, 3 * part->pixels, by);
		if (part->kind == BASIS_KIND_U)
			scale_sky(part->sky.own_base, s, 3 * part->pixels, by);
		for (int c = 0; c < 3; c++) {
			part->sky.offset[s][c] = 0;
			part->sky.slope[s][c] = 1;
		}
	}
}

/* Sets q of each light in its group. */
static void share_groups(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights;
	double *of = part->sky.own_share;

	for (int i = 0; i < n; i++)
		of[i] = part->kind == BASIS_KIND_V ? ground_of(settings, part, 0)[i] +
							     ground_of(settings, part, 1)[i] +
							     ground_of(settings, part, 2)[i]
						   : settings->light[i].solid_angle_sr;
	basis_groups_share(settings->groups, of, of);
}

/* Computes S of each group under each sky, at the sky's exposure, so that cuts are those of the
 * settings. */
static void even_skies(struct part *part, const struct encode_settings *settings)
{
	const size_t n = (size_t)settings->lights, groups = (size_t)settings->groups->count;
	const double cut = BASIS_GROUP_MOST *
			   basis_group_cut(settings->groups, settings->column_cut);
	const double most[3] = {cut, cut, cut};
	const bool used = (part->kind == BASIS_KIND_T || part->kind == BASIS_KIND_V) && groups &&
			  settings->column_cut > 0;

	part->sky.even = used ? part->sky.own_even : NULL;
	part->sky.share = used ? part->sky.own_share : NULL;
	if (!used)
		return;
	share_groups(part, settings);
	for (size_t s = 0; s < (size_t)settings->ensemble->skies; s++) {
		for (size_t c = 0; c < 3; c++)
			for (size_t i = 0; i < n; i++)
				part->sky.light[i][c] = (double)part->sky.x[(s * 3 + c) * n + i];
		for (size_t k = 0; k < groups; k++) {
			double even[3];

			basis_group_even(settings->groups, (int)k, part->sky.own_share,
					 (const double(*)[4])part->sky.light, most, even);
			for (size_t c = 0; c < 3; c++)
				part->sky.own_even[(s * 3 + c) * groups + k] = (float)even[c];
		}
	}
}

void parts_expose(struct part *parts, int count, const struct encode_settings *settings)
{
	const int skies = settings->ensemble->skies;

	for (int k = 0; k < count; k++) {
		expose_cells(&parts[k], settings);
		for (int s = 0; s < skies && parts[k].kind == BASIS_KIND_V; s++)
			expose_ground(&parts[k], settings, s);
		if (parts[k].kind != BASIS_KIND_V)
			expose_light(&parts[k], settings);
		sum_skies(&parts[k], settings);
		if (parts[k].kind == BASIS_KIND_U)
			subtract_sums(&parts[k - 1], &parts[k], skies);
	}
	for (int k = 0; k < count; k++) {
		for (int s = 0; s < skies && parts[k].kind != BASIS_KIND_V; s++)
			parts[k].sky.white[s] = white_of(&parts[k], settings, s);
		/* A pair's D takes the exposure of its U. */
		if (parts[k].kind == BASIS_KIND_U)
			scale_light(&parts[k - 1], settings);
		if (parts[k].kind == BASIS_KIND_T || parts[k].kind == BASIS_KIND_U)
			scale_light(&parts[k], settings);
	}
	for (int k = 0; k < count; k++)
		even_skies(&parts[k], settings);
}
