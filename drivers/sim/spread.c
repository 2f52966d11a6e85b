/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <math.h>
#include <stddef.h>

enum { REACH_MAX = (int)(4 * SPREAD_MAX_PX) + 1 };

/* Modified Bessel function of the first kind, I_n(t), by its series. */
static double bessel_i(int n, double t)
{
	double term = 1, sum;

	for (int k = 1; k <= n; k++)
		term *= t / 2 / k;
	sum = term;
	for (int m = 1; term > 1e-17 * sum; m++) {
		term *= t * t / 4 / ((double)m * (m + n));
		sum += term;
	}
	return sum;
}

static int spread_weights(double sigma_px, float weight[REACH_MAX + 1])
{
	const int reach = (int)fmin(ceil(4 * sigma_px) + 1, REACH_MAX);
	double w[REACH_MAX + 1], sum = 0;

	for (int i = 0; i <= reach; i++) {
		w[i] = bessel_i(i, sigma_px * sigma_px);
		sum += (i ? 2 : 1) * w[i];
	}
	for (int i = 0; i <= reach; i++)
		weight[i] = (float)(w[i] / sum);
	return reach;
}

static int spread_inside(int i, int count)
{
	return i < 0 ? 0 : i < count ? i : count - 1;
}

/* One line of count values, `step` floats apart. */
static void spread_line(const float *from, int count, ptrdiff_t step, const float *weight,
			int reach, float *to)
{
	for (int i = 0; i < count; i++) {
		float sum = weight[0] * from[i * step];

		for (int k = 1; k <= reach; k++)
			sum += weight[k] * (from[spread_inside(i - k, count) * step] +
					    from[spread_inside(i + k, count) * step]);
		to[i * step] = sum;
	}
}

void spread_edges(const float *rgb, int width, int height, double sigma_px, float *scratch,
		  float *to)
{
	const ptrdiff_t row = 3 * (ptrdiff_t)width;
	float weight[REACH_MAX + 1];
	const int reach = spread_weights(sigma_px, weight);

	for (int y = 0; y < height; y++)
		for (int c = 0; c < 3; c++)
			spread_line(rgb + y * row + c, width, 3, weight, reach,
				    scratch + y * row + c);
	for (ptrdiff_t x = 0; x < row; x++)
		spread_line(scratch + x, height, row, weight, reach, to + x);
}
