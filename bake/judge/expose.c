/* SPDX-License-Identifier: MIT */
#include "bake/judge/expose.h"

#include <cblas.h>
#include <math.h>

#include "hal/colour/transfer.h"

/* What tables and single precision may cost of the error asked for. */
#define MARGIN 0.99
/* sRGB's own formulas, below black and beyond white too. */
static double light_of_level(double level)
{
	const double encoded = level / 255;

	return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

void levels_fill(struct levels *levels, double cell_error)
{
	/* The least of a step's two ends, so that what lies between is not beyond either. */
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

/* Values side by side, as compilers do not take a maximum apart. */
#define LANES 8

float part_largest(const float *value, int count, float sign)
{
	const int whole = count / LANES * LANES;
	float lane[LANES] = {0}, most = 0;

	for (int k = 0; k < whole; k += LANES)
		for (int n = 0; n < LANES; n++)
			lane[n] = larger(lane[n], sign * value[k + n]);
	for (int k = whole; k < count; k++)
		most = larger(most, sign * value[k]);
	for (int n = 0; n < LANES; n++)
		most = larger(most, lane[n]);
	return most;
}

static const double *ground_of(const struct encode_settings *settings, const struct part *part,
			       int channel)
{
	return settings->ground +
	       ((size_t)part->ground * 3 + (size_t)channel) * (size_t)settings->lights;
}

static void expose_cells(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights;

	/* What a camera sees of the ground may be as bright as white. */
	for (int c = 0; c < 3; c++)
		part->cell_offset[c] = part->kind == BASIS_KIND_V ? 1 : 0;
	for (int i = 0; i < n; i++) {
		const float *base = part->base + (size_t)i * (size_t)part->rows;
		const double w = settings->light[i].solid_angle_sr;
		double white = ensemble_projected_sr(&settings->light[i]) / M_PI;

		if (part->kind != BASIS_KIND_V)
			white = fmax(white, w * (double)part_largest(base, part->rows, 1));
		part->cell_white[i] = (float)white;
		for (int c = 0; c < 3; c++)
			part->cell_slope[(size_t)c * (size_t)n + (size_t)i] =
				part->kind == BASIS_KIND_V ? -part->cell_offset[c]
				: white > 0		   ? (float)(w / white)
							   : 0;
	}
}

static void sum_skies(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights, skies = settings->ensemble->skies;

	for (int c = 0; c < 3; c++)
		cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasNoTrans, skies, part->pixels, n, 1,
			    part->sky_x + (size_t)c * (size_t)n, 3 * n,
			    part->base + (part->channels == 3 ? c * part->pixels : 0), part->rows,
			    0, part->sky_base + c * part->pixels, 3 * part->pixels);
}

/* V: X as shares of all light, the ground's own light as offset. */
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
	part->sky_white[sky] = white;
	for (int c = 0; c < 3; c++) {
		const float *l = settings->ensemble->radiance + (size_t)(sky * 3 + c) * (size_t)n;
		const double *u = ground_of(settings, part, c);
		float *x = part->sky_x + (size_t)(sky * 3 + c) * (size_t)n;

		for (int i = 0; i < n; i++)
			x[i] = all[c] > 0 ? (float)(u[i] * (double)l[i] / all[c]) : 0;
		part->sky_offset[sky][c] = white > 0 ? (float)(all[c] / white) : 0;
		part->sky_slope[sky][c] = -part->sky_offset[sky][c];
	}
}

/* The others: X = w L, brought down so that white ground and the brightest pixel are at most 1. */
static void expose_light(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights, skies = settings->ensemble->skies;

	for (int k = 0; k < skies * 3; k++)
		for (int i = 0; i < n; i++)
			part->sky_x[(size_t)k * (size_t)n + (size_t)i] =
				(float)((double)settings->ensemble
						->radiance[(size_t)k * (size_t)n + (size_t)i] *
					settings->light[i].solid_angle_sr);
	sum_skies(part, settings);
	for (int s = 0; s < skies; s++) {
		const float *base = part->sky_base + (size_t)s * 3 * (size_t)part->pixels;
		double white = part_largest(base, 3 * part->pixels, 1);

		for (int c = 0; c < 3; c++) {
			const float *x = part->sky_x + (size_t)(s * 3 + c) * (size_t)n;
			double level = 0;

			for (int i = 0; i < n; i++)
				level += fmax(settings->light[i].direction[2], ENSEMBLE_LOWEST) /
					 M_PI * (double)x[i];
			white = fmax(white, level);
		}
		part->sky_white[s] = white;
		for (int k = 0; k < 3 * n; k++)
			part->sky_x[(size_t)s * 3 * (size_t)n + (size_t)k] *=
				white > 0 ? (float)((double)settings->ensemble->exposure[s] / white)
					  : 0;
		for (int c = 0; c < 3; c++) {
			part->sky_offset[s][c] = 0;
			part->sky_slope[s][c] = 1;
		}
	}
}

