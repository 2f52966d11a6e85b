/* SPDX-License-Identifier: MIT */
#include "hal/look/sensor_noise.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

enum { SIDE = 8, PIXELS = SIDE * SIDE, BLOCKS = 96, LEVELS = 16, STEPS = 96 };

/* Variances of code values from 2^LOWEST on, in STEPS steps of a quarter of an octave. */
#define LOWEST (-10)
#define STEPS_AN_OCTAVE 4
/* A frame's share of what is remembered: about 500 frames are. */
#define FORGETTING 0.998
#define ENOUGH 40.0 /* blocks that a level needs to count */

struct block {
	int x, y;
	uint8_t before[3][PIXELS]; /* code values, R G B */
};

struct sensor_noise {
	struct transfer_curve curve;
	struct block blocks[BLOCKS];
	bool begun;
	float seen[3][LEVELS][STEPS]; /* how many blocks had a variance */
	double median[3][LEVELS];     /* of seen, before the present frame */
	/* Sums over ordinary blocks: of variances and of covariances. */
	double own, across, down, pair, of_pair;
};

int sensor_noise_create(struct sensor_noise **noise, int width, int height,
			const struct transfer_curve *curve)
{
	struct sensor_noise *n;

	if (width < SIDE || height < SIDE)
		return -EINVAL;
	n = calloc(1, sizeof(*n));
	if (!n)
		return -ENOMEM;
	n->curve = *curve;
	/* A sequence of low discrepancy: multiples of the plastic number's powers (Roberts 2018). */
	for (int i = 0; i < BLOCKS; i++) {
		n->blocks[i].x = (int)(fmod(0.5 + i * 0.7548776662466927, 1) * (width - SIDE));
		n->blocks[i].y = (int)(fmod(0.5 + i * 0.5698402909980532, 1) * (height - SIDE));
	}
	*noise = n;
	return 0;
}

void sensor_noise_destroy(struct sensor_noise *noise)
{
	free(noise);
}

/* Differences of a block to the frame before, per channel; their variance; and its mean level. */
struct difference {
	int16_t d[3][PIXELS];
	int sum[3];
	double variance[3], level[3];
};

static void block_read(struct block *b, const struct picture *picture, struct difference *to)
{
	for (int y = 0; y < SIDE; y++) {
		const uint8_t *in = picture->origin + (b->y + y) * picture->y_step +
				    b->x * picture->x_step;

		for (int x = 0; x < SIDE; x++, in += picture->x_step)
			for (int c = 0; c < 3; c++) {
				uint8_t *before = &b->before[c][y * SIDE + x];

				to->d[c][y * SIDE + x] = (int16_t)(in[2 - c] - *before);
				*before = in[2 - c];
			}
	}
}

/* Sum of products of n differences. */
static int sum_products(const int16_t *restrict a, const int16_t *restrict b, int n)
{
	int sum = 0;

	for (int i = 0; i < n; i++)
		sum += a[i] * b[i];
	return sum;
}

static void block_compare(struct block *b, const struct picture *picture, struct difference *to)
{
	block_read(b, picture, to);
	for (int c = 0; c < 3; c++) {
		const int squares = sum_products(to->d[c], to->d[c], PIXELS);
		int sum = 0, level = 0;

		for (int i = 0; i < PIXELS; i++) {
			sum += to->d[c][i];
			level += b->before[c][i];
		}
		to->sum[c] = sum;
		to->level[c] = level / (double)PIXELS;
		to->variance[c] = (squares - sum * sum / (double)PIXELS) / (PIXELS - 1);
	}
}

static int step_of(double variance)
{
	const double step = variance > 0 ? (log2(variance) - LOWEST) * STEPS_AN_OCTAVE : 0;

	return step < 0 ? 0 : step >= STEPS ? STEPS - 1 : (int)step;
}

static int level_of(double code)
{
	return (int)(code * LEVELS / 256);
}

/* Median of a level's variances, of the difference of two frames; -1: too few blocks. */
static double level_median(const float seen[STEPS])
{
	double total = 0, below = 0;

	for (int i = 0; i < STEPS; i++)
		total += seen[i];
	if (total < ENOUGH)
		return -1;
	for (int i = 0; i < STEPS; i++) {
		if (below + seen[i] >= total / 2)
			return i ? exp2(LOWEST +
					(i + (total / 2 - below) / seen[i]) / STEPS_AN_OCTAVE)
				 : 0;
		below += seen[i];
	}
	return -1;
}

/* Mean product of each difference, less the mean, and the one step pixels on, for those that have one in
 * the block: the first n of each group of `group` pixels. */
