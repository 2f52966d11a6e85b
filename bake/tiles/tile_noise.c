/* SPDX-License-Identifier: MIT */
#include "bake/tiles/tile_noise.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/colour/transfer.h"

#define LANES 8		/* a row has this many partial sums, so that additions do not wait */
#define BLOCKS_FEWEST 4 /* fewer runs have too few differences for an estimate */
#define SCALES 3	/* runs are compared at three lengths: 1, 2 and 4 blocks */
/* The least q: the mean of n samples of smooth light is off by 1 / n^1.5, so V falls to a
 * quarter. */
#define FALL_LEAST 0.25

int tile_noise_create(struct tile *tile)
{
	tile->noise = malloc(sizeof(*tile->noise));
	return tile->noise ? 0 : -ENOMEM;
}

void tile_noise_clear(struct tile *tile)
{
	memset(tile->noise, 0, sizeof(*tile->noise));
	tile->noise->batches_each = 1;
}

static void join_sums(float *sum)
{
	for (int k = 0; k < TILE_NOISE_BLOCKS; k++)
		sum[k] = k < TILE_NOISE_BLOCKS / 2 ? sum[2 * k] + sum[2 * k + 1] : 0;
}

/* Joins the runs in pairs. */
static void join_blocks(struct tile_noise *n)
{
	struct tile_noise_value *v = n->value[0][0];

	for (int at = 0; at < TILE_PIXELS * 3 * ENSEMBLE_SUNS; at++, v++) {
		join_sums(v->all);
		join_sums(v->rest);
	}
	for (int k = 0; k < TILE_NOISE_BLOCKS; k++)
		n->samples[k] = k < TILE_NOISE_BLOCKS / 2
					? n->samples[2 * k] + n->samples[2 * k + 1]
					: 0;
	n->blocks /= 2;
	n->batches_each *= 2;
}

void tile_noise_begin(struct tile *tile, int samples)
{
	struct tile_noise *n = tile->noise;

	if (!n->blocks || n->batches == n->batches_each) {
		if (n->blocks == TILE_NOISE_BLOCKS)
			join_blocks(n);
		n->blocks++;
		n->batches = 0;
	}
	n->batches++;
	n->samples[n->blocks - 1] += samples;
}

/* ---- a batch ---- */

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

/* Returns the factors [lights] of a kind's direct values under a uniform sky of radiance 1. Blocked
 * light on flat ground is counted in whole cells; all other values are radiance. */
static const float *direct_sky(const struct tile *tile, enum tile_kind kind)
{
	return kind == TILE_CHANGE && !tile_has_standins(tile) ? tile->cells->share
							       : tile->even_sky;
}

/* Computes a kind's light of the last batch in one pixel and channel, under each sun: [0] is all of
 * it, [1] the bounced light of the sun's cell. */
static void sum_kind(struct tile *tile, enum tile_kind kind, int at, int c,
		     double sum[ENSEMBLE_SUNS][TILE_KINDS][2])
{
	const struct tile_rows *rows = &tile->rows[kind];
	const struct ensemble *ensemble = tile->settings.ensemble;
	const size_t count = (size_t)tile->cells->count;
	const size_t own = (size_t)at * tile_bounce_size(tile) + (size_t)c * count;
	const float *sky = direct_sky(tile, kind);
	const float *direct = rows->direct + (size_t)at * tile_direct_size(tile, kind) +
			      (rows->channels == 3 ? (size_t)c * count : 0);
	const float *bounce[2] = {rows->bounce[0] + own, rows->bounce[1] + own};
	const double even = sum_row(direct, sky, (int)count) +
			    sum_row(bounce[0], tile->even_sky, (int)count) +
			    sum_row(bounce[1], tile->even_sky, (int)count);

	for (int k = 0; k < ENSEMBLE_SUNS; k++) {
		const int cell = ensemble->sun[k].cell;
		const double sun = ensemble->sun[k].radiance;
		const double aside = sun * ((double)bounce[0][cell] + (double)bounce[1][cell]);
		const double of[2] = {even * ensemble_blue[c] + aside +
					      sun * (double)direct[cell] * (double)sky[cell],
				      aside};

		for (int part = 0; part < 2; part++) {
			float *before = &tile->noise->before[at][c][k][kind][part];

			sum[k][kind][part] = of[part] - (double)*before;
			*before = (float)of[part];
		}
	}
}

/* Weights of the background in the last batch. */
struct batch_weight {
	double other, receiver; /* as in struct tile_pixel */
	double shown[3];	/* weight of the background in each channel */
};

static struct batch_weight weigh_batch(struct tile *tile, int at)
{
	const struct tile_pixel *p = &tile->pixels[at];
	const double now[6] = {p->other_weight, p->receiver_weight, p->through_weight,
			       p->through[0],	p->through[1],	    p->through[2]};
	double fresh[6];

