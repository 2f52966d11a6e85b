/* SPDX-License-Identifier: MIT */
#include "bake/truth/truth.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/progress.h"
#include "bake/truth/truth_paths.h"
#include "hal/base/pool.h"
#include "hal/colour/transfer.h"
#include "hal/compositor/compositor.h"

#define BATCHES 8

/* ---- a pixel ---- */

struct truth_sums {
	struct rgb object;
	/* real surfaces beside the object; through its glass */
	struct truth_receiver beside, through;
	struct rgb seen; /* background seen through glass, at the exact place of each sample */
	double seen_weight;
	struct rgb behind; /* real surfaces that the object hides, where they are asked for */
	int samples, other;
	bool changed;
};

static bool add_receiver(struct tracer *t, struct truth_receiver *to, const struct surface *s,
			 struct v3 direction, double weight)
{
	return truth_add_receiver(t, to, s, v3_scale(direction, -1), weight);
}

/* Light of the real surface at a place of the picture, without objects. */
static struct rgb light_behind(struct tracer *t, double x, double y)
{
	struct surface surface;
	struct v3 direction;

	if (!scene_look(t->scene, WITHOUT_OBJECTS, x, y, &surface, &direction))
		return rgb_make(0, 0, 0);
	return truth_real_light(t, &surface, v3_scale(direction, -1));
}

static struct rgb background_at(const struct image *background, const double place[2])
{
	const float *at = background->f32 +
			  3 * ((size_t)place[1] * (size_t)background->width + (size_t)place[0]);

	return rgb_make(at[0], at[1], at[2]);
}

/* Adds what is seen through the object's glass: the background, where nothing was mirrored and the
 * picture shows the surface that is met; else light. */
static void add_glass(struct tracer *t, const struct image *background,
		      const struct surface *surface, struct v3 direction, struct truth_sums *sums)
{
	struct truth_sight sight;
	double place[2];
	float weight;

	if (!truth_through_glass(t, surface, direction, &sight))
		return;
	if (sight_is_real(&sight.end) && !sight.mirrored &&
	    sight_place(t->scene, &sight.end, place)) {
		weight = (sight.end.weight.c[0] + sight.end.weight.c[1] + sight.end.weight.c[2]) /
			 3;
		sums->seen = rgb_add(sums->seen,
				     rgb_mul(sight.end.weight, background_at(background, place)));
		sums->seen_weight += (double)weight;
		if (sight.end.met)
			add_receiver(t, &sums->through, &sight.end.surface, sight.end.direction,
				     (double)weight);
		return;
	}
	sums->object = rgb_add(sums->object, sight.lamps);
	sums->object = rgb_add(
		sums->object,
		rgb_mul(sight.end.weight,
			sight.end.met
				? truth_radiance(t, WITH_OBJECTS, &sight.end.surface,
						 v3_scale(sight.end.direction, -1), 0, t->first)
				: sky_radiance(t->sky, sight.end.direction)));
}

/* background NULL: the light of what the object hides is asked for. */
static void add_object(struct tracer *t, const struct image *background,
		       const struct surface *surface, struct v3 direction, const double place[2],
		       struct truth_sums *sums)
{
	sums->changed = true;
	if (background && surface->bsdf.kind == MATERIAL_GLASS) {
		add_glass(t, background, surface, direction, sums);
		return;
	}
	sums->object = rgb_add(sums->object, truth_radiance(t, WITH_OBJECTS, surface,
							    v3_scale(direction, -1), 0, t->first));
	if (!background)
		sums->behind = rgb_add(sums->behind, light_behind(t, place[0], place[1]));
}

static void sums_add_sample(struct tracer *t, const struct truth_settings *settings,
			    const struct image *background, int x, int y, int sample,
			    struct truth_sums *sums)
{
	const uint64_t pixel = (uint64_t)y * (uint64_t)t->scene->camera.width + (uint64_t)x;
	const uint64_t scramble = random_hash((uint64_t)settings->seed, pixel, 0x7247);
	const uint64_t another = random_mix(scramble);
	const uint32_t index = (uint32_t)sample;
	const uint32_t place = sobol_shuffle(index, (uint32_t)random_mix(another));
	const uint32_t a = sobol_first(index), b = sobol_second(index);
	struct surface surface;
	struct v3 direction;
	double unit[2], at[2];
	bool met;

