/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <math.h>

double mains_row(const struct mains *mains, double time_s, int y, int height)
{
	const double t = time_s + mains->readout_s * y / height;
	const double half = 2 * M_PI * mains->hz * mains->shutter_s;
	const double sinc = half > 0 ? sin(half) / half : 1;

	if (mains->depth == 0)
		return 1;
	return 1 + mains->depth * sinc * cos(4 * M_PI * mains->hz * (t + mains->shutter_s / 2));
}
