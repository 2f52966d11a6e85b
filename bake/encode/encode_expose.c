/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_expose.h"

#include <cblas.h>
#include <float.h>
#include <math.h>

#include "hal/colour/transfer.h"

/* What tables and single precision may cost of the error asked for. */
#define MARGIN 0.99
/* The narrowest error that is told from others, against the largest value. */
#define NARROWEST 1e-6F
/* The widest: where a light is not seen at all. */
#define WIDEST 1e30F
/* Weight of a light or pixel whose error nobody sees, relative to the mean; not 0, so that none is
 * ignored. */
#define LEAST_WEIGHT 0.01F
/* The steps in which light fades until a column need not be used. */
#define FADE 0.9
/* The farthest that a column reaches beyond its largest value, which keeps it fine enough; and at
 * all, so that the file may hold it. */
#define REACH_MOST 16
#define REACH_LIMIT (0.8 * BASIS_VALUE_MAX)

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

/* Shown light less what is left of it, within rise and fall: slope * left in -rise..fall. */
static void limit_row(const struct levels *levels, const struct part *part, float offset,
		      float slope, const float *base, float *least, float *most, bool again)
{
	const float per = fabsf(slope) > FLT_MIN ? 1 / fabsf(slope) : WIDEST;

	for (int p = 0; p < part->pixels; p++) {
		const float to = part->fine * part->cell_share[p] * per;
		const float is = offset + slope * base[p];
		const float rise = smaller(levels_read(levels->rise, is) * to, WIDEST);
		const float fall = smaller(levels_read(levels->fall, is) * to, WIDEST);
		const float low = slope < 0 ? -fall : -rise, high = slope < 0 ? rise : fall;

		least[p] = again ? larger(least[p], low) : low;
		most[p] = again ? smaller(most[p], high) : high;
	}
}

static void limit_cells(struct part *part, const struct levels *levels, int lights)
{
	for (int i = 0; i < lights; i++)
		for (int c = 0; c < 3; c++) {
			const size_t k = (size_t)c * (size_t)lights + (size_t)i;
			const size_t at = (size_t)i * (size_t)part->rows +
					  (size_t)(part->channels == 3 ? c * part->pixels : 0);
			const bool again = part->channels == 1 && c;

			if (again && part->cell_offset[c] == part->cell_offset[0] &&
			    part->cell_slope[k] == part->cell_slope[i])
				continue;
			limit_row(levels, part, part->cell_offset[c], part->cell_slope[k],
				  part->base + at, part->least_left + at, part->most_left + at,
				  again);
		}
}

/* Lights and pixels that allow little error count more: lights by the mean of what is allowed,
 * inverted, pixels by its square. Pixels that are not kept hardly count. */
static void weigh_values(struct part *part, int lights)
{
	const float narrowest = NARROWEST * part->largest + FLT_MIN;
	double all = 0, all_pixels = 0, pixel[PART_PIXELS] = {0};

	for (int i = 0; i < lights; i++) {
		const float *least = part->least_left + (size_t)i * (size_t)part->rows;
		const float *most = part->most_left + (size_t)i * (size_t)part->rows;
		float sum = 0;

		for (int c = 0; c < part->channels; c++)
			for (int p = 0; p < part->pixels; p++) {
				const int r = c * part->pixels + p;
				const float narrow = most[r] < -least[r] ? most[r] : -least[r];
				const float by = 1 / (narrow > narrowest ? narrow : narrowest);

				sum += by;
				pixel[p] += (double)by;
			}
		part->weight[i] = sum;
		all += (double)sum;
	}
	for (int i = 0; i < lights; i++)
		part->weight[i] = all > 0 ? (float)((double)part->weight[i] * lights / all) +
						    LEAST_WEIGHT
					  : 1;
	for (int p = 0; p < part->pixels; p++)
		all_pixels += part->keep[p] ? pixel[p] : 0;
	for (int p = 0; p < part->pixels; p++) {
		const double share = part->keep[p] ? pixel[p] * part->kept / all_pixels : 0;

		part->pixel_weight[p] = (float)(share * share) + LEAST_WEIGHT;
	}
}

bool part_pixels_hold(const struct part *part, int light, int channel, int from, int to,
		      const float *left)
{
	const size_t row = (size_t)(channel * part->pixels);
	const size_t first = (size_t)light * (size_t)part->rows + row;
	const float *least = part->least_left + first, *most = part->most_left + first;
	int beyond = 0;

	for (int p = from; p < to; p++)
		beyond |= (left[row + p] < least[p]) | (left[row + p] > most[p]);
	return !beyond;
}