	sobol_point(place, scramble, unit);
	scene_place(t->scene, x, y, unit, at);
	t->random.state = random_hash((uint64_t)settings->seed ^ 0x7247, pixel, index);
	t->first[0] = random_unit(a ^ (uint32_t)another);
	t->first[1] = random_unit(b ^ (uint32_t)(another >> 32));
	t->rays++;
	sums->samples++;
	met = scene_look(t->scene, WITH_OBJECTS, at[0], at[1], &surface, &direction);
	if (met && surface.kind == SURFACE_OBJECT) {
		add_object(t, background, &surface, direction, at, sums);
		return;
	}
	sums->other++;
	if (met)
		sums->changed |= add_receiver(t, &sums->beside, &surface, direction, 1);
}

/* Ratio of light with and without the object. Samples that see no real surface count as unchanged;
 * all is the weight of all samples, with those. */
static double ratio_of(const struct truth_receiver *receiver, int c, double all)
{
	double ratio = 1;

	if (receiver->without.c[c] > 0)
		ratio -= receiver->taken.c[c] / receiver->without.c[c] * receiver->weight / all;
	return fmin(fmax(ratio, 0), COMPOSITOR_RATIO_MAX);
}

/* Light of the pixel, from sums over samples. */
static double sums_value(const struct truth_sums *sums, int c, double background)
{
	return (sums->object.c[c] +
		ratio_of(&sums->through, c, sums->seen_weight) * sums->seen.c[c] +
		sums->other * ratio_of(&sums->beside, c, sums->other) * background) /
	       sums->samples;
}

static void receiver_gather(struct truth_receiver *all, const struct truth_receiver *one)
{
	all->taken = rgb_add(all->taken, one->taken);
	all->without = rgb_add(all->without, one->without);
	all->weight += one->weight;
}

static void sums_gather(struct truth_sums *all, const struct truth_sums *one)
{
	all->object = rgb_add(all->object, one->object);
	receiver_gather(&all->beside, &one->beside);
	receiver_gather(&all->through, &one->through);
	all->seen = rgb_add(all->seen, one->seen);
	all->seen_weight += one->seen_weight;
	all->behind = rgb_add(all->behind, one->behind);
	all->samples += one->samples;
	all->other += one->other;
	all->changed |= one->changed;
}

/* ---- the picture ---- */

struct truth_worker {
	struct tracer tracer;
	int done;
};

struct truth_job {
	const struct truth_settings *settings;
	/* either the composite, or the pictures for import */
	const struct image *background;
	struct image *out;
	struct truth_pictures *pictures;
	int width;
	struct truth_worker *workers;
	int worker_count;
	double *noise_square; /* [height] */
	long *noise_count;
	struct progress progress;
};

static double levels_of(double mean, double error)
{
	return 127.5 * (transfer_encode(TRANSFER_SRGB, mean + error) -
			transfer_encode(TRANSFER_SRGB, mean - error));
}

static void trace_pixel(struct truth_job *job, struct tracer *t, int x, int y)
{
	const size_t at = 3 * ((size_t)y * (size_t)job->out->width + (size_t)x);
	const int samples = job->settings->samples;
	const int batches = samples < BATCHES ? samples : BATCHES;
	double mean[3] = {0}, spread[3] = {0};
	struct truth_sums all = {.samples = 0};

	for (int b = 0; b < batches; b++) {
		struct truth_sums one = {.samples = 0};

		for (int k = samples * b / batches; k < samples * (b + 1) / batches; k++)
			sums_add_sample(t, job->settings, job->background, x, y, k, &one);
		for (int c = 0; c < 3; c++) {
			const double v = sums_value(&one, c, job->background->f32[at + (size_t)c]);
			const double off = v - mean[c];

			mean[c] += off / (b + 1);
			spread[c] += off * (v - mean[c]);
		}
		sums_gather(&all, &one);
	}
	for (int c = 0; c < 3; c++) {
		const double v = sums_value(&all, c, job->background->f32[at + (size_t)c]);

		job->out->f32[at + (size_t)c] = (float)v;
		if (all.changed && batches > 1) {
			const double e =
				levels_of(v, sqrt(spread[c] / ((double)batches * (batches - 1))));

			job->noise_square[y] += e * e;
			job->noise_count[y]++;
		}
	}
}

