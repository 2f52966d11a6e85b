#include "bake/render.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "bake/coarse.h"
#include "bake/progress.h"
#include "bake/tile.h"
#include "hal/pool.h"

/* Tiles that may be done before the one whose turn it is in the file. */
#define WINDOW 64
#define TEXT_MAX 4096

/* Of a real surface with a u of its own: a pixel whose ratio never changes by more than this share
 * of the error asked for is not stored. Near white, a ratio's change is at most so many levels. */
#define RATIO_SHARE 0.5
#define LEVELS_OF_RATIO 112

/* A finished tile that waits for its turn. */
struct waiting {
	struct basis_block_payload *blocks; /* shown ones, exact ones, then their payloads */
	int shown, exact;
	struct ensemble_error error;
	double noise_square;
	long noise_count;
	bool ready;
};

struct worker {
	struct tile tile;
	struct encoder *encoder;
	float (*peak)[3];
};

/* One bake. */
struct job {
	const struct scene *scene;
	struct render_settings settings;
	struct dome dome;
	struct cells cells;
	double *ground; /* [3][lights] */
	struct basis_light *lights;
	struct basis_coarse *gather; /* NULL: each light is its own */
	struct ensemble ensemble;
	uint16_t *coverage;
	struct pool *pool;
	struct worker *workers;
	int worker_count;
	struct basis_writer *writer;
	struct basis_info_chunk info;
	struct progress progress;
	/* under the lock: */
	pthread_mutex_t lock;
	pthread_cond_t turned; /* next has moved, or the job has failed */
	struct waiting waiting[WINDOW];
	int next, tiles, err;
	uint64_t rays, shown_bytes, exact_bytes;
	struct ensemble_error error;
	double noise_square;
	long noise_count;
	struct fault fault;
};

struct render_settings render_settings_of(const struct scene *scene)
{
	const struct scene_render_values *r = &scene->file->render;

	return (struct render_settings){
		.frequency = scene->file->dome.frequency,
		.division = scene->file->dome.division,
		.samples = r->samples,
		.noise_levels = r->noise_levels,
		.bounces = r->bounces,
		.seed = r->seed,
		.target = {.rms = r->error_rms, .max = r->error_max, .cell = r->error_cell},
		.column_cut = r->column_cut,
		.coarse = r->coarse,
		.exact = r->exact,
	};
}

/* ---- in order into the file ---- */

static uint64_t payload_bytes(const struct basis_block_payload *blocks, int count)
{
	uint64_t bytes = 0;

	for (int k = 0; k < count; k++)
		bytes += blocks[k].entry.bytes;
	return bytes;
}

static uint8_t *copy_blocks(struct basis_block_payload *to, const struct basis_block_payload *from,
			    int count, uint8_t *data)
{
	for (int k = 0; k < count; k++) {
		to[k] = from[k];
		to[k].payload = memcpy(data, from[k].payload, from[k].entry.bytes);
		data += from[k].entry.bytes;
	}
	return data;
}

/* The encoder's blocks live until its next tile: this keeps a copy. */
static int keep_blocks(struct waiting *slot, const struct encode_result *result)
{
	const size_t entries = (size_t)(result->shown_count + result->exact_count) *
			       sizeof(*slot->blocks);
	uint8_t *data = malloc(entries + payload_bytes(result->shown, result->shown_count) +
			       payload_bytes(result->exact, result->exact_count) + 1);

	if (!data)
		return -ENOMEM;
	slot->blocks = (struct basis_block_payload *)(void *)data;
	slot->shown = result->shown_count;
	slot->exact = result->exact_count;
	slot->error = result->error;
	data = copy_blocks(slot->blocks, result->shown, slot->shown, data + entries);
	copy_blocks(slot->blocks + slot->shown, result->exact, slot->exact, data);
	return 0;
}

static void fail(struct job *job, int err)
{
	if (!job->err)
		job->err = err;
	pthread_cond_broadcast(&job->turned);
}

static int write_slot(struct job *job, const struct waiting *slot)
{
	const struct basis_block_payload *exact = slot->blocks + slot->shown;
	int err = 0;

	if (slot->shown)
		err = basis_writer_blocks(job->writer, slot->blocks, slot->shown, &job->fault);
	if (!err && slot->exact)
		err = basis_writer_exact_blocks(job->writer, exact, slot->exact, &job->fault);
	job->shown_bytes += payload_bytes(slot->blocks, slot->shown);
	job->exact_bytes += payload_bytes(exact, slot->exact);
	return err;
}