bool part_cell_holds(const struct part *part, int light, const float *left)
{
	for (int c = 0; c < part->channels; c++)
		if (!part_pixels_hold(part, light, c, 0, part->pixels, left))
			return false;
	return true;
}

/* A light alone is nearly all of the ground's, less what e of compositor.h adds: of light that is
 * dim, but not a thousand times dimmer than white, not so much. */
#define ALONE 1.01

/* Whether left may be left out of the light's values where its X is so much, alone. */
static bool holds_at(const struct part *part, int light, float x, const float *left)
{
	const struct levels *levels = part->levels;
	const float *value = part->value + (size_t)light * (size_t)part->rows;
	/* of all light, dark light may be off by least */
	const float least = fminf(levels->rise[0], levels->fall[0]);

	for (int r = 0; r < part->rows; r++) {
		const float share = part->fine * part->cell_share[r % part->pixels];
		const float by = x * left[r];

		if (fabsf(by) <= least * share)
			continue;
		if (by > share * levels_read(levels->fall, x * value[r]) ||
		    -by > share * levels_read(levels->rise, x * value[r]))
			return false;
	}
	return true;
}

double part_column_reach(const struct part *part, int light, const float *left)
{
	const double cut = part->column_cut;
	double x, largest;

	if (!(cut > 0))
		return 0;
	largest = (double)larger(part_largest(left, part->rows, 1),
				 part_largest(left, part->rows, -1));
	/* Shares of the ground's light do not fade with it. */
	if (part->kind == BASIS_KIND_V)
		return part->fine < 1 ? fmin(fmax(cut, largest / (double)part->fine), REACH_LIMIT)
				      : cut * ALONE;
	if (!(largest > 0 && part->cell_slope[light] > 0))
		return 0;
	x = fmin((double)part->cell_slope[light], cut / largest);
	while (x * largest * REACH_MOST > cut && !holds_at(part, light, (float)x, left))
		x *= FADE;
	return fmin(cut / x / (double)part->fine, fmin(REACH_MOST * largest, REACH_LIMIT));
}

float part_cell_share(const struct part *part, int light, const float *left)
{
	const size_t first = (size_t)light * (size_t)part->rows;
	float most = 0;

	for (int r = 0; r < part->rows; r++) {
		const float all = left[r] < 0 ? part->least_left[first + (size_t)r]
					      : part->most_left[first + (size_t)r];

		if (part->keep[r % part->pixels] && left[r] / all > most)
			most = left[r] / all;
	}
	return most;
}

static void choose_pixels(struct part *part, const struct encode_settings *settings,
			  const struct levels *levels, float tolerance)
{
	const int n = settings->lights;

	part->kept = 0;
	for (int p = 0; p < part->pixels; p++) {
		const float most = tolerance * part->cell_share[p];
		bool keep = part->kind == BASIS_KIND_D || part->kind == BASIS_KIND_U;

		for (int k = 0; k < part->channels * n && !keep; k++) {
			const int c = k % part->channels, i = k / part->channels;
			const float value = part->value[(size_t)i * (size_t)part->rows +
							(size_t)(c * part->pixels + p)];

			for (int own = c; own < (part->channels == 3 ? c + 1 : 3); own++) {
				const float by =
					part->cell_slope[(size_t)own * (size_t)n + (size_t)i] *
					value;
				const float is = part->cell_offset[own] + by;

				if (fabsf(by) * LEVELS_STEEPEST <= most)
					continue;
				keep |= fabsf(levels_at(levels, is) -
					      levels_at(levels, part->cell_offset[own])) > most;
			}
		}
		part->keep[p] = keep;
		part->kept += keep;
	}
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

void part_limit(struct part *part, const struct encode_settings *settings,
		const struct levels *levels, double tolerance)
{
	const bool used = part->kind == BASIS_KIND_D || part->kind == BASIS_KIND_U;

	part->levels = levels;
	part->column_cut = used ? 0 : settings->column_cut;
	part->group_cut = basis_group_cut(settings->groups, part->column_cut);
	limit_cells(part, levels, settings->lights);
	choose_pixels(part, settings, levels, (float)tolerance);
	weigh_values(part, settings->lights);
}
