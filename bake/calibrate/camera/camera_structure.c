/* SPDX-License-Identifier: MIT */
/*
 * Structure in the residuals: mean residuals of rings around the axis and of parts of the picture.
 * Noise averages out there; what remains is the lens, or what the pictures have in common.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "bake/calibrate/camera/camera_parts.h"

#define RINGS 6
#define ZONES 4 /* across and down */
#define GROUPS (RINGS + 2 * ZONES * ZONES)
#define FEWEST_POINTS 12 /* of a group */
#define FEWEST_OF_VIEW 3
#define FEWEST_VIEWS 3

/* Sums of one group, of all points, of the view at hand, and of the views' means. */
struct group {
	double sum, view_sum, means, squares;
	int count, view_count, views;
};

static void group_add(struct group *group, double value)
{
	group->view_sum += value;
	group->view_count++;
}

static void group_end_view(struct group *group)
{
	const double mean = group->view_count ? group->view_sum / group->view_count : 0;

	group->sum += group->view_sum;
	group->count += group->view_count;
	if (group->view_count >= FEWEST_OF_VIEW) {
		group->means += mean;
		group->squares += mean * mean;
		group->views++;
	}
	group->view_sum = group->view_count = 0;
}

/* Standard deviation of the group's mean: that of noise, or the scatter of the views if that is
 * larger, because errors within a view go together. */
static double group_deviation(const struct group *group, double sigma)
{
	const double noise = sigma / sqrt(group->count), n = group->views;
	double scatter;

	if (group->views < FEWEST_VIEWS)
		return noise;
	scatter = (group->squares - group->means * group->means / n) / (n - 1);
	return fmax(noise, sqrt(fmax(0, scatter) / n));
}

/* The picture's box, or the points'. */
static void find_box(const struct camera_private *own, double low[2], double size[2])
{
	double high[2] = {own->task.width, own->task.height};

	low[0] = low[1] = 0;
	if (!own->task.width) {
		low[0] = low[1] = INFINITY;
		high[0] = high[1] = -INFINITY;
	}
	for (int i = 0; i < own->problem.count && !own->task.width; i++)
		for (int k = 0; k < 2; k++) {
			low[k] = fmin(low[k], own->problem.point[i].px[k]);
			high[k] = fmax(high[k], own->problem.point[i].px[k]);
		}
	for (int k = 0; k < 2; k++)
		size[k] = high[k] > low[k] ? high[k] - low[k] : 1;
}

static double radius_of(const struct camera_private *own, int i)
{
	return hypot(own->problem.point[i].px[0] - own->x[MODEL_CENTRE_X],
		     own->problem.point[i].px[1] - own->x[MODEL_CENTRE_Y]);
}

static void add_point(const struct camera_private *own, int i, double farthest, const double low[2],
		      const double size[2], struct group group[GROUPS])
{
	const struct observation *point = &own->problem.point[i];
	const double off[2] = {-own->fit.residual[2 * i], -own->fit.residual[2 * i + 1]};
	const double radius = radius_of(own, i), share = radius / farthest;
	const int ring = (int)fmin(RINGS - 1, RINGS * share * share); /* of equal areas */
	int zone = 0;

	if (radius > 0)
		group_add(&group[ring], (off[0] * (point->px[0] - own->x[MODEL_CENTRE_X]) +
					 off[1] * (point->px[1] - own->x[MODEL_CENTRE_Y])) /
						radius);
	for (int k = 1; k >= 0; k--)
		zone = ZONES * zone +
		       (int)fmin(ZONES - 1, fmax(0, ZONES * (point->px[k] - low[k]) / size[k]));
	for (int k = 0; k < 2; k++)
		group_add(&group[RINGS + 2 * zone + k], off[k]);
}

static void name_place(const struct camera_structure *found, double farthest, const double low[2],
		       const double size[2], struct camera_structure *named)
{
	const int zone = (found->group - RINGS) / 2;

	*named = *found;
	named->ring = found->group < RINGS;
	named->from_px = farthest * sqrt(found->group / (double)RINGS);
	named->to_px = farthest * sqrt((found->group + 1) / (double)RINGS);
	if (named->ring)
		return;
	named->at_px[0] = low[0] + size[0] * (zone % ZONES + 0.5) / ZONES;
	named->at_px[1] = low[1] + size[1] * (zone / ZONES + 0.5) / ZONES;
}

void camera_find_structure(const struct camera_private *own, struct camera_structure *found)
{
	struct group group[GROUPS] = {{0}};
	struct camera_structure worst = {.group = 0};
	const double sigma = fmax(own->fit.sigma, CAMERA_NOISE_LEAST);
	double low[2], size[2], farthest = 0;

	find_box(own, low, size);
	for (int i = 0; i < own->problem.count; i++)
		farthest = fmax(farthest, radius_of(own, i));
	for (int v = 0; v < own->problem.views; v++) {
		for (int i = own->problem.first[v]; i < own->problem.first[v + 1]; i++)
			if (own->fit.weight[i] >= 0.1)
				add_point(own, i, farthest, low, size, group);
		for (int g = 0; g < GROUPS; g++)
			group_end_view(&group[g]);
	}
	for (int g = 0; g < GROUPS; g++) {
		const double mean = group[g].count ? group[g].sum / group[g].count : 0;
		const double deviation = group_deviation(&group[g], sigma);

		if (group[g].count < FEWEST_POINTS || !(fabs(mean) > worst.sigmas * deviation))
			continue;
		worst.group = g;
		worst.mean_px = mean;
		worst.deviation_px = deviation;
		worst.sigmas = fabs(mean) / deviation;
	}
	name_place(&worst, farthest, low, size, found);
}