/* Writes every tile whose turn has come. The lock is held. */
static void write_ready(struct job *job)
{
	while (job->waiting[job->next % WINDOW].ready) {
		struct waiting *slot = &job->waiting[job->next % WINDOW];
		const int err = write_slot(job, slot);

		/* In the tiles' order: sums that are the same whatever the threads. */
		ensemble_error_add(&job->error, &slot->error);
		job->noise_square += slot->noise_square;
		job->noise_count += slot->noise_count;
		free(slot->blocks);
		*slot = (struct waiting){.blocks = NULL};
		job->next++;
		if (err) {
			fail(job, err);
			return;
		}
	}
	pthread_cond_broadcast(&job->turned);
}

/* False when the job has failed. Tiles are begun in order, so the one whose turn it is is always in
 * some thread's hands, and waiting ends. */
static bool wait_for_room(struct job *job, int index)
{
	bool go_on;

	pthread_mutex_lock(&job->lock);
	while (!job->err && index >= job->next + WINDOW)
		pthread_cond_wait(&job->turned, &job->lock);
	go_on = !job->err;
	pthread_mutex_unlock(&job->lock);
	return go_on;
}

static void hand_over(struct job *job, int index, const struct tile *tile,
		      const struct encode_result *result, int err)
{
	struct waiting *slot = &job->waiting[index % WINDOW];

	pthread_mutex_lock(&job->lock);
	if (!err)
		err = keep_blocks(slot, result);
	if (err) {
		fault_say(&job->fault, err, "a tile cannot be encoded: %s",
			  err == -EDOM ? "its light transport is not finite, or a cell's light "
					 "comes back more than 65,000 times as strong"
				       : strerror(-err));
		fail(job, err);
	} else if (!job->err) {
		slot->noise_square = tile->noise_square;
		slot->noise_count = tile->noise_count;
		slot->ready = true;
		job->info.object_error = fmax(job->info.object_error, result->object_error);
		job->info.ratio_error = fmax(job->info.ratio_error,
					     fmax(result->ratio_error, tile->ratio_error));
		job->rays += tile->transport.ray_count;
		write_ready(job);
		progress_show(&job->progress, job->next, job->rays);
	}
	pthread_mutex_unlock(&job->lock);
}

static void store_coverage(struct job *job, const struct tile *tile)
{
	for (int y = 0; y < tile->height; y++)
		memcpy(job->coverage + (size_t)(tile->y + y) * job->info.width + tile->x,
		       tile->coverage + y * BASIS_TILE,
		       (size_t)tile->width * sizeof(*job->coverage));
}

static void work(void *context, int index, int number)
{
	struct job *job = context;
	struct worker *worker = &job->workers[number];
	struct tile *tile = &worker->tile;
	struct encode_result result = {.shown = NULL};
	int err;

	if (!wait_for_room(job, index))
		return;
	tile->transport.ray_count = 0;
	tile_render(tile, index);
	tile_peaks(tile, worker->peak);
	store_coverage(job, tile);
	err = encode_tile(worker->encoder, index, tile->coverage, tile->part, tile->part_count,
			  &result);
	hand_over(job, index, tile, &result, err);
}

/* ---- setting up ---- */

static int set_ground(struct job *job)
{
	const size_t n = (size_t)job->dome.count;

	job->ground = calloc(3 * n, sizeof(*job->ground));
	if (!job->ground)
		return -ENOMEM;
	for (size_t c = 0; c < 3; c++)
		for (size_t i = 0; i < n; i++)
			job->ground[c * n + i] = job->scene->ground_albedo[c] / M_PI *
						 job->dome.projected_sr[i];
	return 0;
}

