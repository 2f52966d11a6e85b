/* SPDX-License-Identifier: MIT */
#include "app/bench/bench.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/log.h"
#include "hal/measure/measure.h"

/* ---- rows ---- */

/* Sorts the times of a way. 0: there is none of this kind. */
static struct turns_spread spread_of(const struct bench_ways *ways, enum bench_kind kind,
				     int repeat)
{
	for (int k = 0; k < ways->count; k++)
		if (ways->way[k].kind == kind)
			return turns_spread(ways->way[k].ms, repeat);
	return (struct turns_spread){.median = 0};
}

static int take_rows(struct bench_report *report, struct bench_ways *ways,
		     const struct bench_stage *stage, struct fault *fault)
{
	const int repeat = report->repeat;
	const double thesis_ms = spread_of(ways, BENCH_THESIS, repeat).median;
	const double copy_ms = spread_of(ways, BENCH_COPY, repeat).least;

	for (int k = 0; k < ways->count; k++) {
		const struct bench_way *way = &ways->way[k];
		const struct turns_spread ms = turns_spread(way->ms, repeat);
		struct bench_row row = way->row;

		row.lighting = stage->lighting->name;
		row.basis_mb = (double)way->bytes / 1e6;
		row.median_ms = ms.median;
		row.least_ms = ms.least;
		row.copies = ms.least / copy_ms;
		if (way->kind != BENCH_THESIS && bench_way_shows(way))
			row.speedup = thesis_ms / ms.median;
		bench_print_row(&report->rows, &row);
	}
	return report->rows.err ? fault_say(fault, report->rows.err, "not enough memory") : 0;
}

/* ---- timing ---- */

/* What the timed turns under one lighting need. */
struct round {
	struct bench_ways *ways;
	struct bench_stage *stage;
	int turn; /* turn whose light the stage has; -1: none */
	struct fault *fault;
};

static int round_prepare(void *context, int way, int turn)
{
	struct round *round = context;
	int err = 0;

	if (round->turn != turn)
		err = bench_stage_light(round->stage, turn % round->stage->lighting->members,
					round->fault);
	if (err)
		return err;
	round->turn = turn;
	bench_way_prepare(&round->ways->way[way], round->stage);
	return 0;
}

static int round_run(void *context, int way)
{
	const struct round *round = context;

	return bench_way_run(&round->ways->way[way], round->stage, round->fault);
}

static int time_all(struct bench_ways *ways, struct bench_stage *stage, struct fault *fault)
{
	struct round round = {.ways = ways, .stage = stage, .turn = -1, .fault = fault};
	struct turns turns = {.context = &round,
			      .ways = ways->count,
			      .repeat = stage->settings->repeat,
			      .prepare = round_prepare,
			      .run = round_run,
			      .shared = pool_threads(stage->pool) > 1};
	const int err = turns_time(&turns, ways->ms);

	stage->timed_ns += turns.timed_ns;
	stage->ran_ns += turns.ran_ns;
	return err;
}

/* ---- the stage ---- */

static double layer_mb(const struct basis *basis, const struct basis_layer *layer)
{
	size_t bytes = 0;

	for (int t = 0; layer->tiles && t < basis->tiles_across * basis->tiles_down; t++)
		bytes += layer->tiles[t].bytes;
	return (double)bytes / 1e6;
}

static void report_describe(const struct bench_stage *stage, const struct scope *scope,
			    struct bench_report *report)
{
	const struct basis *basis = stage->basis;

	snprintf(report->basis, sizeof(report->basis), "%s", stage->settings->basis);
	report->width = (int)basis->info.width;
	report->height = (int)basis->info.height;
	report->lights = (int)basis->info.lights;
	report->threads = pool_threads(stage->pool);
	report->repeat = stage->settings->repeat;
	report->object_pixels = scope->objects;
	report->shadow_pixels = scope->shadows;
	report->shown_mb = layer_mb(basis, &basis->poses[0].shown);
	report->exact_mb = layer_mb(basis, &basis->poses[0].exact);
	report->dense_mb = (3.0 * (double)scope->objects + 3.0 * (double)scope->shadows) *
			   report->lights / 1e6;
	report->truth = stage->exact ? "exact" : "shown";
}

static int add_lightings(struct lightings *lightings, const struct bench_settings *s,
			 const struct basis *basis, struct fault *fault)
{
	int err = 0;

	for (int k = 0; !err && k < s->lights.count; k++)
		err = lightings_add_file(lightings, basis, s->lights.text[k], fault);
	for (int k = 0; !err && k < s->panoramas.count; k++)
		err = lightings_add_panorama(lightings, basis, s->panoramas.text[k], fault);
	if (!s->lights.count && !s->panoramas.count)
		err = lightings_add_built_in(lightings, basis, s->cells, fault);
	return err;
}

