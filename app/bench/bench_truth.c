/* SPDX-License-Identifier: MIT */
#include "app/bench/bench.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/measure/measure.h"

/* Pictures in double precision that ways are compared with. */
enum truth_of {
	TRUTH_INLAY,
	TRUTH_THESIS, /* code values are linear light, in background and result */
	TRUTH_FRAME,  /* background and light as the two cameras saw them */
	TRUTH_COUNT
};

struct bench_pictures {
	const struct bench_stage *stage;
	double *picture[TRUTH_COUNT]; /* [height][width][3]; NULL: no way needs it */
	int err[TRUTH_COUNT];
};

static size_t values_of(const struct bench_stage *stage)
{
	return 3 * (size_t)stage->basis->info.width * stage->basis->info.height;
}

/* Makes one of the pictures. Each takes one thread, so the threads share them out. */
static void make_truth(void *context, int item, int worker)
{
	struct bench_pictures *t = context;
	const struct bench_stage *stage = t->stage;
	struct compositor_settings settings = background_settings(stage->exact ? COMPOSITOR_EXACT
									       : COMPOSITOR_FAST);
	const struct light_selection *lights = &stage->lights;
	struct picture background = stage->background_picture;

	(void)worker;
	if (!t->picture[item])
		return;
	if (item == TRUTH_THESIS)
		settings.background.named = settings.output.named = TRANSFER_LINEAR;
	if (item == TRUTH_FRAME) {
		background = bench_frame_background(stage->cameras);
		lights = bench_frame_lights(stage->cameras);
	}
	t->err[item] = compositor_reference(stage->basis, 0, &settings, lights, &background,
					    t->picture[item]);
}

static int truth_create(struct bench_pictures *t, const struct bench_stage *stage)
{
	const bool needed[TRUTH_COUNT] = {true, stage->thesis, stage->cameras};

	*t = (struct bench_pictures){.stage = stage};
	for (int k = 0; k < TRUTH_COUNT; k++) {
		if (!needed[k])
			continue;
		t->picture[k] = malloc(values_of(stage) * sizeof(*t->picture[k]));
		if (!t->picture[k])
			return -ENOMEM;
	}
	return 0;
}

static void truth_free(struct bench_pictures *t)
{
	for (int k = 0; k < TRUTH_COUNT; k++)
		free(t->picture[k]);
}

static struct composite_error way_error(const struct bench_way *way, const struct bench_pictures *t,
					const struct scope *scope)
{
	const struct bench_stage *stage = t->stage;
	struct picture background = stage->background_picture;
	enum truth_of of = TRUTH_INLAY;

	if (way->kind == BENCH_THESIS)
		of = TRUTH_THESIS;
	if (way->kind == BENCH_FRAME) {
		of = TRUTH_FRAME;
		background = bench_frame_background(stage->cameras);
	}
	return error_measure(scope, t->picture[of], &stage->out, &background,
			     of == TRUTH_THESIS ? TRANSFER_LINEAR : TRANSFER_SRGB);
}

static int judge_all(struct bench_ways *ways, struct bench_stage *stage,
		     const struct bench_pictures *t, const struct scope *scope, struct fault *fault)
{
	int err = 0;

	for (int k = 0; !err && k < ways->count; k++) {
		struct bench_way *way = &ways->way[k];
		struct composite_error error;

		if (!bench_way_shows(way))
			continue;
		bench_way_prepare(way, stage);
		err = bench_way_run(way, stage, fault);
		error = way_error(way, t, scope);
		if (way->row.has_error)
			error_worse(&way->row.error, &error);
		else
			way->row.error = error;
		way->row.has_error = true;
	}
	return err;
}

/* Measures the light of the cameras' pictures, which double precision takes. */
static int see_light(const struct bench_stage *stage, struct fault *fault)
{
	return stage->cameras ? bench_frame_measure(stage->cameras, false,
						    stage->settings->threshold, fault)
			      : 0;
}

int bench_truth(struct bench_ways *ways, struct bench_stage *stage, const struct scope *scope,
		struct pool *all, struct fault *fault)
{
	struct bench_pictures t;
	int err = truth_create(&t, stage);

	if (err)
		fault_say(fault, err, "not enough memory for pictures in double precision");
	for (int k = 0; k < ways->count; k++)
		ways->way[k].row.has_error = false;
	for (int m = 0; !err && m < stage->lighting->members; m++) {
		err = bench_stage_light(stage, m, fault);
		if (!err)
			err = see_light(stage, fault);
		if (err)
			break;
		pool_run(all, TRUTH_COUNT, make_truth, &t);
		for (int k = 0; k < TRUTH_COUNT; k++) {
			if (t.err[k])
				err = fault_say(fault, t.err[k], "double precision fails: %s",
						strerror(-t.err[k]));
		}
		if (!err)
			err = judge_all(ways, stage, &t, scope, fault);
	}
	truth_free(&t);
	return err;
}