static double mean_product(const struct difference *d, int c, int step, int n, int group)
{
	const double mean = d->sum[c] / (double)PIXELS;
	const int16_t *own = d->d[c];
	int products = 0, ends = 0, pairs = 0;

	for (int from = 0; from < PIXELS; from += group) {
		products += sum_products(own + from, own + from + step, n);
		for (int i = from; i < from + n; i++)
			ends += own[i] + own[i + step];
		pairs += n;
	}
	return (products - mean * ends) / pairs + mean * mean;
}

/* Adds what neighbouring pixels and channels of an ordinary block have in common. */
static void note_common(struct sensor_noise *n, const struct difference *d)
{
	for (int c = 0; c < 3; c++) {
		const int other = (c + 1) % 3;
		const double pair = sum_products(d->d[c], d->d[other], PIXELS) -
				    d->sum[c] * d->sum[other] / (double)PIXELS;

		n->own += d->variance[c];
		n->across += mean_product(d, c, 1, SIDE - 1, SIDE);
		n->down += mean_product(d, c, SIDE, PIXELS - SIDE, PIXELS);
		n->pair += pair / PIXELS;
		n->of_pair += sqrt(d->variance[c] * d->variance[other]);
	}
}

static bool is_ordinary(const struct sensor_noise *n, const struct difference *d)
{
	for (int c = 0; c < 3; c++) {
		const double median = n->median[c][level_of(d->level[c])];

		if (median <= 0 || d->variance[c] > 2 * median || d->variance[c] < median / 2)
			return false;
	}
	return true;
}

void sensor_noise_watch(struct sensor_noise *n, const struct picture *picture)
{
	struct difference d;

	for (int c = 0; c < 3; c++)
		for (int l = 0; l < LEVELS; l++) {
			for (int i = 0; i < STEPS; i++)
				n->seen[c][l][i] *= (float)FORGETTING;
			n->median[c][l] = level_median(n->seen[c][l]);
		}
	n->own *= FORGETTING;
	n->across *= FORGETTING;
	n->down *= FORGETTING;
	n->pair *= FORGETTING;
	n->of_pair *= FORGETTING;
	for (int i = 0; i < BLOCKS; i++) {
		block_compare(&n->blocks[i], picture, &d);
		if (!n->begun)
			continue;
		if (is_ordinary(n, &d))
			note_common(n, &d);
		for (int c = 0; c < 3; c++)
			n->seen[c][level_of(d.level[c])][step_of(d.variance[c])] += 1;
	}
	n->begun = true;
}

/* Linear light of a code value, white is 1, and its slope. */
static double light_of(const struct sensor_noise *n, double code, double *slope)
{
	const double low = fmax(code - 1, 0), high = fmin(code + 1, 255);

	*slope = (transfer_curve_decode(&n->curve, high / 255) -
		  transfer_curve_decode(&n->curve, low / 255)) /
		 (high - low);
	return transfer_curve_decode(&n->curve, code / 255);
}

/* Least squares of sigma^2 = floor + slope L over the levels, each weighted by 1 / sigma^4: that is
 * how far a variance is known. Both are at least 0. Returns how many levels count. */
static int fit_channel(const struct sensor_noise *n, int c, double *floor, double *slope)
{
	double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, apart;
	int count = 0;

	for (int l = 0; l < LEVELS - 1; l++) { /* the last one clips */
		const double code = (l + 0.5) * 256 / LEVELS, median = level_median(n->seen[c][l]);
		double per_code, x, y, weight;

		if (median < 0)
			continue;
		x = light_of(n, code, &per_code);
		y = fmax(median / 2 - 1.0 / 12, 0) * per_code * per_code;
		weight = 1 / (y * y + 1e-14);
		s += weight;
		sx += weight * x;
		sy += weight * y;
		sxx += weight * x * x;
		sxy += weight * x * y;
		count++;
	}
	if (!count)
		return 0;
	apart = s * sxx - sx * sx;
	*slope = count > 1 && apart > 1e-9 * s * sxx ? fmax((s * sxy - sx * sy) / apart, 0) : 0;
	*floor = (sy - *slope * sx) / s;
	if (*floor < 0) {
		*floor = 0;
		*slope = fmax(sxy / sxx, 0);
	}
	return count;
}

static double share_of(double part, double whole)
{
	return whole > 0 ? fmin(fmax(part / whole, 0), 0.98) : 0;
}

bool sensor_noise_fit(const struct sensor_noise *n, struct sensor_noise_model *model)
{
	struct sensor_noise_model found;

	for (int c = 0; c < 3; c++)
		if (!fit_channel(n, c, &found.floor[c], &found.slope[c]))
			return false;
	found.across = share_of(n->across, n->own);
	found.down = share_of(n->down, n->own);
	found.channels = share_of(n->pair, n->of_pair);
	*model = found;
	return true;
}
