/* SPDX-License-Identifier: MIT */
/* From grey levels of the fisheye's picture to radiance. */
#include "app/pipeline/pipeline_parts.h"

double pipeline_gain_of_grey(const struct light_sampler_settings *s)
{
	double sum = 0;

	for (int k = 0; k < 9; k++)
		sum += s->colours[k];
	return sum > 0 ? s->gain * sum / 3 : s->gain;
}

double pipeline_linear_level(const struct light_sampler_settings *s, double level)
{
	return transfer_curve_decode(&s->curve, level / 255) * pipeline_gain_of_grey(s);
}

double pipeline_band_below(const struct light_sampler_settings *s, double threshold)
{
	const double below = pipeline_linear_level(s, threshold - 1);
	const double rounding = below * 0x1p-13 + pipeline_gain_of_grey(s) * 0x1p-15;

	return pipeline_linear_level(s, threshold) - below + rounding;
}
