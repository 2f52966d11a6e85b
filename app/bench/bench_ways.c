/* SPDX-License-Identifier: MIT */
#include "app/bench/bench.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/kernels/kernels.h"
#include "hal/compositor/near/near_sky.h"
#include "hal/measure/measure.h"

/* ---- the list ---- */

static struct bench_way *way_add(struct bench_ways *ways, enum bench_kind kind, const char *what,
				 const char *kernel)
{
	struct bench_way *way = &ways->way[ways->count++];

	*way = (struct bench_way){.kind = kind,
				  .row = {.what = what, .kernel = kernel, .lights = -1}};
	return way;
}

/* Adds a way that one of the kernel's compositors makes in this mode. */
static void add_composite(struct bench_ways *ways, enum bench_kind kind, const char *what,
			  const char *kernel, enum compositor_mode mode)
{
	struct bench_way *way = way_add(ways, kind, what, kernel);

	way->compositor = ways->compositors[ways->compositor_count - 1];
	way->composite = background_settings(mode);
}

static int add_compositor(struct bench_ways *ways, const struct bench_stage *stage,
			  const char *kernel, const struct lamps *lamps, struct fault *fault)
{
	const struct compositor_options options = {
		.pool = stage->pool, .kernel = kernel, .lamps = lamps};
	const int err = compositor_create(&ways->compositors[ways->compositor_count], stage->basis,
					  &options, fault);

	ways->compositor_count += !err;
	return err;
}

/* Adds all ways of one kernel. */
static int add_kernel(struct bench_ways *ways, const struct bench_stage *stage, const char *kernel,
		      struct fault *fault)
{
	int err = add_compositor(ways, stage, kernel, NULL, fault);

	if (err)
		return err;
	if (stage->exact)
		add_composite(ways, BENCH_COMPOSITE, "exact", kernel, COMPOSITOR_EXACT);
	add_composite(ways, BENCH_COMPOSITE, "fast", kernel, COMPOSITOR_FAST);
	if (stage->cameras)
		add_composite(ways, BENCH_FRAME, "whole frame", kernel, COMPOSITOR_FAST);
	if (!stage->cameras || !near_sky_possible(stage->basis))
		return 0;
	err = add_compositor(ways, stage, kernel, &bench_lamps, fault);
	if (!err)
		add_composite(ways, BENCH_LAMPS, "whole frame, four lamps", kernel,
			      COMPOSITOR_FAST);
	return err;
}

static int add_kernels(struct bench_ways *ways, const struct bench_stage *stage,
		       struct fault *fault)
{
	const char *only = stage->settings->kernel;
	int err = 0;

	if (only) {
		const struct kernels *kernels = kernels_choose(only);

		if (!kernels)
			return fault_say(fault, -ENOTSUP,
					 "there is no kernel \"%s\" for this processor", only);
		return add_kernel(ways, stage, kernels->name, fault);
	}
	for (int k = 0; !err && kernels_all[k]; k++) {
		if (kernels_all[k]->supported())
			err = add_kernel(ways, stage, kernels_all[k]->name, fault);
	}
	return err;
}

/* Adds the copy and parts of a frame, which no kernel makes. */
static void add_plain_ways(struct bench_ways *ways, const struct bench_stage *stage)
{
	if (stage->cameras) {
		way_add(ways, BENCH_LIGHT, "light from its camera", "");
		way_add(ways, BENCH_CONVERT, "background from its camera", "");
	}
	way_add(ways, BENCH_COPY, "memcpy of the picture", "");
}

int bench_ways_create(struct bench_ways *ways, const struct bench_stage *stage, struct fault *fault)
{
	size_t kernels = 0;
	int err;

	while (kernels_all[kernels])
		kernels++;
	/* four of each kernel; the thesis, two parts of a frame, the copy */
	*ways = (struct bench_ways){.way = calloc(4 * kernels + 4, sizeof(*ways->way))};
	ways->compositors = calloc(2 * kernels, sizeof(*ways->compositors));
	if (!ways->way || !ways->compositors) {
		bench_ways_free(ways);
		return fault_say(fault, -ENOMEM, "not enough memory");
	}
	if (stage->thesis)
		way_add(ways, BENCH_THESIS, "thesis, double precision", "");
	err = add_kernels(ways, stage, fault);
	if (!err)
		add_plain_ways(ways, stage);
	if (!err) {
		ways->ms = calloc((size_t)ways->count * (size_t)stage->settings->repeat,
				  sizeof(*ways->ms));
		if (!ways->ms)
			err = fault_say(fault, -ENOMEM, "not enough memory");
	}
	for (int k = 0; !err && k < ways->count; k++)
		ways->way[k].ms = ways->ms + (size_t)k * (size_t)stage->settings->repeat;
	if (err)
		bench_ways_free(ways);
	return err;
}