static void trace_pictures(struct truth_job *job, struct tracer *t, int x, int y)
{
	const size_t at = 3 * ((size_t)y * (size_t)job->width + (size_t)x);
	const int samples = job->settings->samples;
	struct truth_pictures *to = job->pictures;
	struct truth_sums sums = {.samples = 0};

	for (int k = 0; k < samples; k++)
		sums_add_sample(t, job->settings, NULL, x, y, k, &sums);
	for (size_t c = 0; c < 3; c++) {
		to->with.f32[at + c] =
			(sums.object.c[c] + sums.beside.without.c[c] - sums.beside.taken.c[c]) /
			(float)samples;
		to->alone.f32[at + c] = sums.object.c[c] / (float)samples;
		to->without.f32[at + c] = (sums.beside.without.c[c] + sums.behind.c[c]) /
					  (float)samples;
		to->coverage.f32[at + c] = 1 - (float)sums.other / (float)samples;
	}
}

static void trace_row(void *context, int y, int number)
{
	struct truth_job *job = context;
	struct truth_worker *worker = &job->workers[number];

	for (int x = 0; x < job->width; x++) {
		if (job->pictures)
			trace_pictures(job, &worker->tracer, x, y);
		else
			trace_pixel(job, &worker->tracer, x, y);
	}
	worker->done++;
	/* only the calling thread, which works as well, shows the progress */
	if (number == 0)
		progress_show(&job->progress, worker->done * job->worker_count,
			      worker->tracer.rays * (uint64_t)job->worker_count);
}

/* Traces all rows with all threads. */
static int trace_rows(struct truth_job *job, const struct scene *scene, const struct sky *sky,
		      struct truth_report *report)
{
	const int height = scene->camera.height;
	struct pool *pool;
	int err = pool_create(&pool, job->settings->threads);

	if (err)
		return err;
	job->width = scene->camera.width;
	job->worker_count = pool_threads(pool);
	job->workers = calloc((size_t)job->worker_count, sizeof(*job->workers));
	if (job->workers) {
		for (int k = 0; k < job->worker_count; k++)
			job->workers[k].tracer = (struct tracer){
				.scene = scene, .sky = sky, .bounces = job->settings->bounces};
		progress_begin(&job->progress, "truth", height, job->settings->quiet);
		pool_run(pool, height, trace_row, job);
		report->seconds = progress_end(&job->progress);
		report->rays = 0;
		for (int k = 0; k < job->worker_count; k++)
			report->rays += job->workers[k].tracer.rays;
	}
	pool_destroy(pool);
	err = job->workers ? 0 : -ENOMEM;
	free(job->workers);
	return err;
}

int truth_run(const struct scene *scene, const struct sky *sky, const struct image *background,
	      const struct truth_settings *settings, struct image *out, struct truth_report *report,
	      struct fault *fault)
{
	const int width = scene->camera.width, height = scene->camera.height;
	struct truth_job job = {.settings = settings, .background = background, .out = out};
	double square = 0;
	long count = 0;
	int err = image_create_f32(out, width, height);

	job.noise_square = calloc((size_t)height, sizeof(*job.noise_square));
	job.noise_count = calloc((size_t)height, sizeof(*job.noise_count));
	if (!job.noise_square || !job.noise_count)
		err = -ENOMEM;
	if (!err)
		err = trace_rows(&job, scene, sky, report);
	for (int y = 0; !err && y < height; y++) {
		square += job.noise_square[y];
		count += job.noise_count[y];
	}
	report->noise_levels = count ? sqrt(square / (double)count) : 0;
	free(job.noise_square);
	free(job.noise_count);
	if (err) {
		image_free(out);
		return fault_say(fault, err, "the truth cannot be rendered: %s", strerror(-err));
	}
	return 0;
}

int truth_pictures(const struct scene *scene, const struct sky *sky,
		   const struct truth_settings *settings, struct truth_pictures *out,
		   struct fault *fault)
{
	const int width = scene->camera.width, height = scene->camera.height;
	struct truth_job job = {.settings = settings, .pictures = out};
	struct truth_report report;
	int err;

	*out = (struct truth_pictures){.with = {.width = 0}};
	err = image_create_f32(&out->with, width, height);
	if (!err)
		err = image_create_f32(&out->without, width, height);
	if (!err)
		err = image_create_f32(&out->alone, width, height);
	if (!err)
		err = image_create_f32(&out->coverage, width, height);
	if (!err)
		err = trace_rows(&job, scene, sky, &report);
	if (err) {
		truth_pictures_free(out);
		return fault_say(fault, err, "the pictures cannot be rendered: %s", strerror(-err));
	}
	return 0;
}

void truth_pictures_free(struct truth_pictures *pictures)
{
	image_free(&pictures->with);
	image_free(&pictures->without);
	image_free(&pictures->alone);
	image_free(&pictures->coverage);
}
