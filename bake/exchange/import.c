/* SPDX-License-Identifier: MIT */
#include "bake/exchange/import.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/tiles/in_order.h"
#include "bake/tiles/peaks.h"
#include "hal/base/pool.h"

#define MAX_OF_RMS 2 /* default of target.max, in units of target.rms */

/* The state of one thread. */
struct import_worker {
	struct import_tile tile;
	struct encoder *encoder;
	float *row[3]; /* [IMPORT_PIXELS][3][lights]: of T; V or D; U */
	uint16_t object_pixel[IMPORT_PIXELS], receiver_pixel[IMPORT_PIXELS];
	float (*peak)[3]; /* [lights + 1] */
};

struct import_job {
	const struct import_source *source;
	struct plan plan;
	struct ensemble ensemble;
	struct pool *pool;
	struct import_worker *worker;
	int workers;
	struct assembly *assembly;
};

/* ---- a tile ---- */

static void place_tile(const struct import_job *job, int index, struct import_tile *tile)
{
	const int width = job->source->width, height = job->source->height;
	const int across = (width + BASIS_TILE - 1) / BASIS_TILE;

	tile->x = index % across * BASIS_TILE;
	tile->y = index / across * BASIS_TILE;
	tile->width = width - tile->x < BASIS_TILE ? width - tile->x : BASIS_TILE;
	tile->height = height - tile->y < BASIS_TILE ? height - tile->y : BASIS_TILE;
}

/* v = 1 - s / u: the share of each light that the object takes from flat ground. */
static void take_shares(float *to, const float *with, const double *ground, size_t count)
{
	for (size_t k = 0; k < count; k++)
		to[k] = ground[k] > 0 ? (float)(1 - (double)with[k] / ground[k]) : 0;
}

/* Lays the tile's pixels out for the encoder. Returns the number of kinds. */
static int sort_pixels(const struct import_job *job, struct import_worker *w,
		       struct encode_samples part[3])
{
	const struct import_source *source = job->source;
	const size_t row = 3 * (size_t)source->dome->count, bytes = row * sizeof(float);
	const struct import_tile *tile = &w->tile;
	int objects = 0, receivers = 0, parts = 0;

	for (int p = 0; p < IMPORT_PIXELS; p++) {
		const size_t from = (size_t)p * row;

		if (p % BASIS_TILE >= tile->width || p / BASIS_TILE >= tile->height)
			continue;
		if (tile->coverage[p] > 0) {
			memcpy(w->row[0] + (size_t)objects * row, tile->object + from, bytes);
			w->object_pixel[objects++] = (uint16_t)p;
		}
		if (tile->receiver[p]) {
			float *change = w->row[1] + (size_t)receivers * row;

			if (source->ground)
				take_shares(change, tile->with + from, source->ground, row);
			for (size_t k = 0; !source->ground && k < row; k++)
				change[k] = tile->without[from + k] - tile->with[from + k];
			memcpy(w->row[2] + (size_t)receivers * row, tile->without + from, bytes);
			w->receiver_pixel[receivers++] = (uint16_t)p;
		}
	}
	if (objects)
		part[parts++] = (struct encode_samples){.kind = BASIS_KIND_T,
							.pixels = objects,
							.pixel = w->object_pixel,
							.channels = 3,
							.direct = w->row[0]};
	for (int k = 0; receivers && k < (source->ground ? 1 : 2); k++)
		part[parts++] = (struct encode_samples){.kind = source->ground ? BASIS_KIND_V
								: k	       ? BASIS_KIND_U
									       : BASIS_KIND_D,
							.pixels = receivers,
							.pixel = w->receiver_pixel,
							.channels = 3,
							.direct = w->row[1 + k]};
	return parts;
}

static int import_make_tile(void *context, int index, int number, struct finished_tile *finished,
			    struct fault *fault)
{
	struct import_job *job = context;
	struct import_worker *w = &job->worker[number];
	uint16_t *coverage = finished->account.coverage;
	struct encode_result result = {.shown = NULL};
	struct encode_samples part[3];
	int err, parts;

	memset(w->tile.coverage, 0, sizeof(w->tile.coverage));
	memset(w->tile.receiver, 0, sizeof(w->tile.receiver));
	place_tile(job, index, &w->tile);
	job->source->fill(job->source->context, &w->tile);
	for (int p = 0; p < IMPORT_PIXELS; p++)
		coverage[p] = (uint16_t)lrintf(65535 * fminf(w->tile.coverage[p], 1));
	parts = sort_pixels(job, w, part);
	for (int k = 0; k < parts; k++)
		peaks_grow(w->peak, &part[k], job->source->dome->count);
	err = encode_tile(w->encoder, index, coverage, part, parts, &result);
	if (!err)
		err = finished_tile_keep(finished, result.shown, result.shown_count, result.exact,
					 result.exact_count);
	if (err)
		return fault_say(
			fault, err, "the tile at %d, %d cannot be encoded: %s", w->tile.x,
			w->tile.y,
			err == -EDOM
				? "a value is not finite, negative where light comes from a real surface, or beyond 65,000"
				: strerror(-err));
	finished->tile = index;
	finished->account.distance[0][0] = -1; /* pictures do not tell it */
	finished->account.error = result.error;
	finished->account.object_error = result.object_error;
	finished->account.ratio_error = result.ratio_error;
	return 0;
}

static int import_take_tile(void *context, const struct finished_tile *tile, struct fault *fault)
{
	const struct import_job *job = context;

	return assembly_add(job->assembly, tile, fault);
}

/* ---- all of it ---- */

