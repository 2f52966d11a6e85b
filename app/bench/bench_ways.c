/* SPDX-License-Identifier: MIT */
#include "app/bench/bench_ways.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/kernels/kernels.h"

/* ---- the list ---- */

static const struct {
	const char *what;
	enum compositor_mode mode;
	int changed;
} sequences[] = {
	{"exact", COMPOSITOR_EXACT, 0},
	{"fast", COMPOSITOR_FAST, 0},
	{"fast, 1 light changes", COMPOSITOR_FAST, 1},
	{"fast, 10 lights change", COMPOSITOR_FAST, 10},
	{"fast, all lights change", COMPOSITOR_FAST, BENCH_CHANGE_ALL},
};

#define SEQUENCE_COUNT (sizeof(sequences) / sizeof(*sequences))

static struct bench_way *way_add(struct bench_ways *ways, enum bench_kind kind, const char *what,
				 const char *kernel)
{
	struct bench_way *way = &ways->way[ways->count++];

	*way = (struct bench_way){.kind = kind, .row = {.lights = -1}};
	snprintf(way->row.what, sizeof(way->row.what), "%s", what);
	snprintf(way->row.kernel, sizeof(way->row.kernel), "%s", kernel);
	return way;
}

static int add_compositor(struct bench_ways *ways, const struct bench_stage *stage,
			  const char *kernel, struct compositor **compositor, struct fault *fault)
{
	const struct compositor_options options = {.pool = stage->pool, .kernel = kernel};
	const int err = compositor_create(compositor, stage->basis, &options, fault);

	if (!err)
		ways->compositors[ways->compositor_count++] = *compositor;
	return err;
}

static struct compositor_settings settings_of(enum compositor_mode mode)
{
	return (struct compositor_settings){
		.mode = mode,
		.background = {.named = TRANSFER_SRGB},
		.output = {.named = TRANSFER_SRGB},
		.gain = 1,
		.object = true,
	};
}

/* Adds all ways of one kernel. */
static int add_kernel(struct bench_ways *ways, const struct bench_stage *stage, const char *kernel,
		      struct fault *fault)
{
	struct compositor *own[COMPOSITOR_MODE_COUNT][2] = {{NULL}};
	struct bench_way *way;

