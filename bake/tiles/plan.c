/* SPDX-License-Identifier: MIT */
#include "bake/tiles/plan.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/tiles/coarse.h"

/* Default of column_cut for up to CUT_LIGHTS lights: the largest change, in linear light, of a
 * column that a frame may leave out. */
#define CUT 0.001
#define CUT_LIGHTS 406

/* Sets the coarse lights: the nodes of a whole dome, even if the lights are finer in parts. There
 * are none if they would be as many as the lights. */
static int set_coarse(struct plan *plan, const struct dome *dome, int frequency,
		      struct fault *fault)
{
	struct dome coarse;
	int err;

	plan->info.coarse = plan->info.lights;
	if (dome->frequency && frequency > dome->frequency)
		frequency = dome->frequency;
	err = dome_create(&coarse, frequency, fault);
	if (err || coarse.count >= dome->count)
		goto out;
	plan->info.coarse = (uint32_t)coarse.count;
	plan->gather = calloc(plan->info.lights, sizeof(*plan->gather));
	if (plan->gather)
		coarse_fill(dome, &coarse, plan->gather);
	else
		err = fault_say(fault, -ENOMEM, "out of memory");
out:
	dome_free(&coarse);
	return err;
}

/*
 * Each column that a frame leaves out changes a pixel by up to the cut. Their signs are random, so
 * all of them together change it by about the cut times the root of their number:
 *     column_cut = CUT * min(1, sqrt(CUT_LIGHTS / N))
 */
static double fitting_cut(size_t lights)
{
	return CUT * sqrt(fmin(1, (double)CUT_LIGHTS / (double)lights));
}

int plan_set_lights(struct plan *plan, const struct dome *dome, int coarse, struct fault *fault)
{
	const size_t n = (size_t)dome->count;
	struct basis_light *light = calloc(n, sizeof(*light));

	if (!light)
		return fault_say(fault, -ENOMEM, "out of memory");
	for (size_t i = 0; i < n; i++) {
		memcpy(light[i].direction, dome->direction[i], sizeof(light[i].direction));
		light[i].solid_angle_sr = dome->solid_angle_sr[i];
	}
	plan->light = light;
	plan->info.lights = (uint32_t)n;
	if (plan->info.column_cut < 0)
		plan->info.column_cut = fitting_cut(n);
	plan->info.dome_frequency = (uint32_t)dome->frequency;
	return set_coarse(plan, dome, coarse ? coarse : COARSE_FREQUENCY, fault);
}

void plan_free(struct plan *plan)
{
	free(plan->light);
	free(plan->ground);
	free(plan->gather);
	free(plan->names);
	*plan = (struct plan){.light = NULL};
}

int plan_tiles(const struct plan *plan)
{
	const int width = (int)plan->info.width, height = (int)plan->info.height;

	return (width + BASIS_TILE - 1) / BASIS_TILE * ((height + BASIS_TILE - 1) / BASIS_TILE);
}

void plan_rectangle(const struct plan *plan, int tile, int *x, int *y, int *width, int *height)
{
	const int right = (int)plan->info.width, bottom = (int)plan->info.height;
	const int across = (right + BASIS_TILE - 1) / BASIS_TILE;

	*x = tile % across * BASIS_TILE;
	*y = tile / across * BASIS_TILE;
	*width = right - *x < BASIS_TILE ? right - *x : BASIS_TILE;
	*height = bottom - *y < BASIS_TILE ? bottom - *y : BASIS_TILE;
}

struct encode_target plan_target(const struct plan *plan)
{
	const char *line = strstr(plan->provenance, "\ntarget_levels =");
	struct encode_target target;

	if (!line || sscanf(line, "\ntarget_levels = rms %lf, max %lf, cell %lf", &target.rms,
			    &target.max, &target.cell) != 3)
		return (struct encode_target){INFINITY, INFINITY, INFINITY};
	return target;
}