	for (int k = 0; k < 6; k++) {
		fresh[k] = now[k] - tile->noise->before_weight[at][k];
		tile->noise->before_weight[at][k] = now[k];
	}
	return (struct batch_weight){
		.other = fresh[0],
		.receiver = fresh[1],
		/* The weight beside the object, plus the transmission through it. */
		.shown = {fresh[0] - fresh[2] + fresh[3], fresh[0] - fresh[2] + fresh[4],
			  fresh[0] - fresh[2] + fresh[5]},
	};
}

/* Returns (ground's light with the object) / (without) - 1, and in *bounce the part of it that is
 * bounced light. ground is the light that white ground sends back. */
static double ground_change(const struct tile *tile, const struct batch_weight *w,
			    const double sum[TILE_KINDS][2], double ground, double *bounce)
{
	const double *with = sum[TILE_CHANGE], *without = sum[TILE_WITHOUT];
	double scale;

	*bounce = 0;
	if (w->receiver <= 0 || (tile_has_standins(tile) && without[0] <= 0))
		return 0;
	if (!tile_has_standins(tile)) {
		scale = -1 / (w->other * ground);
		*bounce = scale * with[1];
		return scale * with[0];
	}
	scale = w->receiver / (w->other * without[0]);
	*bounce = scale * (with[1] - without[1]);
	return scale * (with[0] - without[0]);
}

void tile_noise_add(struct tile *tile, int at)
{
	struct tile_noise *n = tile->noise;
	const struct tile_pixel *p = &tile->pixels[at];
	const struct batch_weight w = weigh_batch(tile, at);
	const int block = n->blocks - 1;

	for (int c = 0; tile->settings.ensemble && c < 3; c++) {
		double sum[ENSEMBLE_SUNS][TILE_KINDS][2] = {0};

		for (int kind = 0; kind < TILE_KINDS; kind++)
			if (tile->rows[kind].direct &&
			    (kind == TILE_OBJECT ? p->object : p->receiver))
				sum_kind(tile, (enum tile_kind)kind, at, c, sum);
		for (int k = 0; k < ENSEMBLE_SUNS; k++) {
			const struct ensemble_sun *sun = &tile->settings.ensemble->sun[k];
			const double ground = ensemble_blue[c] +
					      sun->radiance * (double)tile->cells->share[sun->cell];
			const double back = w.shown[c] * tile->scene->ground_albedo[c] * ground;
			double bounce;
			const double change = ground_change(tile, &w, sum[k], ground, &bounce);
			struct tile_noise_value *v = &n->value[at][c][k];

			const double all = sum[k][TILE_OBJECT][0] + back * fmax(1 + change, 0);

			v->all[block] += (float)(all / sun->white);
			v->rest[block] += (float)((all - sum[k][TILE_OBJECT][1] - back * bounce) /
						  sun->white);
		}
	}
}

/* ---- the filter ---- */

/* Returns the factor by which bounced light in a kind's row, at the cell of sun k, adds to the
 * picture. */
static double shown_bounce(const struct tile *tile, enum tile_kind kind, int at, int c, int k)
{
	const struct tile_noise *n = tile->noise;
	const struct ensemble_sun *sun = &tile->settings.ensemble->sun[k];
	const double *weight = n->before_weight[at];
	const double shown = (weight[0] - weight[2] + weight[3 + c]) / tile->samples;
	const double share = (double)tile->cells->shown[sun->cell];
	const double back = shown * tile->scene->ground_albedo[c];
	const double without = (double)n->before[at][c][k][TILE_WITHOUT][0];

	if (kind == TILE_OBJECT)
		return sun->radiance / sun->white;
	if (!tile_has_standins(tile))
		return -back * sun->radiance * share / sun->white;
	return without > 0 ? -back * (ensemble_blue[c] + sun->radiance * share) * sun->radiance *
				     weight[1] / (without * sun->white)
			   : 0;
}

void tile_noise_filtered(struct tile *tile, enum tile_kind kind, const uint16_t *pixel, int pixels)
{
	const struct ensemble *ensemble = tile->settings.ensemble;
	const size_t count = (size_t)tile->cells->count;

	/* The noise of light without the object counts only as far as the object changes it:
	 * little. */
	if (!ensemble || kind == TILE_WITHOUT)
		return;
	tile->noise->filtered = true;
	for (int row = 0; row < 3 * pixels; row++)
		for (int k = 0; k < ENSEMBLE_SUNS; k++) {
			const int at = pixel[row / 3], c = row % 3;
			const double by = shown_bounce(tile, kind, at, c, k);

			for (int half = 0; half < 2; half++)
				tile->noise->value[at][c][k].filtered[half] +=
					(float)(by *
						(double)tile->rows[kind]
							.bounce[half]
							       [(size_t)row * count +
								(size_t)ensemble->sun[k].cell]);
		}
}

