/* SPDX-License-Identifier: MIT */
#include "bake/judge/part.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLE_MAX 1e30F /* a float holds 1e8 times as much, so that no sum overflows */
/* Values may be this large; rounding in the encoder adds far less than the thousandth that is
 * left. */
#define VALUE_MAX (0.999F * (float)BASIS_VALUE_MAX)
#define BLOCK 64 /* number of lights that are transposed at once */
/* Maxima are taken in this many lanes (a vector of AVX), as compilers do not reorder them. */
#define LANES 8

int part_create(struct part *part, const struct encode_settings *settings)
{
	const size_t n = (size_t)settings->lights, skies = (size_t)settings->ensemble->skies;

	*part = (struct part){.pixels = 0};
	part->cell.slope = calloc(3 * n, sizeof(*part->cell.slope));
	part->sky.x = calloc(skies * 3 * n, sizeof(*part->sky.x));
	part->cell.white = calloc(n, sizeof(*part->cell.white));
	part->limit.weight = calloc(n, sizeof(*part->limit.weight));
	part->limit.light_share = calloc(n, sizeof(*part->limit.light_share));
	part->sky.value = calloc(skies * PART_ROWS, sizeof(*part->sky.value));
	part->sky.own_even = calloc(skies * 3 * (size_t)settings->coarse,
				    sizeof(*part->sky.own_even));
	part->sky.own_share = calloc(n, sizeof(*part->sky.own_share));
	part->sky.light = calloc(n, sizeof(*part->sky.light));
	return part->sky.own_even && part->limit.light_share && part->sky.own_share &&
			       part->sky.light && part->cell.slope && part->cell.white &&
			       part->limit.weight && part->sky.x && part->sky.value
		       ? 0
		       : -ENOMEM;
}

void part_free(struct part *part)
{
	free(part->value);
	free(part->direct);
	free(part->own_base);
	free(part->limit.least);
	free(part->limit.most);
	free(part->limit.tight);
	free(part->cell.white);
	free(part->limit.weight);
	free(part->limit.light_share);
	free(part->cell.slope);
	free(part->sky.x);
	free(part->sky.value);
	free(part->sky.own_base);
	free(part->sky.own_even);
	free(part->sky.own_share);
	free(part->sky.light);
	*part = (struct part){.pixels = 0};
}

int part_room_for(float **array, size_t *room, size_t count)
{
	float *grown;

	if (count <= *room)
		return 0;
	grown = realloc(*array, count * sizeof(**array));
	if (!grown)
		return -ENOMEM;
	*array = grown;
	*room = count;
	return 0;
}

float part_largest(const float *value, int count)
{
	const int whole = count / LANES * LANES;
	float lane[LANES] = {0}, most = 0;

	for (int k = 0; k < whole; k += LANES)
		for (int n = 0; n < LANES; n++)
			lane[n] = larger(lane[n], value[k + n]);
	for (int k = whole; k < count; k++)
		most = larger(most, value[k]);
	for (int n = 0; n < LANES; n++)
		most = larger(most, lane[n]);
	return most;
}

float part_magnitude(const float *value, int count)
{
	const int whole = count / LANES * LANES;
	float lane[LANES] = {0}, most = 0;

	for (int k = 0; k < whole; k += LANES)
		for (int n = 0; n < LANES; n++)
			lane[n] = larger(lane[n], fabsf(value[k + n]));
	for (int k = whole; k < count; k++)
		most = larger(most, fabsf(value[k]));
	for (int n = 0; n < LANES; n++)
		most = larger(most, lane[n]);
	return most;
}

/* ---- values per unit of X ---- */

static bool samples_are_sane(const struct encode_samples *s, const float *row, int count,
			     bool direct)
{
	bool good = true;

	for (int i = 0; i < count; i++)
		good &= fabsf(row[i]) <= SAMPLE_MAX; /* false for NaN */
	for (int i = 0; direct && s->kind == BASIS_KIND_U && i < count; i++)
		good &= row[i] >= 0;
	return good;
}

/* to[light][row] = from[light] / w, or += it if `add`. V is not divided. */
static void scatter_row(const struct encode_settings *settings, enum basis_kind kind,
			const float *from, float *to, int rows, bool add)
{
	for (int first = 0; first < settings->lights; first += BLOCK)
		for (int i = first; i < settings->lights && i < first + BLOCK; i++) {
			const double w = settings->light[i].solid_angle_sr;
			const float value = kind == BASIS_KIND_V ? from[i]
					    : w > 0		 ? (float)((double)from[i] / w)
					    : from[i] == 0	 ? 0
								 : INFINITY;
			float *at = to + (size_t)i * (size_t)rows;

			*at = add ? *at + value : value;
		}
}

