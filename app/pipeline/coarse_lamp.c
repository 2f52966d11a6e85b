/* SPDX-License-Identifier: MIT */
#include "app/pipeline/coarse_lamp.h"

#include <math.h>

#include "hal/optics/vec.h"

#define CANDIDATES 4   /* the strongest cells, of which fine ones may be the first */
#define NEIGHBOURS 1.6 /* farthest, in distances of the nearest node */

static double light_of(const float rgb[3])
{
	return ((double)rgb[0] + (double)rgb[1] + (double)rgb[2]) / 3;
}

/* The share of a light above its neighbours, before the division by E; 0: it is a fine one. */
static double lamp_excess(const struct dome *dome, const float (*radiance)[3], int light)
{
	const double *here = dome->direction[light];
	double nearest = -1, limit, sum = 0;
	int count = 0;

	for (int i = 0; i < dome->count; i++)
		if (i != light)
			nearest = fmax(nearest, vec_dot(dome->direction[i], here));
	if (nearest > cos(COARSE_LAMP_APART_RAD))
		return 0;
	limit = cos(fmin(M_PI, NEIGHBOURS * acos(fmax(-1, nearest))));
	for (int i = 0; i < dome->count; i++)
		if (i != light && vec_dot(dome->direction[i], here) >= limit) {
			sum += light_of(radiance[i]);
			count++;
		}
	return (light_of(radiance[light]) - (count ? sum / count : 0)) * dome->projected_sr[light];
}

void coarse_lamp_find(struct coarse_lamp *lamp, const struct dome *dome, const float (*radiance)[3])
{
	const double least = lamp->there ? COARSE_LAMP_UNTIL : COARSE_LAMP_FROM;
	int strongest[CANDIDATES];
	double all = 0;
	int count = 0, best = -1;

	*lamp = (struct coarse_lamp){.there = false};
	for (int i = 0; i < dome->count; i++)
		all += light_of(radiance[i]) * dome->projected_sr[i];
	for (int i = 0; i < dome->count; i++)
		if (light_of(radiance[i]) * dome->projected_sr[i] >= least * all && all > 0 &&
		    count < CANDIDATES)
			strongest[count++] = i;
	for (int k = 0; k < count; k++) {
		const double share = lamp_excess(dome, radiance, strongest[k]) / all;

		if (share < least || share <= lamp->share)
			continue;
		lamp->share = share;
		best = strongest[k];
	}
	if (best >= 0) {
		double theta, phi;

		dome_angles(dome, best, &theta, &phi);
		lamp->there = true;
		lamp->azimuth_deg = phi * (180 / M_PI);
		lamp->height_deg = 90 - theta * (180 / M_PI);
	}
}
