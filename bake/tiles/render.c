/* SPDX-License-Identifier: MIT */
#include "bake/tiles/render.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/progress.h"
#include "bake/scene/footprint.h"
#include "bake/scene/keyframes.h"
#include "bake/tiles/in_order.h"
#include "bake/tiles/peaks.h"
#include "bake/tiles/tile_noise.h"
#include "bake/trace/cache.h"
#include "hal/base/pool.h"

/* In scenes with stand-ins, a pixel whose ratio no lighting changes by more than RATIO_SHARE of the
 * error asked for is not stored. Near white, a change of the ratio by 1 is at most LEVELS_OF_RATIO
 * 8-bit levels: 255 times the slope of sRGB at 1, 1.055 / 2.4 = 0.44. */
#define RATIO_SHARE 0.5
#define LEVELS_OF_RATIO 112

/* The mean of so many is off by 1.6 %, of what is a part of the ground's light. */
#define COAT_SAMPLES 4096

/* There is a record of the cache for each RECORD_RAYS camera rays, so that making it takes a small
 * part of the bake. If the noise decides, a pixel counts as RECORD_SAMPLES rays, the least it
 * has. */
#define RECORD_RAYS 128
#define RECORD_SAMPLES 16
/*
 * A preview. One bounce shows what a mirror reflects, and light from the ground. Half the lights,
 * half the samples or twice the error would each save a tenth to a fifth of its time.
 */
#define PREVIEW_FREQUENCY 3
#define PREVIEW_SAMPLES 4
#define PREVIEW_BOUNCES 1
#define PREVIEW_RMS 8.0
#define PREVIEW_CELL 32.0

/* State of one thread. */
struct render_worker {
	struct tile tile;
	struct encoder *encoder;
	float (*peak)[3]; /* [lights + 1] */
};

/* State of one bake. */
struct render_job {
	struct scene *scene;
	struct render_settings settings;
	struct dome dome;
	struct cells cells;
	struct plan plan;
	struct ensemble ensemble;
	struct pool *pool;
	struct render_worker *workers;
	int worker_count;
	struct cache *cache; /* the current pose's; NULL: none */
	/* Finished tiles go to one of these; the other is NULL. */
	struct assembly *assembly;
	struct shard_writer *shard;
	struct progress progress;
	int first_pose, pose; /* poses of the scene: the first and the current one of this bake */
	/* This bake makes the tiles first + k * step, k = 0..tiles-1, of the current pose. */
	int tiles, first, step;
	int tiles_all, done; /* numbers of tiles of all poses, and of earlier poses */
	double seconds;	     /* sum over finished tiles */
	uint64_t rays;
	bool object_seen;
};

struct render_settings render_settings_of(const struct scene *scene)
{
	const struct scene_render_values *r = &scene->file->render;

	return (struct render_settings){
		.frequency = scene->file->dome.frequency,
		.fine = &scene->fine,
		.samples = r->samples,
		.noise_levels = r->noise_levels,
		.bounces = r->bounces,
		.seed = r->seed,
		.target = {.rms = r->error_rms, .max = r->error_max, .cell = r->error_cell},
		.column_cut = r->column_cut,
		.coarse = r->coarse,
		.exact = r->exact,
		.cache = r->cache,
	};
}

struct render_settings render_preview_of(const struct render_settings *settings)
{
	struct render_settings s = *settings;

	s.preview = true;
	s.frequency = (int)fmin(s.frequency, PREVIEW_FREQUENCY);
	s.fine = NULL;
	s.coarse = 0;
	s.samples = s.noise_levels > 0 ? PREVIEW_SAMPLES : (int)fmin(s.samples, PREVIEW_SAMPLES);
	s.noise_levels = 0;
	s.bounces = (int)fmin(s.bounces, PREVIEW_BOUNCES);
	s.target.rms = fmax(s.target.rms, PREVIEW_RMS);
	s.target.max = fmax(s.target.max, RENDER_MAX_OF_RMS * s.target.rms);
	s.target.cell = fmax(s.target.cell, PREVIEW_CELL);
	s.exact = false;
	return s;
}

/* ---- tiles ---- */