	for (size_t k = 0; k < SEQUENCE_COUNT; k++) {
		const enum compositor_mode mode = sequences[k].mode;
		struct compositor **with = &own[mode][sequences[k].changed != 0];
		int err = 0;

		if (mode == COMPOSITOR_EXACT && !stage->exact)
			continue;
		if (!*with)
			err = add_compositor(ways, stage, kernel, with, fault);
		if (err)
			return err;
		way = way_add(ways, BENCH_COMPOSITE, sequences[k].what, kernel);
		way->compositor = *with;
		way->changed = sequences[k].changed;
		way->composite = settings_of(mode);
	}
	way = way_add(ways, BENCH_GRAIN, "fast, with grain", kernel);
	way->compositor = own[COMPOSITOR_FAST][0];
	way->composite = settings_of(COMPOSITOR_FAST);
	way->composite.grain = bench_look_grain(stage->look);
	if (stage->cameras) {
		way = way_add(ways, BENCH_FRAME, "whole frame", kernel);
		way->compositor = own[COMPOSITOR_FAST][0];
		way->composite = settings_of(COMPOSITOR_FAST);
		way = way_add(ways, BENCH_VISITED, "whole frame, with people", kernel);
		way->compositor = own[COMPOSITOR_FAST][0];
		way->composite = settings_of(COMPOSITOR_FAST);
	}
	return 0;
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

/* Adds the read bounds, the copy and parts of a frame. All kernels read the same bytes: the bounds
 * are for the ways of the last one. */
static void add_bounds(struct bench_ways *ways, const struct bench_stage *stage)
{
	const int count = ways->count;
	const char *kernel = NULL;
	struct bench_way *way;

	for (int k = 0; k < count; k++) {
		if (ways->way[k].kind == BENCH_COMPOSITE)
			kernel = ways->way[k].row.kernel;
	}
	for (int k = 0; k < count; k++) {
		const struct bench_way *like = &ways->way[k];
		char what[sizeof(like->row.what)];

		if (like->kind != BENCH_COMPOSITE || like->changed ||
		    strcmp(like->row.kernel, kernel) != 0)
			continue;
		snprintf(what, sizeof(what), "read bound: %.30s", like->row.what);
		way = way_add(ways, BENCH_READ, what, "");
		way->like = like;
	}
	if (stage->cameras) {
		way_add(ways, BENCH_PEOPLE, "looking for people", "");
		way_add(ways, BENCH_EXPOSURE, "following exposure", "");
		way_add(ways, BENCH_FLICKER, "following flicker", "");
		way_add(ways, BENCH_NEUTRAL, "neutral light", "");
		way_add(ways, BENCH_LIGHT, "light from its camera", "");
		way_add(ways, BENCH_CONVERT, "background from its camera", "");
	}
	way_add(ways, BENCH_COPY, "memcpy of the picture", "");
}

int bench_ways_create(struct bench_ways *ways, const struct bench_stage *stage, struct fault *fault)
{
	size_t kernels = 0, most;
	int err;

	while (kernels_all[kernels])
		kernels++;
	most = (kernels + 1) * (SEQUENCE_COUNT + 3) + 8;
	*ways = (struct bench_ways){.way = calloc(most, sizeof(*ways->way))};
	ways->compositors = calloc(4 * kernels, sizeof(*ways->compositors));
	if (!ways->way || !ways->compositors) {
		bench_ways_free(ways);
		return fault_say(fault, -ENOMEM, "not enough memory");
	}
	if (stage->thesis)
		way_add(ways, BENCH_THESIS, "thesis, double precision", "");
	err = add_kernels(ways, stage, fault);
	if (!err)
		add_bounds(ways, stage);
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

static void lights_choose(struct bench_stage *stage, struct light_selection *lights,
			  const float (*radiance)[3])
{
	light_selection_choose(lights, stage->basis, 0, radiance, stage->settings->threshold,
			       THRESHOLD_AMBIENT, 1);
}

int bench_stage_light(struct bench_stage *stage, int member, struct fault *fault)
{
	const float(*radiance)[3] = lighting_member(stage->lighting, stage->basis, member);

	lights_choose(stage, &stage->lights, radiance);
	if (!stage->cameras || stage->seen == radiance)
		return 0;
	if (bench_frame_light(stage->cameras, radiance))
		return fault_say(fault, -ENOMEM, "not enough memory for a picture of the light");
	stage->seen = radiance;
	return 0;
}

/* Chooses the lights of the frame before, in which some were brighter. */
static void light_before(struct bench_stage *stage, int turn, int changed)
{
	const int n = stage->lights.count;

	changed = changed == BENCH_CHANGE_ALL || changed > n ? n : changed;
	for (int i = 0; i < n; i++)
		for (int c = 0; c < 3; c++)
			stage->scratch[i][c] = (float)stage->lights.radiance[i][c];
	lighting_change(stage->scratch, n, changed, turn);
	lights_choose(stage, &stage->before, (const float(*)[3])stage->scratch);
	for (int c = 0; c < 3; c++)
		stage->before.ambient[c] = stage->lights.ambient[c];
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

static int way_composite(struct bench_way *way, struct bench_stage *stage,
			 const struct light_selection *lights, const struct picture *background,
			 struct fault *fault)
{
	const struct backdrop backdrop = backdrop_of(background);
	const int err = compositor_run(way->compositor, 0, lights, &backdrop, stage->out.pixels,
				       stage->out.stride);

	way->bytes = compositor_last(way->compositor).basis_bytes;
	return err ? fault_say(fault, err, "%s: the compositor fails: %s", way->row.what,
			       strerror(-err))
		   : 0;
}

/* A whole frame of a kiosk that looks for people: as in app/pipeline, the background is read
 * before. */
static int way_visited(struct bench_way *way, struct bench_stage *stage, struct fault *fault)
{
	const int err = bench_frame_measure(stage->cameras, stage->settings->threshold, fault);

	if (err)
		return err;
	stage->visited = bench_frame_visited(stage->cameras);
	way->composite.veil = bench_look_people(stage->look, &stage->visited);
	compositor_set(way->compositor, &way->composite);
	way->row.lights = bench_frame_lights(stage->cameras)->used_count;
	return way_composite(way, stage, bench_frame_lights(stage->cameras), &stage->visited,
			     fault);
}

int bench_way_prepare(struct bench_way *way, struct bench_stage *stage, int turn,
		      struct fault *fault)
{
	if (bench_way_shows(way))
		way->row.lights = stage->lights.used_count;
	if (way->kind == BENCH_THESIS) {
		thesis_light(stage->thesis, &stage->lights);
		way->bytes = thesis_bytes(stage->thesis, way->row.lights);
	}
	if (way->compositor)
		compositor_set(way->compositor, &way->composite);
	if (way->kind == BENCH_PEOPLE || way->kind == BENCH_EXPOSURE || way->kind == BENCH_FLICKER)
		stage->visited = bench_frame_visited(stage->cameras);
	if (way->kind == BENCH_COMPOSITE && way->changed) {
		light_before(stage, turn, way->changed);
		return way_composite(way, stage, &stage->before, &stage->background_picture, fault);
	}
	return 0;
}

int bench_way_run(struct bench_way *way, struct bench_stage *stage, struct fault *fault)
{
	const struct canvas *from;

	bench_stage_next(stage);
	from = &stage->background[stage->frames % BENCH_CAMERA_BUFFERS];
	switch (way->kind) {
	case BENCH_THESIS:
		thesis_run(stage->thesis, from, &stage->out);
		break;
	case BENCH_COMPOSITE:
	case BENCH_GRAIN:
		return way_composite(way, stage, &stage->lights, &stage->background_picture, fault);
	case BENCH_EXPOSURE:
		bench_look_exposure(stage->look, &stage->visited);
		break;
	case BENCH_FLICKER:
		bench_look_flicker(stage->look, &stage->visited);
		break;
	case BENCH_NEUTRAL:
		bench_look_neutral(stage->look);
		break;
	case BENCH_PEOPLE:
		(void)bench_look_people(stage->look, &stage->visited);
		break;
	case BENCH_FRAME:
		way->row.lights = bench_frame_lights(stage->cameras)->used_count;
		return bench_frame_run(stage->cameras, way->compositor, stage->settings->threshold,
				       &stage->out, &way->bytes, fault);
	case BENCH_VISITED:
		return way_visited(way, stage, fault);
	case BENCH_LIGHT:
		return bench_frame_measure(stage->cameras, stage->settings->threshold, fault);
	case BENCH_CONVERT:
		bench_frame_convert(stage->cameras, &stage->out);
		break;
	case BENCH_READ: {
		/* volatile: the compiler must not leave the reading out */
		volatile uint64_t sum = reading_run(&stage->reading, way->like->bytes, stage->pool);

		(void)sum;
		break;
	}
	case BENCH_COPY:
		memcpy(stage->out.pixels, from->pixels, from->stride * (size_t)from->height);
		break;
	}
	return 0;
}