/* ---- the estimate ---- */

/* Accepts even numbers of runs only: two runs together form a (t, m, 2)-net, an odd run stays
 * alone. */
bool tile_noise_ready(const struct tile *tile)
{
	const struct tile_noise *n = tile->noise;

	return n->blocks >= BLOCKS_FEWEST && n->blocks % 2 == 0 && n->batches == n->batches_each;
}

/* Returns the mean square of the changes, in levels, by an error up and by one down. */
static double level_square(double mean, double error)
{
	const double is = transfer_encode(TRANSFER_SRGB, mean);
	const double up = 255 * (transfer_encode(TRANSFER_SRGB, mean + error) - is);
	const double down = 255 * (is - transfer_encode(TRANSFER_SRGB, mean - error));

	return (up * up + down * down) / 2;
}

/* D of runs of 2^s blocks. */
struct noise_law {
	double square[SCALES]; /* D as squared errors in levels, summed over values */
	int pairs[SCALES];     /* number of pairs of runs that are compared */
	double filtered;       /* squared errors of filtered light, summed over values */
};

/* Returns D of runs of `length` blocks: the mean over their pairs. */
static double run_difference(const struct tile_noise *n, const float *sum, int length, int *pairs)
{
	double square = 0;

	*pairs = 0;
	for (int first = 0; first + 2 * length <= n->blocks; first += 2 * length, ++*pairs) {
		double run[2] = {0}, samples[2] = {0};

		for (int k = 0; k < 2 * length; k++) {
			run[k / length] += (double)sum[first + k];
			samples[k / length] += n->samples[first + k];
		}
		square += pow(run[0] / samples[0] - run[1] / samples[1], 2) /
			  (1 / samples[0] + 1 / samples[1]);
	}
	return *pairs ? square / *pairs : 0;
}

/* Adds the errors of one value to the law. all is the number of samples. */
static void add_value(struct tile_noise *n, const struct tile_noise_value *v, double all,
		      struct noise_law *law)
{
	const float *sum = n->filtered ? v->rest : v->all;
	double mean = 0, found[SCALES], scale;

	for (int k = 0; k < n->blocks; k++)
		mean += (double)sum[k] / all;
	mean += (double)v->filtered[0];
	for (int s = 0; s < SCALES; s++)
		found[s] = run_difference(n, sum, 1 << s, &law->pairs[s]);
	n->count++;
	if (n->filtered)
		law->filtered += level_square(mean, (double)v->filtered[1]);
	if (found[0] <= 0)
		return;
	scale = level_square(mean, sqrt(found[0] / all)) / found[0];
	for (int s = 0; s < SCALES; s++)
		law->square[s] += scale * found[s];
}

/* Returns V of `blocks` blocks / V of one. The blocks divide into runs of powers of two, each a net
 * by itself. */
static double variance_ratio(int blocks, double q)
{
	double sum = 0;

	for (int s = 0; 1 << s <= blocks; s++)
		if (blocks >> s & 1)
			sum += (1 << s) * pow(q, s);
	return sum / blocks;
}

/* Returns the squared error of all samples: q is fitted to D at all lengths, and V extrapolated. */
static double law_error(const struct noise_law *law, int blocks)
{
	double q = 1, sum = 0;
	int scales = 0, pairs = 0;

	while (scales < SCALES && law->square[scales] > 0)
		scales++;
	if (scales > 1)
		q = pow(law->square[scales - 1] / law->square[0], 1.0 / (scales - 1));
	q = fmin(fmax(q, FALL_LEAST), 1);
	for (int s = 0; s < scales; s++) {
		sum += law->pairs[s] * law->square[s] / ((2 - q) * pow(q, s));
		pairs += law->pairs[s];
	}
	return law->filtered + (pairs ? sum / pairs * variance_ratio(blocks, q) : 0);
}

double tile_noise_judge(struct tile *tile)
{
	struct tile_noise *n = tile->noise;
	struct noise_law law = {.pairs = {0}};
	double all = 0;

	n->count = 0;
	for (int k = 0; k < n->blocks; k++)
		all += n->samples[k];
	for (int at = 0; at < TILE_PIXELS && n->blocks > 1; at++)
		for (int c = 0; tile->pixels[at].changed && c < 3; c++)
			for (int k = 0; k < ENSEMBLE_SUNS; k++)
				add_value(n, &n->value[at][c][k], all, &law);
	n->square = law_error(&law, n->blocks);
	return n->count ? sqrt(n->square / (double)n->count) : 0;
}
