#include "bake/render.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "bake/progress.h"
#include "bake/tile.h"
#include "hal/pool.h"

/* Tiles that may be done before the one whose turn it is in the file. */
#define WINDOW 64
#define TEXT_MAX 4096

/* A finished tile that waits for its turn. */
struct waiting {
	struct basis_block_payload *blocks; /* followed by their payloads */
	int count;
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
	uint64_t rays;
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
		.ratio_cut = r->ratio_cut,
	};
}

/* ---- in order into the file ---- */

/* The encoder's blocks live until its next tile: this keeps a copy. */
static int keep_blocks(struct waiting *slot, const struct encode_result *result)
{
	size_t bytes = (size_t)result->count * sizeof(*slot->blocks), at = bytes;
	uint8_t *data;

	for (int k = 0; k < result->count; k++)
		bytes += result->blocks[k].entry.bytes;
	data = malloc(bytes + 1);
	if (!data)
		return -ENOMEM;
	slot->blocks = (struct basis_block_payload *)(void *)data;
	slot->count = result->count;
	for (int k = 0; k < result->count; k++) {
		slot->blocks[k] = result->blocks[k];
		slot->blocks[k].payload = data + at;
		memcpy(data + at, result->blocks[k].payload, result->blocks[k].entry.bytes);
		at += result->blocks[k].entry.bytes;
	}
	return 0;
}

static void fail(struct job *job, int err)
{
	if (!job->err)
		job->err = err;
	pthread_cond_broadcast(&job->turned);
}

/* Writes every tile whose turn has come. The lock is held. */
static void write_ready(struct job *job)
{
	while (job->waiting[job->next % WINDOW].ready) {
		struct waiting *slot = &job->waiting[job->next % WINDOW];
		int err = 0;

		if (slot->count)
			err = basis_writer_blocks(job->writer, slot->blocks, slot->count,
						  &job->fault);
		job->noise_square += slot->noise_square;
		job->noise_count += slot->noise_count;
		free(slot->blocks);
		*slot = (struct waiting){.count = 0};
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
		fault_say(&job->fault, err, "a tile cannot be encoded: %s", strerror(-err));
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
	struct encode_result result = {.count = 0};
	int err;

	if (!wait_for_room(job, index))
		return;
	tile->transport.ray_count = 0;
	tile_render(tile, index);
	tile_peaks(tile, worker->peak);
	store_coverage(job, tile);
	err = encode_tile(worker->encoder, index, tile->part, tile->part_count, &result);
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
		.ground = job->ground,
		.ratio_cut = job->settings.ratio_cut,
	};
	const struct tile_settings tile = {
		.samples = job->settings.samples,
		.noise_levels = job->settings.noise_levels,
		.ratio_cut = job->settings.ratio_cut,
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

static int open_writer(struct job *job, const char *path, struct fault *fault)
{
	const size_t n = (size_t)job->dome.count;
	struct basis_light *lights = calloc(n, sizeof(*lights));
	char camera[TEXT_MAX];
	int err;

	if (!lights)
		return fault_say(fault, -ENOMEM, "%s: out of memory", path);
	for (size_t i = 0; i < n; i++) {
		memcpy(lights[i].direction, job->dome.direction[i], sizeof(lights[i].direction));
		lights[i].solid_angle_sr = job->dome.solid_angle_sr[i];
	}
	err = scene_camera_text(job->scene, camera, sizeof(camera));
	if (!err)
		err = basis_writer_open(&job->writer, path, &job->info, lights, job->ground, camera,
					fault);
	free(lights);
	return err;
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
	};
	job->tiles = (camera->width + BASIS_TILE - 1) / BASIS_TILE *
		     ((camera->height + BASIS_TILE - 1) / BASIS_TILE);
	job->coverage = calloc((size_t)camera->width * (size_t)camera->height,
			       sizeof(*job->coverage));
	err = cells_create(&job->cells, &job->dome);
	if (!err)
		err = set_ground(job);
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
		 "ratio_cut = %.9g\n"
		 "rays = %llu\n",
		 INLAY_VERSION, (unsigned long long)job->scene->hash, job->info.width,
		 job->info.height, s->frequency, dome_division_names[s->division], job->info.lights,
		 s->noise_levels > 0 ? 0 : s->samples, s->noise_levels, job->info.noise_levels,
		 s->bounces, s->seed, s->ratio_cut, (unsigned long long)job->rays);
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
	report->noise_levels = job->info.noise_levels;
	report->object_error = job->info.object_error;
	report->ratio_error = job->info.ratio_error;
tear_down:
	tear_down(job);
	free(job);
	return err;
}