/* Creates each thread's tile for the scene's current pose, as tiles point to its world. */
static int create_tiles(struct render_job *job)
{
	const struct tile_settings tile = {
		.samples = job->settings.samples,
		.noise_levels = job->settings.noise_levels,
		.ratio_cut = RATIO_SHARE / LEVELS_OF_RATIO *
			     fmin(job->settings.target.rms, job->settings.target.cell),
		.seed = (uint64_t)job->settings.seed,
		.ensemble = &job->ensemble,
	};
	int err = 0;

	for (int k = 0; k < job->worker_count && !err; k++) {
		tile_free(&job->workers[k].tile);
		err = tile_create(&job->workers[k].tile, job->scene, &job->cells, &tile,
				  job->settings.bounces);
		job->workers[k].tile.transport.cache = job->cache;
	}
	return err;
}

/* Finds the first surface at a point of the picture, 0..1 each, for the cache. */
static bool render_look(void *context, double x, double y, struct surface *surface,
			struct v3 *direction)
{
	const struct scene *scene = ((const struct render_job *)context)->scene;

	return scene_look(scene, WITH_OBJECTS, x * scene->camera.width, y * scene->camera.height,
			  surface, direction);
}

static int cache_records(const struct render_job *job)
{
	const struct render_settings *s = &job->settings;
	const double samples = s->noise_levels > 0 ? RECORD_SAMPLES : s->samples;
	const double rays = samples * job->plan.info.width * job->plan.info.height;

	return (int)fmin(rays / RECORD_RAYS, CACHE_RECORDS_MAX);
}

/* Makes the cache of the scene's current pose. */
static int create_cache(struct render_job *job)
{
	const struct cache_settings settings = {
		.world = job->scene->world,
		.cells = &job->cells,
		.bounces = job->settings.bounces,
		.seed = (uint64_t)job->settings.seed,
		.records = cache_records(job),
		.look = render_look,
		.context = job,
	};

	cache_destroy(job->cache);
	job->cache = NULL;
	return job->settings.cache ? cache_create(&job->cache, &settings, job->pool) : 0;
}

/* Fills the statistics of a finished tile. */
static void account_for(const struct tile *tile, const struct encode_result *result,
			struct tile_account *account)
{
	*account = (struct tile_account){
		.error = result->error,
		.object_error = result->object_error,
		.ratio_error = fmax(result->ratio_error, tile->result.ratio_error),
		.noise_square = tile->noise->square,
		.noise_count = tile->noise->count,
		.rays = tile->transport.ray_count,
	};
	memcpy(account->coverage, tile->result.coverage, sizeof(account->coverage));
	memcpy(account->distance, tile->result.distance, sizeof(account->distance));
}

/* Renders and encodes a tile. The encoder's blocks live until its next tile, so they are copied. */
static int render_make_tile(void *context, int index, int number, struct finished_tile *finished,
			    struct fault *fault)
{
	struct render_job *job = context;
	struct render_worker *worker = &job->workers[number];
	struct tile *tile = &worker->tile;
	struct encode_result result = {.shown = NULL};
	const int place = job->first + index * job->step;
	int err;

	tile->transport.ray_count = 0;
	tile_render(tile, place);
	for (int k = 0; k < tile->result.part_count; k++)
		peaks_grow(worker->peak, &tile->result.part[k], job->dome.count);
	err = encode_tile(worker->encoder, place, tile->result.opaque, tile->result.part,
			  tile->result.part_count, &result);
	if (!err)
		err = finished_tile_keep(finished, result.shown, result.shown_count, result.exact,
					 result.exact_count);
	if (!err)
		err = finished_tile_keep_glass(finished, tile->result.glass,
					       tile->result.glass_count);
	if (err)
		return fault_say(
			fault, err, "a tile cannot be encoded: %s",
			err == -EDOM
				? "its light transport is not finite, or a cell's light comes back more than 65,000 times as strong"
				: strerror(-err));
	finished->tile = place;
	finished->pose = job->pose - job->first_pose;
	account_for(tile, &result, &finished->account);
	return 0;
}

