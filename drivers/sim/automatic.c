/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "drivers/sim/sim.h"

static void automatic_meter(const float *rgb, size_t count, double exposure, double mean[3])
{
	for (int c = 0; c < 3; c++) {
		mean[c] = 0;
		for (size_t i = 0; i < count; i++)
			mean[c] += exposure * (double)rgb[3 * i + (size_t)c] / (double)count;
	}
}

/* Moves s towards its goal. Where nothing is seen there is no goal. */
static void automatic_follow(double *s, double wanted, double share)
{
	if (isfinite(wanted))
		*s += share * (wanted - *s);
}

static double automatic_stepped(double s, double step)
{
	return step > 0 ? step * rint(s / step) : s;
}

static void automatic_take(struct automatic *a, const double mean[3], double share)
{
	const double grey = (mean[0] + mean[1] + mean[2]) / 3;

	if (a->settings.level > 0)
		automatic_follow(&a->exposure, log2(a->settings.level / grey), share);
	for (int c = 0; a->settings.white && c < 3; c += 2)
		automatic_follow(&a->white[c], log2(mean[1] / mean[c]), share);
}

void automatic_gain(struct automatic *a, const float *rgb, size_t count, double exposure,
		    double period_s, float gain[3])
{
	const double step = a->settings.step_stops;
	double mean[3];

	automatic_meter(rgb, count, exposure, mean);
	if (!a->begun)
		automatic_take(a, mean, 1);
	a->begun = true;
	for (int c = 0; c < 3; c++)
		gain[c] = (float)exp2(automatic_stepped(a->exposure, step) +
				      automatic_stepped(a->white[c], step));
	automatic_take(a, mean,
		       a->settings.time_s > 0 ? -expm1(-period_s / a->settings.time_s) : 1);
}

double mains_row(const struct mains *mains, double time_s, int y, int height)
{
	const double t = time_s + mains->readout_s * y / height;
	const double half = 2 * M_PI * mains->hz * mains->shutter_s;
	const double sinc = half > 0 ? sin(half) / half : 1;

	if (mains->depth == 0)
		return 1;
	return 1 + mains->depth * sinc * cos(4 * M_PI * mains->hz * (t + mains->shutter_s / 2));
}
