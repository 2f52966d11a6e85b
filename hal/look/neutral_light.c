/* SPDX-License-Identifier: MIT */
#include "hal/look/neutral_light.h"

void neutral_light(double (*radiance)[3], int count, double share)
{
	for (int i = 0; i < count; i++) {
		double *l = radiance[i];
		const double luminance = 0.2126 * l[0] + 0.7152 * l[1] + 0.0722 * l[2];

		for (int c = 0; c < 3; c++)
			l[c] += share * (luminance - l[c]);
	}
}
