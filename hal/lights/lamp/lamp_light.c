/* SPDX-License-Identifier: MIT */
#include "hal/lights/lamp/lamp_light.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

/* A lamp may be so far from where it is said to be: 5 cm at 2 m. */
#define OFF_RAD 0.026

struct lamp_cells {
	int *cell; /* the lamp's, then those around it */
	int own, around;
};

struct lamp_light {
	int lamps;
	double *solid_angle; /* [lights] */
	struct lamp_cells cells[LAMPS_MAX];
	float *sorted; /* [lights] */
};

double lamp_light_apart(const struct dome *dome, int cell, const double direction[3],
			double radius_rad)
{
	const double off = vec_angle(dome->direction[cell], direction) - radius_rad - OFF_RAD;

	return off / dome_cell_reach_rad(dome, cell);
}

/* Where a lamp is seen from the fisheye. False: below its horizon. */
static bool lamp_seen(const struct lamps *lamps, int lamp, double direction[3], double *radius_rad)
{
	double distance;

	for (int k = 0; k < 3; k++)
		direction[k] = lamps->lamp[lamp].position[k] - lamps->fisheye[k];
	distance = vec_normalize(direction);
	*radius_rad = asin(fmin(lamps->lamp[lamp].radius / distance, 1));
	return distance > 0 && direction[2] > 0;
}

/* Finds the lamp that each cell belongs to: the nearest; -1: none. */
static void find_owners(const struct dome *dome, const struct lamps *lamps, int *owner)
{
	for (int i = 0; i < dome->count; i++) {
		double least = LAMP_LIGHT_SHARED;

		owner[i] = -1;
		for (int l = 0; l < lamps->count; l++) {
			double direction[3], radius;
			const double apart = lamp_seen(lamps, l, direction, &radius)
						     ? lamp_light_apart(dome, i, direction, radius)
						     : INFINITY;

			if (apart < least) {
				least = apart;
				owner[i] = l;
			}
		}
	}
}

static int list_cells(struct lamp_cells *cells, const struct dome *dome, const struct lamps *lamps,
		      int lamp, const int *owner)
{
	double direction[3], radius;

	if (!lamp_seen(lamps, lamp, direction, &radius))
		return 0;
	cells->cell = calloc((size_t)dome->count, sizeof(*cells->cell));
	if (!cells->cell)
		return -ENOMEM;
	for (int i = 0; i < dome->count; i++)
		if (owner[i] == lamp)
			cells->cell[cells->own++] = i;
	for (int i = 0; i < dome->count; i++)
		if (owner[i] < 0 &&
		    lamp_light_apart(dome, i, direction, radius) < LAMP_LIGHT_AROUND)
			cells->cell[cells->own + cells->around++] = i;
	return 0;
}

int lamp_light_create(struct lamp_light **out, const struct dome *dome, const struct lamps *lamps)
{
	const size_t n = (size_t)dome->count;
	struct lamp_light *light = calloc(1, sizeof(*light));
	int *owner = calloc(n, sizeof(*owner)), ret = -ENOMEM;

	*out = NULL;
	if (light) {
		light->lamps = lamps->count;
		light->solid_angle = calloc(n, sizeof(*light->solid_angle));
		light->sorted = calloc(n, sizeof(*light->sorted));
	}
	if (light && owner && light->solid_angle && light->sorted) {
		memcpy(light->solid_angle, dome->solid_angle_sr, n * sizeof(*light->solid_angle));
		find_owners(dome, lamps, owner);
		ret = 0;
	}
	for (int l = 0; ret == 0 && l < lamps->count; l++)
		ret = list_cells(&light->cells[l], dome, lamps, l, owner);
	free(owner);
	if (ret < 0)
		lamp_light_destroy(light);
	else
		*out = light;
	return ret;
}

void lamp_light_destroy(struct lamp_light *light)
{
	if (!light)
		return;
	for (int l = 0; l < light->lamps; l++)
		free(light->cells[l].cell);
	free(light->solid_angle);
	free(light->sorted);
	free(light);
}

static int compare_floats(const void *a, const void *b)
{
	const float x = *(const float *)a, y = *(const float *)b;

	return (x > y) - (x < y);
}

static float median_around(struct lamp_light *light, const struct lamp_cells *cells,
			   const float (*radiance)[3], int c)
{
	const int n = cells->around;

	if (!n)
		return 0;
	for (int k = 0; k < n; k++)
		light->sorted[k] = radiance[cells->cell[cells->own + k]][c];
	qsort(light->sorted, (size_t)n, sizeof(*light->sorted), compare_floats);
	return (light->sorted[(n - 1) / 2] + light->sorted[n / 2]) / 2;
}

void lamp_light_take(struct lamp_light *light, float (*radiance)[3], double (*power)[3])
{
	for (int l = 0; l < light->lamps; l++) {
		const struct lamp_cells *cells = &light->cells[l];

		for (int c = 0; c < 3; c++) {
			const float around = median_around(light, cells,
							   (const float(*)[3])radiance, c);

			power[l][c] = 0;
			for (int k = 0; k < cells->own; k++) {
				float *is = &radiance[cells->cell[k]][c];

				if (*is > around) {
					power[l][c] += light->solid_angle[cells->cell[k]] *
						       (double)(*is - around);
					*is = around;
				}
			}
		}
	}
}