static bool scatter_pixel(const struct encode_settings *settings, const struct encode_samples *s,
			  struct part *part, int p)
{
	const size_t n = (size_t)settings->lights;

	for (int c = 0; c < part->channels; c++) {
		const int own = s->channels == 3 ? c : 0;
		const float *row = s->direct + ((size_t)p * (size_t)s->channels + (size_t)own) * n;
		float *value = part->value + c * part->pixels + p;

		if (!samples_are_sane(s, row, settings->lights, true))
			return false;
		scatter_row(settings, s->kind, row, value, part->rows, false);
		if (!s->bounce)
			continue;
		if (c < s->channels)
			scatter_row(settings, s->kind, row, part->direct + c * part->pixels + p,
				    s->channels * part->pixels, false);
		row = s->bounce + ((size_t)p * 3 + (size_t)c) * n;
		if (!samples_are_sane(s, row, settings->lights, false))
			return false;
		scatter_row(settings, s->kind, row, value, part->rows, true);
	}
	return true;
}

/* Computes largest and rounded. Returns false if a value is larger than the file may hold. */
static bool part_measure(struct part *part, int lights)
{
	bool fits = true;

	part->largest = part->rounded = 0;
	for (int i = 0; i < lights; i++) {
		const float *value = part->value + (size_t)i * (size_t)part->rows;
		const float *direct =
			part->direct ? part->direct + (size_t)i * (size_t)(part->direct_channels *
									   part->pixels)
				     : value;

		for (int r = 0; r < part->rows; r++) {
			const int own = part->direct && part->direct_channels == 1
						? r % part->pixels
						: r;
			const float size = fabsf(value[r]);
			const float both = fabsf(direct[own]) + fabsf(value[r] - direct[own]);

			fits &= size <= VALUE_MAX; /* false for NaN */
			part->largest = size > part->largest ? size : part->largest;
			part->rounded = both > part->rounded ? both : part->rounded;
		}
	}
	return fits;
}

int part_load(struct part *part, const struct encode_settings *settings,
	      const struct encode_samples *s)
{
	const size_t n = (size_t)settings->lights;
	int err;

	part->kind = s->kind;
	part->ground = s->ground;
	part->pixels = s->pixels;
	memcpy(part->pixel, s->pixel, (size_t)s->pixels * sizeof(*s->pixel));
	part->direct_channels = s->channels;
	part->channels = s->bounce ? 3 : s->channels;
	part->rows = part->channels * part->pixels;
	err = part_room_for(&part->value, &part->value_room, n * (size_t)part->rows);
	if (!err)
		err = part_room_for(&part->limit.least, &part->limit.least_room,
				    n * (size_t)part->rows);
	if (!err)
		err = part_room_for(&part->limit.most, &part->limit.most_room,
				    n * (size_t)part->rows);
	if (!err)
		err = part_room_for(&part->limit.tight, &part->limit.tight_room,
				    n * (size_t)part->rows);
	if (!err && s->bounce)
		err = part_room_for(&part->direct, &part->direct_room,
				    n * (size_t)(s->channels * part->pixels));
	if (err)
		return err;
	if (!s->bounce) {
		free(part->direct);
		part->direct = NULL;
		part->direct_room = 0;
	}
	for (int p = 0; p < s->pixels; p++)
		if (!scatter_pixel(settings, s, part, p))
			return -EDOM;
	if (!part_measure(part, settings->lights))
		return -EDOM;
	part->base = part->value;
	part->sky.base = part->sky.value;
	for (int i = 0; i < settings->lights; i++)
		part->limit.light_share[i] = 1;
	return 0;
}

int part_pair(struct part *difference, struct part *whole, const struct encode_settings *settings)
{
	const int channels = difference->channels > whole->channels ? 3 : whole->channels;
	const size_t count = (size_t)settings->lights * (size_t)whole->rows;
	const size_t sums = (size_t)settings->ensemble->skies * PART_ROWS;
	int err;

	if (difference->channels != channels || whole->channels != channels)
		return -EINVAL;
	err = part_room_for(&whole->own_base, &whole->base_room, count);
	if (!err)
		err = part_room_for(&whole->sky.own_base, &whole->sky.room, sums);
	if (err)
		return err;
	for (size_t k = 0; k < count; k++)
		whole->own_base[k] = whole->value[k] - difference->value[k];
	difference->base = whole->base = whole->own_base;
	difference->sky.base = whole->sky.base = whole->sky.own_base;
	return 0;
}