static int start_workers(struct job *job)
{
	const struct encode_settings encode = {
		.lights = job->dome.count,
		.grounds = (int)job->info.grounds,
		.light = job->lights,
		.ground = job->ground,
		.coarse = (int)job->info.coarse,
		.gather = job->gather,
		.ensemble = &job->ensemble,
		.target = job->settings.target,
		.column_cut = job->settings.column_cut,
		.exact = job->settings.exact,
	};
	const struct tile_settings tile = {
		.samples = job->settings.samples,
		.noise_levels = job->settings.noise_levels,
		.ratio_cut = RATIO_SHARE / LEVELS_OF_RATIO *
			     fmin(job->settings.target.rms, job->settings.target.cell),
		.seed = (uint64_t)job->settings.seed,
	};
	int err = pool_create(&job->pool, job->settings.threads);

	if (err)
		return err;
	job->worker_count = pool_threads(job->pool);
	job->workers = calloc((size_t)job->worker_count, sizeof(*job->workers));
	if (!job->workers)
		return -ENOMEM;
	for (int k = 0; k < job->worker_count && !err; k++) {
		struct worker *w = &job->workers[k];

		w->peak = calloc((size_t)job->dome.count + 1, sizeof(*w->peak));
		if (!w->peak)
			return -ENOMEM;
		err = encoder_create(&w->encoder, &encode);
		if (!err)
			err = tile_create(&w->tile, job->scene, &job->cells, &tile,
					  job->settings.bounces);
	}
	return err;
}

static int set_lights(struct job *job)
{
	const size_t n = (size_t)job->dome.count;

	job->lights = calloc(n, sizeof(*job->lights));
	if (!job->lights)
		return -ENOMEM;
	for (size_t i = 0; i < n; i++) {
		memcpy(job->lights[i].direction, job->dome.direction[i],
		       sizeof(job->lights[i].direction));
		job->lights[i].solid_angle_sr = job->dome.solid_angle_sr[i];
	}
	return ensemble_create(&job->ensemble, job->lights, job->dome.count);
}

/* Sets info.coarse and gather. */
static int set_coarse(struct job *job, struct fault *fault)
{
	const int chosen = job->settings.coarse ? job->settings.coarse : COARSE_FREQUENCY;
	struct dome coarse;
	int err;

	job->info.coarse = job->info.lights;
	if (chosen >= job->dome.frequency)
		return 0;
	err = dome_create(&coarse, chosen, job->dome.division, fault);
	if (err)
		return err;
	job->info.coarse = (uint32_t)coarse.count;
	job->gather = calloc(job->info.lights, sizeof(*job->gather));
	if (job->gather)
		coarse_fill(&job->dome, &coarse, job->gather);
	else
		err = fault_say(fault, -ENOMEM, "out of memory");
	dome_free(&coarse);
	return err;
}

static int open_writer(struct job *job, const char *path, struct fault *fault)
{
	char camera[TEXT_MAX];
	int err = scene_camera_text(job->scene, camera, sizeof(camera));

	if (err)
		return fault_say(fault, err, "%s: the camera cannot be written", path);
	return basis_writer_open(&job->writer, path, &job->info, job->lights, job->ground,
				 job->gather, camera, fault);
}

static int set_up(struct job *job, const char *path, struct fault *fault)
{
	const struct tsai_camera *camera = &job->scene->camera;
	int err = dome_create(&job->dome, job->settings.frequency,
			      (enum dome_division)job->settings.division, fault);

	if (err)
		return err;
	job->info = (struct basis_info_chunk){
		.width = (uint32_t)camera->width,
		.height = (uint32_t)camera->height,
		.lights = (uint32_t)job->dome.count,
		.dome_frequency = (uint32_t)job->dome.frequency,
		.dome_division = (uint32_t)job->dome.division,
		.grounds = world_has_ground(job->scene->world) ? 1 : 0,
		.poses = 1,
		.column_cut = job->settings.column_cut,
	};
	err = set_coarse(job, fault);
	if (err)
		return err;
	job->tiles = (camera->width + BASIS_TILE - 1) / BASIS_TILE *
		     ((camera->height + BASIS_TILE - 1) / BASIS_TILE);
	job->coverage = calloc((size_t)camera->width * (size_t)camera->height,
			       sizeof(*job->coverage));
	err = cells_create(&job->cells, &job->dome);
	if (!err)
		err = set_ground(job);
	if (!err)
		err = set_lights(job);
	if (!err)
		err = start_workers(job);
	if (err || !job->coverage)
		return fault_say(fault, err ? err : -ENOMEM, "%s: the bake cannot start: %s", path,
				 strerror(err ? -err : ENOMEM));
	return open_writer(job, path, fault);
}

