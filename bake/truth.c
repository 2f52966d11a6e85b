#include "bake/truth.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/progress.h"
#include "hal/compositor/compositor.h"
#include "hal/pool.h"
#include "hal/transfer.h"

#define BATCHES 8
#define GLASS_MAX 32
#define WEIGHT_SURE 0.1f
#define COAT_CHANCE 0.5f /* of sampling a glossy surface by its coat */

/* Of one thread. */
struct tracer {
	const struct scene *scene;
	const struct sky *sky;
	int bounces;
	struct random random;
	float first[2]; /* stratified over a pixel's samples: the first surface's way to the sky */
	uint64_t rays;
};

/* ---- scattering ---- */

/* f cos and the density of sample_bsdf(). */
static struct rgb eval_bsdf(const struct surface *s, struct v3 wo, struct v3 wi, float *density)
{
	const float cos_o = v3_dot(s->normal, wo), cos_i = v3_dot(s->normal, wi);
	struct rgb f, coat;
	float coat_density;

	*density = 0;
	if (cos_i <= 0 || v3_dot(s->geometric, wi) <= 0)
		return rgb_make(0, 0, 0);
	f = rgb_scale(s->bsdf.colour, bsdf_base(&s->bsdf, cos_o, cos_i) * cos_i / PI_F);
	*density = cos_i / PI_F;
	if (s->bsdf.kind != MATERIAL_GLOSSY)
		return f;
	coat = bsdf_coat(&s->bsdf, s->normal, wo, wi, &coat_density);
	*density = (1 - COAT_CHANCE) * *density + COAT_CHANCE * coat_density;
	return rgb_add(f, coat);
}

static bool sample_bsdf(const struct surface *s, struct v3 wo, struct random *random, struct v3 *wi)
{
	if (s->bsdf.kind == MATERIAL_GLOSSY && random_next(random) < COAT_CHANCE) {
		if (!bsdf_coat_sample(&s->bsdf, s->normal, wo, random, wi))
			return false;
	} else {
		const float u = random_next(random), v = random_next(random);

		*wi = hemisphere_cosine(s->normal, u, v);
	}
	return v3_dot(s->geometric, *wi) > 0;
}

/* Light straight from a sampled point of the sky. */
static struct rgb light_from_sky(struct tracer *t, enum presence presence, const struct surface *s,
				 struct v3 wo, const float point[2])
{
	float density, other;
	const struct v3 wi = sky_sample(t->sky, point[0], point[1], &density);
	const struct rgb f = eval_bsdf(s, wo, wi, &other);

	if (density <= 0 || other <= 0 || wi.z < 0)
		return rgb_make(0, 0, 0);
	t->rays++;
	if (world_blocked(t->scene->world, presence, surface_leave(s, wi), wi))
		return rgb_make(0, 0, 0);
	return rgb_scale(rgb_mul(f, sky_radiance(t->sky, wi)), 1 / (density + other));
}

/* ---- paths ---- */

/* Through glass until something else is met; false when the path has ended, with its light. */
static bool pass_glass(struct tracer *t, enum presence presence, struct surface *s, struct v3 *wo,
		       struct rgb *weight, struct rgb *light)
{
	for (int k = 0; s->bsdf.kind == MATERIAL_GLASS; k++) {
		struct rgb tint;
		const struct v3 d = bsdf_glass_sample(&s->bsdf, s->normal, s->outer, *wo,
						      &t->random, &tint);
		struct surface next;

		if (k == GLASS_MAX)
			return false;
		*weight = rgb_mul(*weight, tint);
		t->rays++;
		if (!world_nearest(t->scene->world, presence, surface_leave(s, d), d, &next)) {
			*light = rgb_add(*light, rgb_mul(*weight, sky_radiance(t->sky, d)));
			return false;
		}
		*s = next;
		*wo = v3_scale(d, -1);
	}
	return true;
}

static bool survives(struct tracer *t, struct rgb *weight)
{
	const float peak = rgb_peak(*weight);

	if (peak >= WEIGHT_SURE)
		return true;
	if (random_next(&t->random) * WEIGHT_SURE >= peak)
		return false;
	*weight = rgb_scale(*weight, WEIGHT_SURE / peak);
	return true;
}

/* Radiance that leaves a surface towards wo. */
static struct rgb radiance(struct tracer *t, enum presence presence, const struct surface *at,
			   struct v3 wo, int depth, const float *point)
{
	struct rgb light = {{0, 0, 0}}, weight = {{1, 1, 1}};
	struct surface s = *at;

