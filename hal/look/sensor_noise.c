/* SPDX-License-Identifier: MIT */
#include "hal/look/sensor_noise.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

enum { SIDE = 8, PIXELS = SIDE * SIDE, BLOCKS = 96, LEVELS = 16, STEPS = 96 };

/* A histogram of variances (of code values) begins at 2^LOWEST and has STEPS steps of a quarter of
 * an octave: up to 2^14, the variance of codes that are 0 or 255 at random. */
#define LOWEST (-10)
#define STEPS_AN_OCTAVE 4
/* Older frames fade by this factor a frame, so that 1 / (1 - 0.998) = 500 frames count. */
#define FADING 0.998
#define BLOCKS_LEAST 40.0 /* a level's median needs this many blocks; chosen by trial */

struct block {
	int x, y;
	uint8_t before[3][PIXELS]; /* code values of the frame before, R, G, B */
};

struct sensor_noise {
	struct transfer_curve curve;
	struct block blocks[BLOCKS];
	bool begun;
	float histogram[3][LEVELS][STEPS]; /* number of blocks by level and variance */
	double median[3][LEVELS];	   /* each histogram's median before the present frame */
	/* Sums over ordinary blocks of variances, of covariances with the pixel to the right and
	 * the one below, of covariances of two channels, and of the product of their deviations. */
	double variance, across, down, channels, channel_scale;
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
	/* Multiples of the plastic number's inverse powers are a low-discrepancy sequence, R2 of
	 * Roberts 2018: they cover the picture evenly. */
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

/* Differences d of a block's pixels to the frame before, their sum and variance, and the block's
 * mean code value, by channel. */
struct difference {
	int16_t d[3][PIXELS];
	int sum[3];
	double variance[3], level[3];
};

/* Takes the differences to the frame before, and keeps the present frame for the next. */
static void block_subtract(struct block *b, const struct picture *picture, struct difference *to)
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

static int sum_products(const int16_t *restrict a, const int16_t *restrict b, int n)
{
	int sum = 0;

	for (int i = 0; i < n; i++)
		sum += a[i] * b[i];
	return sum;
}

static void block_compare(struct block *b, const struct picture *picture, struct difference *to)
{
	block_subtract(b, picture, to);
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

static int histogram_step(double variance)
{
	const double step = variance > 0 ? (log2(variance) - LOWEST) * STEPS_AN_OCTAVE : 0;

	return step < 0 ? 0 : step >= STEPS ? STEPS - 1 : (int)step;
}

static int level_index(double code)
{
	return (int)(code * LEVELS / 256);
}

/* Returns the median variance of a histogram, interpolated in its step, or -1 if it has too few
 * blocks. It is that of the difference of two frames: twice the noise's. */
static double histogram_median(const float histogram[STEPS])
{
	double total = 0, below = 0;

	for (int i = 0; i < STEPS; i++)
		total += histogram[i];
	if (total < BLOCKS_LEAST)
		return -1;
	for (int i = 0; i < STEPS; i++) {
		if (below + histogram[i] >= total / 2)
			return i ? exp2(LOWEST +
					(i + (total / 2 - below) / histogram[i]) / STEPS_AN_OCTAVE)
				 : 0;
		below += histogram[i];
	}
	return -1;
}

/* Returns the covariance of a difference and the one `step` pixels on:
 *
 *     mean of (d[i] - m) (d[i + step] - m), m = mean of d
 *
 * over the first n pixels of each run of `group` pixels, which have such a neighbour. */
static double covariance_at(const struct difference *d, int c, int step, int n, int group)
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

/* Adds the variances and covariances of an ordinary block to the sums. */
static void add_covariances(struct sensor_noise *n, const struct difference *d)
{
	for (int c = 0; c < 3; c++) {
		const int other = (c + 1) % 3;
		const double pair = sum_products(d->d[c], d->d[other], PIXELS) -
				    d->sum[c] * d->sum[other] / (double)PIXELS;

		n->variance += d->variance[c];
		n->across += covariance_at(d, c, 1, SIDE - 1, SIDE);
		n->down += covariance_at(d, c, SIDE, PIXELS - SIDE, PIXELS);
		n->channels += pair / PIXELS;
		n->channel_scale += sqrt(d->variance[c] * d->variance[other]);
	}
}

/* Tells whether a block's variance is within a factor of 2 of the median of its level in all
 * channels, so that nothing moves in it. */
static bool is_ordinary(const struct sensor_noise *n, const struct difference *d)
{
	for (int c = 0; c < 3; c++) {
		const double median = n->median[c][level_index(d->level[c])];

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
				n->histogram[c][l][i] *= (float)FADING;
			n->median[c][l] = histogram_median(n->histogram[c][l]);
		}
	n->variance *= FADING;
	n->across *= FADING;
	n->down *= FADING;
	n->channels *= FADING;
	n->channel_scale *= FADING;
	for (int i = 0; i < BLOCKS; i++) {
		block_compare(&n->blocks[i], picture, &d);
		if (!n->begun)
			continue;
		if (is_ordinary(n, &d))
			add_covariances(n, &d);
		for (int c = 0; c < 3; c++)
			n->histogram[c][level_index(d.level[c])][histogram_step(d.variance[c])] +=
				1;
	}
	n->begun = true;
}

/* Returns the linear light of a code value (white is 1), and its slope per code value. */
static double code_light(const struct sensor_noise *n, double code, double *slope)
{
	const double low = fmax(code - 1, 0), high = fmin(code + 1, 255);

	*slope = (transfer_curve_decode(&n->curve, high / 255) -
		  transfer_curve_decode(&n->curve, low / 255)) /
		 (high - low);
	return transfer_curve_decode(&n->curve, code / 255);
}

/* Fits sigma^2 = floor + slope L to the levels by least squares, with floor and slope at least 0. A
 * level's weight is 1 / sigma^4, as the error of a variance is proportional to the variance. Half
 * of a difference's variance is one frame's; rounding to code values adds 1/12 to that. Returns the
 * number of levels used. */
static int fit_channel(const struct sensor_noise *n, int c, double *floor, double *slope)
{
	double s = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, determinant;
	int count = 0;

	for (int l = 0; l < LEVELS - 1; l++) { /* the last one clips */
		const double code = (l + 0.5) * 256 / LEVELS;
		const double median = histogram_median(n->histogram[c][l]);
		double per_code, x, y, weight;

		if (median < 0)
			continue;
		x = code_light(n, code, &per_code);
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
	determinant = s * sxx - sx * sx;
	*slope = count > 1 && determinant > 1e-9 * s * sxx
			 ? fmax((s * sxy - sx * sy) / determinant, 0)
			 : 0;
	*floor = (sy - *slope * sx) / s;
	if (*floor < 0) {
		*floor = 0;
		*slope = fmax(sxy / sxx, 0);
	}
	return count;
}

/* Limits a correlation to 0..0.98, so that sqrt(1 - r^2) of the grain stays well above 0. */
static double correlation(double part, double whole)
{
	return whole > 0 ? fmin(fmax(part / whole, 0), 0.98) : 0;
}

bool sensor_noise_fit(const struct sensor_noise *n, struct sensor_noise_model *model)
{
	struct sensor_noise_model found;

	for (int c = 0; c < 3; c++)
		if (!fit_channel(n, c, &found.floor[c], &found.slope[c]))
			return false;
	found.across = correlation(n->across, n->variance);
	found.down = correlation(n->down, n->variance);
	found.channels = correlation(n->channels, n->channel_scale);
	*model = found;
	return true;
}