static int render_take_tile(void *context, const struct finished_tile *tile, struct fault *fault)
{
	struct render_job *job = context;

	job->rays += tile->account.rays;
	job->seconds += tile->seconds;
	for (int k = 0; k < TILE_PIXELS; k++)
		job->object_seen |= tile->account.coverage[k] > 0;
	return job->shard ? shard_writer_add(job->shard, tile, fault)
			  : assembly_add(job->assembly, tile, fault);
}

/* Sets the tiles of the current pose that this bake or shard makes. */
static void set_tiles(struct render_job *job)
{
	const struct shard_place *shard = &job->settings.shard;
	const int all = plan_tiles(&job->plan);

	job->first = shard->count ? shard_first(shard, all, job->pose - job->first_pose) : 0;
	job->step = shard->count ? shard->count : 1;
	job->tiles = job->first < all ? (all - job->first - 1) / job->step + 1 : 0;
}

static int render_end_pose(struct render_job *job, struct fault *fault)
{
	const size_t bytes = ((size_t)job->dome.count + 1) * sizeof(*job->workers->peak);
	float(*peak)[3] = job->workers[0].peak;
	struct basis_footprint foot;
	int err;

	for (int k = 1; k < job->worker_count; k++) {
		peaks_join(peak, (const float(*)[3])job->workers[k].peak, job->dome.count);
		memset(job->workers[k].peak, 0, bytes);
	}
	footprint_of_scene(job->scene, &foot);
	err = job->shard ? shard_writer_pose_end(job->shard, (const float(*)[3])peak, &foot, fault)
			 : assembly_pose_end(job->assembly, (const float(*)[3])peak, &foot, fault);
	memset(peak, 0, bytes);
	return err;
}

static int render_make_pose(struct render_job *job, struct fault *fault)
{
	const struct in_order work = {
		.tiles = job->tiles,
		.tiles_after = job->tiles_all - job->done - job->tiles,
		.rays_before = job->rays,
		.seconds_before = job->seconds,
		.context = job,
		.make = render_make_tile,
		.take = render_take_tile,
		.progress = &job->progress,
	};
	int err = scene_take_pose(job->scene, job->pose, fault);

	if (err)
		return err;
	err = create_cache(job);
	if (!err)
		err = create_tiles(job);
	if (err)
		return fault_say(fault, err, "the bake cannot go on: %s", strerror(-err));
	err = in_order_run(&work, job->pool, fault);
	job->done += job->tiles;
	return err ? err : render_end_pose(job, fault);
}

static int render_make_all(struct render_job *job, struct render_report *report,
			   struct fault *fault)
{
	const int poses = (int)job->plan.info.poses;
	int err = 0;

	for (int p = 0; p < poses; p++) {
		job->pose = job->first_pose + p;
		set_tiles(job);
		job->tiles_all += job->tiles;
	}
	progress_begin(&job->progress, job->settings.preview ? "preview" : "bake", job->tiles_all,
		       job->settings.quiet);
	for (int p = 0; p < poses && !err; p++) {
		job->pose = job->first_pose + p;
		set_tiles(job);
		err = render_make_pose(job, fault);
	}
	report->seconds = progress_end(&job->progress);
	report->rays = job->rays;
	report->object_seen = job->object_seen;
	return err;
}

/* ---- setting up ---- */

/*
 * Adds what a coat on the ground mirrors towards the camera, as the mean around the first pose's
 * objects: the light of each pixel would show edges of cells.
 */
static void add_coat(struct render_job *job)
{
	const struct scene *scene = job->scene;
	const struct bsdf *bsdf = world_ground_bsdf(scene->world);
	const struct bounds around = world_bounds(scene->world, WITH_OBJECTS);
	const struct v3 up = {0, 0, 1};
	const float albedo = (bsdf->colour.c[0] + bsdf->colour.c[1] + bsdf->colour.c[2]) / 3;
	struct random random = {.state = 0};

	for (int k = 0; bsdf->kind == MATERIAL_GLOSSY && k < COAT_SAMPLES; k++) {
		struct v3 wi, at = {around.centre.x, around.centre.y, 0}, wo;
		float x, y, density;
		struct rgb f;
		int cell;

		disc_from_square(random_next(&random), random_next(&random), &x, &y);
		at.x += around.radius * x;
		at.y += around.radius * y;
		wo = v3_unit(v3_sub(scene->eye, at));
		if (!bsdf_coat_sample(bsdf, up, wo, &random, &wi))
			continue;
		f = bsdf_coat(bsdf, up, wo, wi, &density);
		cell = cells_of(&job->cells, wi);
		if (cell >= 0 && density > 0)
			job->cells.shown[cell] +=
				(f.c[0] + f.c[1] + f.c[2]) / 3 /
				(density * albedo * COAT_SAMPLES * bsdf_base_mean(bsdf, wo.z));
	}
}

