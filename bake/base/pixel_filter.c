/* SPDX-License-Identifier: MIT */
#include "bake/base/pixel_filter.h"

#include <math.h>

#define REACH 7.0 /* sigma: what lies beyond has a weight below 2^-32 */
#define CLOSE_PX 1e-9
#define STEPS_MOST 100 /* bisection alone needs 37 */

static double normal_below(double v)
{
	return 0.5 * erfc(-v * M_SQRT1_2);
}

/* z(v) of a Gaussian of deviation s. */
static double spread_ramp(double v, double s)
{
	const double n = v / s;

	return v * normal_below(n) + s * exp(-0.5 * n * n) / sqrt(2 * M_PI);
}

/* Newton's method, by bisection where a step would leave the bracket. */
double pixel_filter_place(double sigma_px, double unit)
{
	double low = -REACH * sigma_px, high = 1 + REACH * sigma_px, t = unit;

	if (!(sigma_px > 0))
		return unit;
	for (int i = 0; i < STEPS_MOST && high - low > CLOSE_PX; i++) {
		const double off = spread_ramp(t, sigma_px) - spread_ramp(t - 1, sigma_px) - unit;
		const double slope = normal_below(t / sigma_px) - normal_below((t - 1) / sigma_px);
		const double next = t - off / slope;

		if (off > 0)
			high = t;
		else
			low = t;
		if (fabs(next - t) < CLOSE_PX)
			return next;
		t = next > low && next < high ? next : (low + high) / 2;
	}
	return t;
}