static const struct basis_layer *best_layer(const struct bench_stage *stage)
{
	return stage->exact ? &stage->basis->poses[0].exact : &stage->basis->poses[0].shown;
}

/* Prepares what all ways share. all: threads for work that is not timed. */
static int set_stage(struct bench_stage *stage, struct pool *all, struct fault *fault)
{
	const struct bench_settings *settings = stage->settings;
	const int width = (int)stage->basis->info.width, height = (int)stage->basis->info.height;
	struct fault reason = {.text = ""};
	int err = 0;

	for (int k = 0; !err && k < BENCH_CAMERA_BUFFERS; k++)
		err = canvas_create(&stage->background[k], width, height);
	for (int k = 0; !err && k < BENCH_SCREEN_BUFFERS; k++)
		err = canvas_create(&stage->screen[k], width, height);
	if (err || light_selection_create(&stage->lights, stage->basis))
		return fault_say(fault, -ENOMEM, "not enough memory for pictures of %dx%d", width,
				 height);
	stage->lights.budget = settings->budget;
	for (int k = 0; k < BENCH_CAMERA_BUFFERS; k++)
		background_fill(&stage->background[k]);
	bench_stage_next(stage);
	if (settings->thesis) {
		log_info("making the thesis's basis");
		err = thesis_create(&stage->thesis, stage->basis, best_layer(stage), all, fault);
		if (err)
			return err;
	}
	err = bench_frame_create(&stage->cameras, stage->basis, stage->background, stage->pool,
				 &reason);
	if (err == -ENOTSUP)
		log_warning("%s: the whole frame is left out", reason.text);
	else if (err)
		return fault_say(fault, err, "%s", reason.text);
	else
		bench_frame_budget(stage->cameras, settings->budget);
	return 0;
}

static void clear_stage(struct bench_stage *stage)
{
	bench_frame_destroy(stage->cameras);
	thesis_destroy(stage->thesis);
	light_selection_free(&stage->lights);
	for (int k = 0; k < BENCH_SCREEN_BUFFERS; k++)
		canvas_free(&stage->screen[k]);
	for (int k = 0; k < BENCH_CAMERA_BUFFERS; k++)
		canvas_free(&stage->background[k]);
}

static int run_lightings(struct bench_ways *ways, struct bench_stage *stage,
			 const struct lightings *lightings, struct pool *all,
			 struct bench_report *report, struct fault *fault)
{
	struct scope scope;
	int err = scope_create(&scope, stage->basis, best_layer(stage));

	if (err)
		return fault_say(fault, err, "not enough memory");
	report_describe(stage, &scope, report);
	for (int k = 0; !err && k < lightings->count; k++) {
		stage->lighting = &lightings->item[k];
		log_info("%s: double precision", stage->lighting->name);
		err = bench_truth(ways, stage, &scope, all, fault);
		if (err)
			break;
		log_info("%s: times", stage->lighting->name);
		err = time_all(ways, stage, fault);
		if (!err)
			err = take_rows(report, ways, stage, fault);
	}
	if (stage->timed_ns > stage->ran_ns)
		report->waited = 1 - (double)stage->ran_ns / (double)stage->timed_ns;
	scope_free(&scope);
	return err;
}

/* ---- all of it ---- */

static int create_pools(struct pool **pool, struct pool **all, int threads, struct fault *fault)
{
	int err = pool_create(pool, threads);

	if (!err)
		err = pool_create(all, 0);
	return err ? fault_say(fault, err, "cannot start %d threads: %s", threads, strerror(-err))
		   : 0;
}

int bench_run(const struct bench_settings *settings, struct bench_report *report,
	      struct fault *fault)
{
	struct basis basis = {.map = NULL};
	struct bench_stage stage = {.settings = settings, .basis = &basis};
	struct lightings lightings = {.count = 0};
	struct bench_ways ways = {.count = 0};
	struct pool *all = NULL;
	int err;

	*report = (struct bench_report){.width = 0};
	bench_print_begin(&report->rows);
	err = basis_open(&basis, settings->basis, BASIS_ALL, fault);
	if (err)
		return err;
	stage.exact = basis.poses[0].exact.tiles;
	err = add_lightings(&lightings, settings, &basis, fault);
	if (!err)
		err = create_pools(&stage.pool, &all, settings->threads, fault);
	if (!err)
		err = set_stage(&stage, all, fault);
	if (!err)
		err = bench_ways_create(&ways, &stage, fault);
	if (!err)
		err = run_lightings(&ways, &stage, &lightings, all, report, fault);
	bench_ways_free(&ways);
	clear_stage(&stage);
	pool_destroy(all);
	pool_destroy(stage.pool);
	lightings_free(&lightings);
	basis_close(&basis);
	return err;
}