	for (;; depth++) {
		float fresh[2], density, other;
		struct surface next;
		struct rgb f;
		struct v3 wi;

		if (!pass_glass(t, presence, &s, &wo, &weight, &light))
			return light;
		fresh[0] = random_next(&t->random);
		fresh[1] = random_next(&t->random);
		light = rgb_add(light, rgb_mul(weight, light_from_sky(t, presence, &s, wo,
								      point ? point : fresh)));
		point = NULL;
		if (!sample_bsdf(&s, wo, &t->random, &wi))
			return light;
		f = eval_bsdf(&s, wo, wi, &density);
		if (density <= 0)
			return light;
		t->rays++;
		if (!world_nearest(t->scene->world, presence, surface_leave(&s, wi), wi, &next)) {
			if (wi.z < 0)
				return light;
			other = sky_density(t->sky, wi);
			f = rgb_scale(rgb_mul(f, sky_radiance(t->sky, wi)), 1 / (density + other));
			return rgb_add(light, rgb_mul(weight, f));
		}
		weight = rgb_mul(weight, rgb_scale(f, 1 / density));
		if (depth == t->bounces || !survives(t, &weight))
			return light;
		s = next;
		wo = v3_scale(wi, -1);
	}
}

/* What objects take from flat ground, as irradiance / pi: the light they block less the light they
 * send. */
static struct rgb taken_from_ground(struct tracer *t, const struct surface *s)
{
	const struct world *world = t->scene->world;
	struct rgb taken = {{0, 0, 0}};
	struct surface next;
	float density;
	struct v3 wi = sky_sample(t->sky, t->first[0], t->first[1], &density);
	const float u = random_next(&t->random), v = random_next(&t->random);

	t->rays += 2;
	if (wi.z > 0 && density > 0 && world_blocked(world, WITH_OBJECTS, s->position, wi))
		taken = rgb_scale(sky_radiance(t->sky, wi), wi.z / PI_F / (density + wi.z / PI_F));
	wi = hemisphere_cosine(s->normal, u, v);
	if (world_nearest(world, WITH_OBJECTS, s->position, wi, &next)) {
		const float other = sky_density(t->sky, wi), own = wi.z / PI_F;

		taken = rgb_add(taken, rgb_scale(sky_radiance(t->sky, wi), own / (own + other)));
		if (t->bounces > 0)
			taken = rgb_add(taken, rgb_scale(radiance(t, WITH_OBJECTS, &next,
								  v3_scale(wi, -1), 1, NULL),
							 -1));
	}
	return taken;
}

/* ---- a pixel ---- */

struct sums {
	struct rgb object, taken, without;
	int samples, other, receiver;
	bool changed;
};

static void add_receiver(struct tracer *t, struct sums *sums, const struct surface *s, struct v3 wo)
{
	const struct tracer before = *t;
	struct rgb with, without, taken;

	sums->receiver++;
	if (world_has_standins(t->scene->world)) {
		with = radiance(t, WITH_OBJECTS, s, wo, 0, t->first);
		t->random = before.random;
		without = radiance(t, WITHOUT_OBJECTS, s, wo, 0, t->first);
		taken = rgb_add(without, rgb_scale(with, -1));
	} else {
		taken = taken_from_ground(t, s);
		without = t->sky->ground;
	}
	sums->taken = rgb_add(sums->taken, taken);
	sums->without = rgb_add(sums->without, without);
	sums->changed |= rgb_peak(taken) > 0;
}

static void add_sample(struct tracer *t, const struct truth_settings *settings, int x, int y,
		       int sample, struct sums *sums)
{
	const uint64_t pixel = (uint64_t)y * (uint64_t)t->scene->camera.width + (uint64_t)x;
	const uint64_t scramble = random_hash((uint64_t)settings->seed, pixel, 0x7247);
	const uint64_t another = random_mix(scramble);
	const uint32_t index = (uint32_t)sample;
	const uint32_t place = sobol_shuffle(index, (uint32_t)random_mix(another));
	const uint32_t a = sobol_first(index), b = sobol_second(index);
	struct surface surface;
	struct v3 direction;
	double at_pixel[2];
	bool met;

	sobol_point(place, scramble, at_pixel);
	t->random.state = random_hash((uint64_t)settings->seed ^ 0x7247, pixel, index);
	t->first[0] = random_unit(a ^ (uint32_t)another);
	t->first[1] = random_unit(b ^ (uint32_t)(another >> 32));
	t->rays++;
	sums->samples++;
	met = scene_look(t->scene, WITH_OBJECTS, x + at_pixel[0], y + at_pixel[1], &surface,
			 &direction);
	if (met && surface.kind == SURFACE_OBJECT) {
		sums->changed = true;
		sums->object = rgb_add(
			sums->object,
			radiance(t, WITH_OBJECTS, &surface, v3_scale(direction, -1), 0, t->first));
		return;
	}
	sums->other++;
	if (met)
		add_receiver(t, sums, &surface, v3_scale(direction, -1));
}

