/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_parts.h"

#include <float.h>
#include <math.h>

/* Limits narrower than this share of the largest value weigh as if they were as wide: some 16
 * roundings of single precision (2^-24) amount to it. */
#define NARROWEST 1e-6F
/* A light that a pixel does not show has these limits, which no residual exceeds (VALUE_MAX of
 * part.c). */
#define WIDEST 1e30F
/* This is added to each weight, so that no light or pixel is ignored. The mean weight is 1. Chosen
 * by trial. */
#define LEAST_WEIGHT 0.01F

/* Sets the limits of one row's residuals l = left, so that the light shown, offset + slope (base -
 * l), rises and falls by at most what levels allow: -rise <= slope l <= fall. intersect: intersects
 * them with the limits that are there. */
static void limit_row(const struct levels *levels, const struct part *part, float offset,
		      float slope, float share, const float *base, float *least, float *most,
		      bool intersect)
{
	const float per = fabsf(slope) > FLT_MIN ? 1 / fabsf(slope) : WIDEST;

	for (int p = 0; p < part->pixels; p++) {
		const float scale = share * per;
		const float shown = offset + slope * base[p];
		const float rise = smaller(levels_read(levels->rise, shown) * scale, WIDEST);
		const float fall = smaller(levels_read(levels->fall, shown) * scale, WIDEST);
		const float low = slope < 0 ? -fall : -rise, high = slope < 0 ? rise : fall;

		least[p] = intersect ? larger(least[p], low) : low;
		most[p] = intersect ? smaller(most[p], high) : high;
	}
}

static void limit_cells(struct part *part, const struct levels *levels, int lights)
{
	for (int i = 0; i < lights; i++)
		for (int c = 0; c < 3; c++) {
			const size_t k = (size_t)c * (size_t)lights + (size_t)i;
			const size_t at = (size_t)i * (size_t)part->rows +
					  (size_t)(part->channels == 3 ? c * part->pixels : 0);
			const bool intersect = part->channels == 1 && c;

			if (intersect && part->cell.offset[c] == part->cell.offset[0] &&
			    part->cell.slope[k] == part->cell.slope[i])
				continue;
			limit_row(levels, part, part->cell.offset[c], part->cell.slope[k],
				  part->limit.light_share[i], part->base + at,
				  part->limit.least + at, part->limit.most + at, intersect);
		}
}

/* Computes the weights of README.md, section 2, from tight = 1 / m: W_i is the mean over a light's
 * rows, h_p the square of the mean over a pixel's rows and lights, both relative to the overall
 * mean. */
static void weigh_values(struct part *part, int lights)
{
	const float narrowest = NARROWEST * part->largest + FLT_MIN;
	double all = 0, all_pixels = 0, pixel[PART_PIXELS] = {0};

	for (int i = 0; i < lights; i++) {
		const float *least = part->limit.least + (size_t)i * (size_t)part->rows;
		const float *most = part->limit.most + (size_t)i * (size_t)part->rows;
		float *tight = part->limit.tight + (size_t)i * (size_t)part->rows;
		float sum = 0;

		for (int r = 0; r < part->rows; r++)
			tight[r] = 1 / larger(smaller(most[r], -least[r]), narrowest);
		for (int c = 0; c < part->channels; c++)
			for (int p = 0; p < part->pixels; p++) {
				sum += tight[c * part->pixels + p];
				pixel[p] += (double)tight[c * part->pixels + p];
			}
		part->limit.weight[i] = sum;
		all += (double)sum;
	}
	for (int i = 0; i < lights; i++)
		part->limit.weight[i] =
			all > 0 ? (float)((double)part->limit.weight[i] * lights / all) +
					  LEAST_WEIGHT
				: 1;
	for (int p = 0; p < part->pixels; p++)
		all_pixels += pixel[p];
	for (int p = 0; p < part->pixels; p++) {
		const double share = pixel[p] * part->pixels / all_pixels;

		part->limit.pixel_weight[p] = (float)(share * share) + LEAST_WEIGHT;
	}
}

bool part_cell_holds(const struct part *part, int light, const float *left)
{
	const size_t first = (size_t)light * (size_t)part->rows;
	const float *least = part->limit.least + first, *most = part->limit.most + first;
	int beyond = 0;

	for (int r = 0; r < part->rows; r++)
		beyond |= (left[r] < least[r]) | (left[r] > most[r]);
	return !beyond;
}

void part_limit(struct part *part, const struct encode_settings *settings,
		const struct levels *levels)
{
	const bool pair = part->kind == BASIS_KIND_D || part->kind == BASIS_KIND_U;

	part->limit.column_cut = pair ? 0 : settings->column_cut;
	part->limit.group_cut = basis_group_cut(settings->groups, part->limit.column_cut);
	/* A frame leaves out the columns of a light that fades. For T no pixel may then miss the
	 * error asked for, not even a black one: cut_share * column_cut <= rise(0). V needs no such
	 * limit, as a ratio does not fade with a light that is alone. */
	part->limit.cut_share = 1;
	if (part->kind == BASIS_KIND_T && part->limit.column_cut > 0)
		part->limit.cut_share =
			fmin(1, fmin((double)levels->rise[0], (double)levels->fall[0]) /
					part->limit.column_cut);
	limit_cells(part, levels, settings->lights);
	weigh_values(part, settings->lights);
}