/* u of the ground: albedo / pi * projected solid angle, and its coat */
static int set_ground(struct render_job *job)
{
	const size_t n = (size_t)job->dome.count;

	job->plan.ground = calloc(3 * n, sizeof(*job->plan.ground));
	if (!job->plan.ground)
		return -ENOMEM;
	add_coat(job);
	for (size_t c = 0; c < 3; c++)
		for (size_t i = 0; i < n; i++)
			job->plan.ground[c * n + i] =
				job->scene->ground_albedo[c] / M_PI *
				(job->dome.projected_sr[i] +
				 M_PI * (double)(job->cells.shown[i] - job->cells.share[i]));
	return 0;
}

static int render_start_workers(struct render_job *job)
{
	const struct encode_settings encode = {
		.lights = job->dome.count,
		.grounds = (int)job->plan.info.grounds,
		.light = job->plan.light,
		.ground = job->plan.ground,
		.coarse = (int)job->plan.info.coarse,
		.gather = job->plan.gather,
		.ensemble = &job->ensemble,
		.target = job->settings.target,
		.column_cut = job->plan.info.column_cut,
		.exact = job->settings.exact,
	};
	int err = pool_create(&job->pool, job->settings.threads);

	if (err)
		return err;
	job->worker_count = pool_threads(job->pool);
	job->workers = calloc((size_t)job->worker_count, sizeof(*job->workers));
	if (!job->workers)
		return -ENOMEM;
	for (int k = 0; k < job->worker_count && !err; k++) {
		struct render_worker *w = &job->workers[k];

		w->peak = calloc((size_t)job->dome.count + 1, sizeof(*w->peak));
		if (!w->peak)
			return -ENOMEM;
		err = encoder_create(&w->encoder, &encode);
	}
	return err;
}

/* Writes all that determines the file: program, scene, options. */
static void write_provenance(struct render_job *job)
{
	const struct render_settings *s = &job->settings;
	const struct basis_info_chunk *info = &job->plan.info;

	snprintf(job->plan.provenance, sizeof(job->plan.provenance),
		 "program = inlay-bake %s\n"
		 "%sscene_xxh3 = %016llx\n"
		 "size = %u x %u\n"
		 "dome = frequency %d, %u lights\n"
		 "samples = %d\n"
		 "noise_target_levels = %g\n"
		 "bounces = %d\n"
		 "seed = %d\n" PLAN_TARGET_LINE "column_cut = %.9g\n"
		 "coarse_lights = %u\n"
		 "exact = %s\n%s",
		 INLAY_VERSION, s->preview ? BASIS_PREVIEW_LINE : "",
		 (unsigned long long)job->scene->hash, info->width, info->height, s->frequency,
		 info->lights, s->noise_levels > 0 ? 0 : s->samples, s->noise_levels, s->bounces,
		 s->seed, s->target.rms, s->target.max, s->target.cell, info->column_cut,
		 info->coarse, s->exact ? "yes" : "no", s->cache ? "cache = yes\n" : "");
	if (job->scene->file->poses.count > 1) {
		const size_t used = strlen(job->plan.provenance);

		snprintf(job->plan.provenance + used, sizeof(job->plan.provenance) - used,
			 "poses = %u of %d, from %d\n", info->poses, job->scene->file->poses.count,
			 job->first_pose);
	}
}

static int render_open_file(struct render_job *job, const char *path, struct fault *fault)
{
	const int err = scene_camera_text(job->scene, job->plan.camera, sizeof(job->plan.camera));

	if (err)
		return fault_say(fault, err, "%s: the camera cannot be written", path);
	write_provenance(job);
	if (job->settings.shard.count)
		return shard_writer_open(&job->shard, &job->plan, &job->settings.shard, path,
					 fault);
	return assembly_open(&job->assembly, &job->plan, path, fault);
}