static void tear_down(struct job *job)
{
	basis_writer_abandon(job->writer);
	pool_destroy(job->pool);
	for (int k = 0; k < job->worker_count && job->workers; k++) {
		tile_free(&job->workers[k].tile);
		encoder_destroy(job->workers[k].encoder);
		free(job->workers[k].peak);
	}
	for (int k = 0; k < WINDOW; k++)
		free(job->waiting[k].blocks);
	free(job->workers);
	free(job->coverage);
	free(job->ground);
	free(job->lights);
	free(job->gather);
	ensemble_free(&job->ensemble);
	cells_free(&job->cells);
	dome_free(&job->dome);
	pthread_cond_destroy(&job->turned);
	pthread_mutex_destroy(&job->lock);
}

/* ---- finishing ---- */

/* What made the file, in words: nothing that differs from one run to the next. */
static void write_provenance(const struct job *job, char *text, size_t room)
{
	const struct render_settings *s = &job->settings;

	snprintf(text, room,
		 "program = inlay-bake %s\n"
		 "scene_xxh3 = %016llx\n"
		 "size = %u x %u\n"
		 "dome = frequency %d, division %s, %u lights\n"
		 "samples = %d\n"
		 "noise_target_levels = %g\n"
		 "noise_levels = %.4f\n"
		 "bounces = %d\n"
		 "seed = %d\n"
		 "target_levels = rms %g, max %g, cell %g\n"
		 "column_cut = %.9g\n"
		 "coarse_lights = %u\n"
		 "exact = %s\n"
		 "rays = %llu\n",
		 INLAY_VERSION, (unsigned long long)job->scene->hash, job->info.width,
		 job->info.height, s->frequency, dome_division_names[s->division], job->info.lights,
		 s->noise_levels > 0 ? 0 : s->samples, s->noise_levels, job->info.noise_levels,
		 s->bounces, s->seed, s->target.rms, s->target.max, s->target.cell, s->column_cut,
		 job->info.coarse, s->exact ? "yes" : "no", (unsigned long long)job->rays);
}

static int finish(struct job *job, struct fault *fault)
{
	float(*peak)[3] = job->workers[0].peak;
	char provenance[TEXT_MAX];
	struct basis_writer *writer;
	int err;

	for (int k = 1; k < job->worker_count; k++)
		for (int i = 0; i <= job->dome.count; i++)
			for (int c = 0; c < 3; c++)
				peak[i][c] = fmaxf(peak[i][c], job->workers[k].peak[i][c]);
	if (job->noise_count)
		job->info.noise_levels = sqrt(job->noise_square / (double)job->noise_count);
	job->info.sky_rms = ensemble_sky_rms(&job->error);
	job->info.sky_max = job->error.sky_max;
	job->info.cell_rms = ensemble_cell_rms(&job->error);
	job->info.cell_max = job->error.cell_max;
	write_provenance(job, provenance, sizeof(provenance));
	err = basis_writer_pose_end(job->writer, job->coverage, (const float(*)[3])peak, fault);
	if (err)
		return err;
	writer = job->writer;
	job->writer = NULL; /* finishing frees it */
	return basis_writer_finish(writer, &job->info, provenance, fault);
}

static bool any_coverage(const struct job *job)
{
	const size_t count = (size_t)job->info.width * job->info.height;

	for (size_t i = 0; i < count; i++)
		if (job->coverage[i])
			return true;
	return false;
}

int render_run(const struct scene *scene, const struct render_settings *settings, const char *path,
	       struct render_report *report, struct fault *fault)
{
	struct job *job = calloc(1, sizeof(*job));
	int err;

	if (!job)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	job->scene = scene;
	job->settings = *settings;
	if (!(settings->target.max > 0))
		job->settings.target.max = RENDER_MAX_OF_RMS * settings->target.rms;
	pthread_mutex_init(&job->lock, NULL);
	pthread_cond_init(&job->turned, NULL);
	err = set_up(job, path, fault);
	if (err)
		goto tear_down;
	progress_begin(&job->progress, "bake", job->tiles, settings->quiet);
	pool_run(job->pool, job->tiles, work, job);
	report->seconds = progress_end(&job->progress);
	if (job->err)
		err = fault_say(fault, job->err, "%s", job->fault.text);
	else
		err = finish(job, fault);
	report->rays = job->rays;
	report->object_seen = any_coverage(job);
	report->info = job->info;
	report->shown_bytes = job->shown_bytes;
	report->exact_bytes = job->exact_bytes;
tear_down:
	tear_down(job);
	free(job);
	return err;
}
