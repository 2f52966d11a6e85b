/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/bracket/light_merge.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>

#include "hal/lights/pixel_noise.h"

#define DARK_TO 0.04 /* of the range: weights rise from black to there */

/* Smooth step from 0 to 1. */
static double fade(double x)
{
	x = fmin(fmax(x, 0), 1);
	return x * x * (3 - 2 * x);
}

struct merge_tables {
	double light[256], weight[256];
};

static void fill_tables(struct merge_tables *tables, const struct transfer_curve *curve)
{
	for (int c = 0; c < 256; c++) {
		const double u = (c - curve->black) / (255 - curve->black);

		tables->light[c] = transfer_curve_decode(curve, c / 255.0);
		tables->weight[c] = fade(u / DARK_TO) * pixel_believed(curve, c);
	}
}

int light_merge(struct light_merged *merged, const struct image *pictures, const double *times,
		int exposures, const struct transfer_curve *curve, struct fault *fault)
{
	const size_t values = 3 * (size_t)pictures[0].width * (size_t)pictures[0].height;
	struct merge_tables tables;
	int shortest = 0, longest = 0;

	*merged = (struct light_merged){.clipped = 0};
	if (image_create_f32(&merged->picture, pictures[0].width, pictures[0].height))
		return fault_say(fault, -ENOMEM, "not enough memory");
	fill_tables(&tables, curve);
	for (int j = 1; j < exposures; j++) {
		shortest = times[j] < times[shortest] ? j : shortest;
		longest = times[j] > times[longest] ? j : longest;
	}
	for (size_t i = 0; i < values; i++) {
		double sum = 0, total = 0;

		for (int j = 0; j < exposures; j++) {
			const int code = pictures[j].u8[i];

			/* w_j f / t_j, where w_j has t_j as a factor */
			sum += tables.weight[code] * tables.light[code];
			total += tables.weight[code] * times[j];
		}
		if (!(total > 0)) {
			const int brightest = pictures[shortest].u8[i];
			const bool bright = brightest > 127;
			const int j = bright ? shortest : longest;

			merged->clipped += bright / (double)values;
			merged->dark += !bright / (double)values;
			sum = tables.light[pictures[j].u8[i]];
			total = times[j];
		}
		merged->picture.f32[i] = (float)(sum / total);
	}
	return 0;
}