/* The largest change of a pixel by any light alone is more than tolerance, in levels. */
static bool pixel_shows(const struct part *part, const struct encode_settings *settings,
			const struct levels *levels, int pixel, float tolerance)
{
	const int n = settings->lights;

	for (int k = 0; k < part->channels * n; k++) {
		const int c = k % part->channels, i = k / part->channels;
		const float value = part->value[(size_t)i * (size_t)part->rows +
						(size_t)(c * part->pixels + pixel)];

		for (int own = c; own < (part->channels == 3 ? c + 1 : 3); own++) {
			const float by = value *
					 part->cell_slope[(size_t)own * (size_t)n + (size_t)i];
			const float is = part->cell_offset[own];

			if (fabsf(by) * LEVELS_STEEPEST > tolerance &&
			    fabsf(levels_at(levels, is + by) - levels_at(levels, is)) > tolerance)
				return true;
		}
	}
	return false;
}

/* The same by a sky. */
static bool pixel_shows_under_skies(const struct part *part, const struct encode_settings *settings,
				    const struct levels *levels, int pixel, float tolerance)
{
	for (int k = 0; k < 3 * settings->ensemble->skies; k++) {
		const int s = k / 3, c = k % 3;
		const float by = part->sky_slope[s][c] * part->sky_base[k * part->pixels + pixel];
		const float is = part->sky_offset[s][c];

		if (fabsf(by) * LEVELS_STEEPEST > tolerance &&
		    fabsf(levels_at(levels, is + by) - levels_at(levels, is)) > tolerance)
			return true;
	}
	return false;
}

int part_choose(const struct part *part, const struct encode_settings *settings,
		const struct levels *levels, double tolerance, bool *shows)
{
	const bool pair = part->kind == BASIS_KIND_D || part->kind == BASIS_KIND_U;
	int count = 0;

	for (int p = 0; p < part->pixels; p++) {
		shows[p] = pair || pixel_shows(part, settings, levels, p, (float)tolerance) ||
			   pixel_shows_under_skies(part, settings, levels, p, (float)tolerance);
		count += shows[p];
	}
	return count;
}

static void share_groups(struct part *part, const struct encode_settings *settings)
{
	const int n = settings->lights;
	double *of = part->own_share;

	for (int i = 0; i < n; i++)
		of[i] = part->kind == BASIS_KIND_V ? ground_of(settings, part, 0)[i] +
							     ground_of(settings, part, 1)[i] +
							     ground_of(settings, part, 2)[i]
						   : settings->light[i].solid_angle_sr;
	basis_groups_share(settings->groups, of, of);
}

/* What lights of a group have in common, in units in which cuts are as in settings. */
static void even_skies(struct part *part, const struct encode_settings *settings)
{
	const size_t n = (size_t)settings->lights, groups = (size_t)settings->groups->count;
	const double cut = BASIS_GROUP_MOST *
			   basis_group_cut(settings->groups, settings->column_cut);
	const double most[3] = {cut, cut, cut};
	const bool used = (part->kind == BASIS_KIND_T || part->kind == BASIS_KIND_V) && groups &&
			  settings->column_cut > 0;

	part->sky_even = used ? part->own_even : NULL;
	part->share = used ? part->own_share : NULL;
	if (!used)
		return;
	share_groups(part, settings);
	for (size_t s = 0; s < (size_t)settings->ensemble->skies; s++) {
		for (size_t c = 0; c < 3; c++)
			for (size_t i = 0; i < n; i++)
				part->beside[i][c] = (double)part->sky_x[(s * 3 + c) * n + i];
		for (size_t k = 0; k < groups; k++) {
			double even[3];

			basis_group_even(settings->groups, (int)k, part->own_share,
					 (const double(*)[4])part->beside, most, even);
			for (size_t c = 0; c < 3; c++)
				part->own_even[(s * 3 + c) * groups + k] = (float)even[c];
		}
	}
}

void part_expose(struct part *part, const struct encode_settings *settings)
{
	expose_cells(part, settings);
	if (part->kind == BASIS_KIND_V)
		for (int s = 0; s < settings->ensemble->skies; s++)
			expose_ground(part, settings, s);
	else
		expose_light(part, settings);
	sum_skies(part, settings);
	even_skies(part, settings);
}