/* Sets the poses to bake, and their names. */
static int set_poses(struct render_job *job, struct fault *fault)
{
	const struct scene_file *file = job->scene->file;
	const int poses = job->settings.pose ? 1 : file->poses.count;
	struct fault what = {.text = ""};

	if (job->settings.pose) {
		job->first_pose = keyframe_find_pose(file, job->settings.pose, &what);
		if (job->first_pose < 0)
			return fault_say(fault, job->first_pose, "%s: %s", job->scene->path,
					 what.text);
	}
	job->plan.info.poses = (uint32_t)poses;
	if (file->poses.count == 1)
		return 0;
	job->plan.names = calloc((size_t)poses, sizeof(*job->plan.names));
	if (!job->plan.names)
		return fault_say(fault, -ENOMEM, "out of memory");
	for (int p = 0; p < poses; p++)
		strcpy(job->plan.names[p].text, keyframe_pose_name(file, job->first_pose + p));
	return 0;
}

static int render_set_up(struct render_job *job, const char *path, struct fault *fault)
{
	const struct tsai_camera *camera = &job->scene->camera;
	int err = fine_list_dome(job->settings.fine, job->settings.frequency, &job->dome, fault);

	if (err)
		return err;
	job->plan.info = (struct basis_info_chunk){
		.width = (uint32_t)camera->width,
		.height = (uint32_t)camera->height,
		.grounds = world_has_ground(job->scene->world) ? 1 : 0,
		.column_cut = job->settings.column_cut,
	};
	err = plan_set_lights(&job->plan, &job->dome, job->settings.coarse, fault);
	if (!err)
		err = set_poses(job, fault);
	if (err)
		return err;
	err = cells_create(&job->cells, &job->dome);
	if (!err)
		err = set_ground(job);
	if (!err)
		err = ensemble_create(&job->ensemble, job->plan.light, job->dome.count);
	if (!err)
		err = render_start_workers(job);
	if (err)
		return fault_say(fault, err, "%s: the bake cannot start: %s", path, strerror(-err));
	return render_open_file(job, path, fault);
}

static void render_tear_down(struct render_job *job)
{
	assembly_abandon(job->assembly);
	shard_writer_abandon(job->shard);
	pool_destroy(job->pool);
	for (int k = 0; k < job->worker_count && job->workers; k++) {
		tile_free(&job->workers[k].tile);
		encoder_destroy(job->workers[k].encoder);
		free(job->workers[k].peak);
	}
	cache_destroy(job->cache);
	free(job->workers);
	plan_free(&job->plan);
	ensemble_free(&job->ensemble);
	cells_free(&job->cells);
	dome_free(&job->dome);
}

/* ---- finishing ---- */

static int render_finish(struct render_job *job, struct render_report *report, struct fault *fault)
{
	struct assembly_report all = {.info = job->plan.info};
	struct assembly *assembly = job->assembly;
	struct shard_writer *shard = job->shard;
	int err;

	job->assembly = NULL; /* the calls below free both */
	job->shard = NULL;
	if (shard)
		err = shard_writer_finish(shard, fault);
	else
		err = assembly_finish(assembly, &all, fault);
	report->info = all.info;
	report->shown_bytes = all.shown_bytes;
	report->exact_bytes = all.exact_bytes;
	report->miss = all.miss;
	return err;
}

int render_run(struct scene *scene, const struct render_settings *settings, const char *path,
	       struct render_report *report, struct fault *fault)
{
	struct render_job *job = calloc(1, sizeof(*job));
	int err;

	if (!job)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	job->scene = scene;
	job->settings = *settings;
	if (!(settings->target.max > 0))
		job->settings.target.max = RENDER_MAX_OF_RMS * settings->target.rms;
	err = render_set_up(job, path, fault);
	if (!err)
		err = render_make_all(job, report, fault);
	if (!err)
		err = render_finish(job, report, fault);
	render_tear_down(job);
	free(job);
	return err;
}