static int create_worker(struct import_worker *w, size_t lights,
			 const struct encode_settings *encode)
{
	const size_t size = IMPORT_PIXELS * 3 * lights;

	w->tile.object = malloc(size * sizeof(float));
	w->tile.with = malloc(size * sizeof(float));
	w->tile.without = malloc(size * sizeof(float));
	w->peak = calloc(lights + 1, sizeof(*w->peak));
	for (int k = 0; k < 3; k++) {
		w->row[k] = malloc(size * sizeof(float));
		if (!w->row[k])
			return -ENOMEM;
	}
	if (!w->tile.object || !w->tile.with || !w->tile.without || !w->peak)
		return -ENOMEM;
	return encoder_create(&w->encoder, encode);
}

static void free_worker(struct import_worker *w)
{
	free(w->tile.object);
	free(w->tile.with);
	free(w->tile.without);
	free(w->peak);
	for (int k = 0; k < 3; k++)
		free(w->row[k]);
	encoder_destroy(w->encoder);
}

static int set_plan(struct import_job *job, const struct import_settings *settings,
		    struct fault *fault)
{
	const struct import_source *source = job->source;
	struct plan *plan = &job->plan;
	const size_t numbers = 3 * (size_t)source->dome->count;
	int err;

	plan->info = (struct basis_info_chunk){
		.width = (uint32_t)source->width,
		.height = (uint32_t)source->height,
		.grounds = source->ground ? 1 : 0,
		.poses = 1,
		.column_cut = settings->column_cut,
	};
	err = plan_set_lights(plan, source->dome, settings->coarse, fault);
	if (err)
		return err;
	plan->ground = calloc(numbers, sizeof(*plan->ground));
	if (!plan->ground)
		return fault_say(fault, -ENOMEM, "out of memory");
	if (source->ground)
		memcpy(plan->ground, source->ground, numbers * sizeof(*plan->ground));
	snprintf(plan->provenance, sizeof(plan->provenance),
		 "program = inlay-bake %s\n"
		 "%ssize = %d x %d\n"
		 "dome = frequency %d, %d lights\n" PLAN_TARGET_LINE
		 "column_cut = %.9g\ncoarse_lights = %u\n"
		 "exact = %s\n",
		 INLAY_VERSION, source->provenance, source->width, source->height,
		 source->dome->frequency, source->dome->count, settings->target.rms,
		 settings->target.max, settings->target.cell, plan->info.column_cut,
		 plan->info.coarse, settings->exact ? "yes" : "no");
	return 0;
}

static int import_start_workers(struct import_job *job, const struct import_settings *settings)
{
	const struct encode_settings encode = {
		.lights = job->source->dome->count,
		.grounds = (int)job->plan.info.grounds,
		.light = job->plan.light,
		.ground = job->plan.ground,
		.coarse = (int)job->plan.info.coarse,
		.gather = job->plan.gather,
		.ensemble = &job->ensemble,
		.target = settings->target,
		.column_cut = job->plan.info.column_cut,
		.exact = settings->exact,
	};
	int err = ensemble_create(&job->ensemble, job->plan.light, encode.lights);

	if (!err)
		err = pool_create(&job->pool, settings->threads);
	if (err)
		return err;
	job->workers = pool_threads(job->pool);
	job->worker = calloc((size_t)job->workers, sizeof(*job->worker));
	if (!job->worker)
		return -ENOMEM;
	for (int k = 0; !err && k < job->workers; k++)
		err = create_worker(&job->worker[k], (size_t)encode.lights, &encode);
	return err;
}

static int import_finish(struct import_job *job, struct assembly_report *report,
			 struct fault *fault)
{
	float(*peak)[3] = job->worker[0].peak;
	struct assembly *assembly = job->assembly;
	int err;

	for (int k = 1; k < job->workers; k++)
		peaks_join(peak, (const float(*)[3])job->worker[k].peak, job->source->dome->count);
	err = assembly_pose_end(assembly, (const float(*)[3])peak, NULL, fault);
	if (!err) {
		job->assembly = NULL; /* finishing frees it */
		err = assembly_finish(assembly, report, fault);
	}
	return err;
}

static int import_make_all(struct import_job *job, bool quiet, struct fault *fault)
{
	struct progress progress;
	const struct in_order work = {
		.tiles = plan_tiles(&job->plan),
		.context = job,
		.make = import_make_tile,
		.take = import_take_tile,
		.progress = &progress,
	};
	int err;

	progress_begin(&progress, "import", work.tiles, quiet);
	err = in_order_run(&work, job->pool, fault);
	progress_end(&progress);
	return err;
}

static void import_tear_down(struct import_job *job)
{
	assembly_abandon(job->assembly);
	pool_destroy(job->pool);
	for (int k = 0; k < job->workers && job->worker; k++)
		free_worker(&job->worker[k]);
	free(job->worker);
	ensemble_free(&job->ensemble);
	plan_free(&job->plan);
}

int import_run(const struct import_source *source, const struct import_settings *settings,
	       const char *path, struct assembly_report *report, struct fault *fault)
{
	struct import_settings chosen = *settings;
	struct import_job *job = calloc(1, sizeof(*job));
	int err;

	if (!job)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	if (!(chosen.target.max > 0))
		chosen.target.max = MAX_OF_RMS * chosen.target.rms;
	job->source = source;
	err = set_plan(job, &chosen, fault);
	if (!err) {
		err = import_start_workers(job, &chosen);
		if (err)
			fault_say(fault, err, "%s: the import cannot start: %s", path,
				  strerror(-err));
	}
	if (!err)
		err = assembly_open(&job->assembly, &job->plan, path, fault);
	if (!err)
		err = import_make_all(job, chosen.quiet, fault);
	if (!err)
		err = import_finish(job, report, fault);
	import_tear_down(job);
	free(job);
	return err;
}