void bench_ways_free(struct bench_ways *ways)
{
	free(ways->ms);
	for (int k = 0; k < ways->compositor_count; k++)
		compositor_destroy(ways->compositors[k]);
	free(ways->way);
	free(ways->compositors);
	*ways = (struct bench_ways){.way = NULL};
}

/* ---- light ---- */

int bench_stage_light(struct bench_stage *stage, int member, struct fault *fault)
{
	const float(*radiance)[3] = lighting_member(stage->lighting, stage->basis, member);

	light_selection_choose(&stage->lights, stage->basis, 0, radiance,
			       stage->settings->threshold, THRESHOLD_AMBIENT, 1);
	if (!stage->cameras || stage->seen == radiance)
		return 0;
	if (bench_frame_light(stage->cameras, radiance))
		return fault_say(fault, -ENOMEM, "not enough memory for a picture of the light");
	stage->seen = radiance;
	return 0;
}

/* ---- frames ---- */

void bench_stage_next(struct bench_stage *stage)
{
	const unsigned turn = ++stage->frames;
	const struct canvas *from = &stage->background[turn % BENCH_CAMERA_BUFFERS];
	const struct view whole = {.width = from->width, .height = from->height, .squash = 1};

	stage->background_picture = view_picture(&whole, from->pixels, from->stride);
	stage->out = stage->screen[turn % BENCH_SCREEN_BUFFERS];
	if (stage->cameras)
		bench_frame_next(stage->cameras);
}

bool bench_way_shows(const struct bench_way *way)
{
	return way->kind == BENCH_THESIS || way->kind == BENCH_COMPOSITE ||
	       way->kind == BENCH_FRAME;
}

static int way_composite(struct bench_way *way, struct bench_stage *stage, struct fault *fault)
{
	const struct backdrop backdrop = backdrop_of(&stage->background_picture);
	const int err = compositor_run(way->compositor, 0, &stage->lights, &backdrop,
				       stage->out.pixels, stage->out.stride);

	way->bytes = compositor_last(way->compositor).basis_bytes;
	return err ? fault_say(fault, err, "%s: the compositor fails: %s", way->row.what,
			       strerror(-err))
		   : 0;
}

void bench_way_prepare(struct bench_way *way, struct bench_stage *stage)
{
	if (bench_way_shows(way))
		way->row.lights = stage->lights.used_count;
	if (way->kind == BENCH_THESIS) {
		thesis_light(stage->thesis, &stage->lights);
		way->bytes = thesis_bytes(stage->thesis, way->row.lights);
	}
	if (way->compositor)
		compositor_set(way->compositor, &way->composite);
}

int bench_way_run(struct bench_way *way, struct bench_stage *stage, struct fault *fault)
{
	const struct canvas *from;

	bench_stage_next(stage);
	from = &stage->background[stage->frames % BENCH_CAMERA_BUFFERS];
	switch (way->kind) {
	case BENCH_THESIS:
		thesis_run(stage->thesis, from, &stage->out, stage->pool);
		break;
	case BENCH_COMPOSITE:
		return way_composite(way, stage, fault);
	case BENCH_FRAME:
	case BENCH_LAMPS:
		way->row.lights = bench_frame_lights(stage->cameras)->used_count;
		return bench_frame_run(stage->cameras, way->compositor, stage->settings->threshold,
				       &stage->out, &way->bytes, fault);
	case BENCH_LIGHT:
		return bench_frame_measure(stage->cameras, false, stage->settings->threshold,
					   fault);
	case BENCH_CONVERT:
		bench_frame_convert(stage->cameras, &stage->out);
		break;
	case BENCH_COPY:
		memcpy(stage->out.pixels, from->pixels, from->stride * (size_t)from->height);
		break;
	}
	return 0;
}
