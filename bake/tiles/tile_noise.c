/* SPDX-License-Identifier: MIT */
#include "bake/tiles/tile_noise.h"

#include "hal/colour/transfer.h"

#define BACKGROUND 0.5 /* linear light behind the object */
#define LANES 8	       /* partial sums of a row, so that additions do not wait for each other */

static double sum_row(const float *row, const float *weight, int count)
{
	double part[LANES] = {0}, sum = 0;
	int i = 0;

	for (; i + LANES <= count; i += LANES)
		for (int k = 0; k < LANES; k++)
			part[k] += (double)row[i + k] * (double)weight[i + k];
	for (; i < count; i++)
		sum += (double)row[i] * (double)weight[i];
	for (int k = 0; k < LANES; k++)
		sum += part[k];
	return sum;
}

/* Factors [lights] of a kind's direct values under a uniform sky of radiance 1: blocked light on
 * flat ground is counted in whole cells, all other values are radiance. */
static const float *direct_sky(const struct tile *tile, enum tile_kind kind)
{
	return kind == TILE_CHANGE && !tile_has_standins(tile) ? tile->cells->share
							       : tile->even_sky;
}

/* Value of one kind, pixel and channel under a uniform sky: the sum of all samples so far. */
static double sum_kind(const struct tile *tile, enum tile_kind kind, int at, int c)
{
	const struct tile_rows *rows = &tile->rows[kind];
	const int count = tile->cells->count;
	const size_t channel = rows->channels == 3 ? (size_t)c : 0;
	const size_t bounce = (size_t)at * tile_bounce_size(tile) + (size_t)c * (size_t)count;

	return sum_row(rows->direct + (size_t)at * tile_direct_size(tile, kind) +
			       channel * (size_t)count,
		       direct_sky(tile, kind), count) +
	       sum_row(rows->bounce[0] + bounce, tile->even_sky, count) +
	       sum_row(rows->bounce[1] + bounce, tile->even_sky, count);
}

void tile_noise_add(struct tile *tile, int at, int samples)
{
	struct tile_pixel *p = &tile->pixels[at];
	const double other = p->other_weight - p->before_weight[0];
	const double receiver = p->receiver_weight - p->before_weight[1];

	for (int c = 0; c < 3; c++) {
		double fresh[TILE_KINDS] = {0}, ratio = 1, value, deviation;

		for (int kind = 0; kind < TILE_KINDS; kind++) {
			double total;

			if (!tile->rows[kind].direct ||
			    !(kind == TILE_OBJECT ? p->object : p->receiver))
				continue;
			total = sum_kind(tile, (enum tile_kind)kind, at, c);
			fresh[kind] = total - p->before[c][kind];
			p->before[c][kind] = total;
		}
		if (receiver > 0 && !tile_has_standins(tile))
			ratio -= fresh[TILE_CHANGE] / other;
		else if (receiver > 0 && fresh[TILE_WITHOUT] > 0)
			ratio -= (1 - fresh[TILE_CHANGE] / fresh[TILE_WITHOUT]) * receiver / other;
		value = (fresh[TILE_OBJECT] + other * fmax(ratio, 0) * BACKGROUND) / samples;
		deviation = value - p->mean[c];
		p->mean[c] += deviation / tile->batches;
		p->spread[c] += deviation * (value - p->mean[c]);
	}
	p->before_weight[0] = p->other_weight;
	p->before_weight[1] = p->receiver_weight;
}

static double levels_of(double mean, double error)
{
	return 127.5 * (transfer_encode(TRANSFER_SRGB, mean + error) -
			transfer_encode(TRANSFER_SRGB, mean - error));
}

double tile_noise_judge(struct tile *tile)
{
	const double n = tile->batches;

	tile->noise_square = 0;
	tile->noise_count = 0;
	for (int at = 0; at < TILE_PIXELS && tile->batches > 1; at++) {
		const struct tile_pixel *p = &tile->pixels[at];

		if (!p->changed)
			continue;
		for (int c = 0; c < 3; c++) {
			const double e = levels_of(p->mean[c], sqrt(p->spread[c] / (n * (n - 1))));

			tile->noise_square += e * e;
			tile->noise_count++;
		}
	}
	return tile->noise_count ? sqrt(tile->noise_square / (double)tile->noise_count) : 0;
}