/* The picture's value from sums over samples; samples that see no surface are unchanged. */
static double value_of(const struct sums *sums, int c, double background)
{
	const double coverage = 1 - (double)sums->other / sums->samples;
	double ratio = 1;

	if (sums->receiver && sums->without.c[c] > 0)
		ratio -= sums->taken.c[c] / sums->without.c[c] * sums->receiver / sums->other;
	ratio = fmin(fmax(ratio, 0), COMPOSITOR_RATIO_MAX);
	return sums->object.c[c] / sums->samples + (1 - coverage) * ratio * background;
}

static void gather(struct sums *all, const struct sums *one)
{
	all->object = rgb_add(all->object, one->object);
	all->taken = rgb_add(all->taken, one->taken);
	all->without = rgb_add(all->without, one->without);
	all->samples += one->samples;
	all->other += one->other;
	all->receiver += one->receiver;
	all->changed |= one->changed;
}

/* ---- the picture ---- */

struct truth_worker {
	struct tracer tracer;
	int done;
};

struct truth_job {
	const struct truth_settings *settings;
	const struct image *background;
	struct image *out;
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
	struct sums all = {.samples = 0};

	for (int b = 0; b < batches; b++) {
		struct sums one = {.samples = 0};

		for (int k = samples * b / batches; k < samples * (b + 1) / batches; k++)
			add_sample(t, job->settings, x, y, k, &one);
		for (int c = 0; c < 3; c++) {
			const double v = value_of(&one, c, job->background->f32[at + (size_t)c]);
			const double off = v - mean[c];

			mean[c] += off / (b + 1);
			spread[c] += off * (v - mean[c]);
		}
		gather(&all, &one);
	}
	for (int c = 0; c < 3; c++) {
		const double v = value_of(&all, c, job->background->f32[at + (size_t)c]);

		job->out->f32[at + (size_t)c] = (float)v;
		if (all.changed && batches > 1) {
			const double e =
				levels_of(v, sqrt(spread[c] / ((double)batches * (batches - 1))));

			job->noise_square[y] += e * e;
			job->noise_count[y]++;
		}
	}
}

static void trace_row(void *context, int y, int number)
{
	struct truth_job *job = context;
	struct truth_worker *worker = &job->workers[number];

	for (int x = 0; x < job->out->width; x++)
		trace_pixel(job, &worker->tracer, x, y);
	worker->done++;
	/* the calling thread works too, and is the one that says how far it has come */
	if (number == 0)
		progress_show(&job->progress, worker->done * job->worker_count,
			      worker->tracer.rays * (uint64_t)job->worker_count);
}

int truth_run(const struct scene *scene, const struct sky *sky, const struct image *background,
	      const struct truth_settings *settings, struct image *out, struct truth_report *report,
	      struct fault *fault)
{
	const int width = scene->camera.width, height = scene->camera.height;
	struct truth_job job = {.settings = settings, .background = background, .out = out};
	struct pool *pool = NULL;
	double square = 0;
	long count = 0;
	int err = image_create_f32(out, width, height);

	if (!err)
		err = pool_create(&pool, settings->threads);
	if (err)
		goto say;
	job.worker_count = pool_threads(pool);
	job.workers = calloc((size_t)job.worker_count, sizeof(*job.workers));
	job.noise_square = calloc((size_t)height, sizeof(*job.noise_square));
	job.noise_count = calloc((size_t)height, sizeof(*job.noise_count));
	if (!job.workers || !job.noise_square || !job.noise_count) {
		err = -ENOMEM;
		goto release;
	}
	for (int k = 0; k < job.worker_count; k++)
		job.workers[k].tracer =
			(struct tracer){.scene = scene, .sky = sky, .bounces = settings->bounces};
	progress_begin(&job.progress, "truth", height, settings->quiet);
	pool_run(pool, height, trace_row, &job);
	report->seconds = progress_end(&job.progress);
	report->rays = 0;
	for (int k = 0; k < job.worker_count; k++)
		report->rays += job.workers[k].tracer.rays;
	for (int y = 0; y < height; y++) {
		square += job.noise_square[y];
		count += job.noise_count[y];
	}
	report->noise_levels = count ? sqrt(square / (double)count) : 0;
release:
	free(job.workers);
	free(job.noise_square);
	free(job.noise_count);
	pool_destroy(pool);
say:
	if (err) {
		image_free(out);
		return fault_say(fault, err, "the truth cannot be rendered: %s", strerror(-err));
	}
	return 0;
}
