/* SPDX-License-Identifier: MIT */
#include "bake/trace/cache.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define CACHE_POINTS 16	     /* a record has at most this many points, and as many rays to a cell */
#define POINTS_A_RECORD 10   /* a record has about this many points on average */
#define RECORDS_LEAST 500    /* fewer records are too coarse: no cache is made. Chosen by trial. */
#define FLOATS_MAX (1 << 25) /* all rows together have at most this many floats: 128 MB */
/* A record has at most this many links: four from each point, and some more where a coat divides a
 * path. */
#define LINKS_MAX (6 * CACHE_POINTS)
/* The search for points tries DIRECTIONS from each first surface, walks over at most WALK_MAX
 * surfaces from there, and ends after LOOKS_A_POINT camera rays for each point wanted. */
#define DIRECTIONS 8
#define WALK_MAX 6
#define LOOKS_A_POINT 16
/* Light is passed on in strips of this many columns of all rows: a few MB, which stay in the
 * processor's cache. */
#define STRIP 64
/* Passes end when no value changes by more than this share of the largest. */
#define SETTLED 1e-4f

/* The points of a record: [first, first + count) of the order. */
struct cache_leaf {
	int first, count;
};

/* A cache in the making. */
struct cache_job {
	const struct cache_settings *settings;
	struct cache *cache;
	int count;	       /* points found */
	struct surface *point; /* [count] */
	struct cache_key *key; /* [count] */
	int *order;	       /* [count] */
	int splits;
	struct cache_leaf *leaf;     /* [records] */
	struct transport_link *link; /* [records][LINKS_MAX] */
	int *links;		     /* [records] */
	struct transport *transport; /* [threads] */
	float *strip;		     /* [threads][2][records][STRIP] */
};

/* ---- finding points ---- */

static void job_add_point(struct cache_job *job, const struct surface *s)
{
	struct surface *to = &job->point[job->count];

	job->key[job->count] = cache_key_of(job->cache, s);
	job->order[job->count] = job->count;
	*to = *s;
	/* Rows are those of a white Lambertian surface. */
	to->bsdf = (struct bsdf){.kind = MATERIAL_DIFFUSE, .colour = {{1, 1, 1}}};
	job->count++;
}

/* Draws a uniform direction in the cone in which the objects are seen from a point. */
static struct v3 towards_objects(const struct cache *cache, struct v3 from, struct random *random)
{
	const struct v3 to = v3_sub(cache->bounds.centre, from);
	const float distance = v3_length(to), sine = fminf(cache->bounds.radius / distance, 1);
	const float cosine = 1 - random_next(random) * (1 - sqrtf(1 - sine * sine));
	const float around = 2 * PI_F * random_next(random);
	const float across = sqrtf(fmaxf(1 - cosine * cosine, 0));
	const struct v3 axis = v3_unit(to);
	struct v3 s, t;

	v3_frame(axis, &s, &t);
	return v3_from_frame(v3_make(across * cosf(around), across * sinf(around), cosine), s, t,
			     axis);
}

/* Draws the direction in which a path goes on from a surface; first: it is the path's first. */
static struct v3 walk_direction(const struct cache *cache, const struct surface *s, struct v3 wo,
				bool first, struct random *random)
{
	struct rgb tint;
	float u, v;

	if (s->bsdf.kind == MATERIAL_GLASS)
		return bsdf_glass_sample(&s->bsdf, s->normal, s->outer, wo, random, &tint);
	if (first && s->kind == SURFACE_GROUND)
		return towards_objects(cache, s->position, random);
	u = random_next(random);
	v = random_next(random);
	return hemisphere_cosine(s->normal, u, v);
}

/* Adds the surfaces that a random path from a first surface meets. */
static void job_walk(struct cache_job *job, int wanted, struct surface s, struct v3 direction,
		     struct random *random)
{
	for (int k = 0; k < WALK_MAX && job->count < wanted; k++) {
		const bool glass = s.bsdf.kind == MATERIAL_GLASS;
		const struct v3 d = walk_direction(job->cache, &s, v3_scale(direction, -1), k == 0,
						   random);
		struct surface next;

		if (k && !glass && random_next(random) < 0.5f)
			return;
		if (!glass && v3_dot(s.geometric, d) <= 0)
			return;
		if (!world_nearest(job->settings->world, WITH_OBJECTS, surface_leave(&s, d), d,
				   &next))
			return;
		if (next.bsdf.kind != MATERIAL_GLASS && !(glass && k == 0))
			job_add_point(job, &next);
		s = next;
		direction = d;
	}
}

static void job_find_points(struct cache_job *job, int wanted)
{
	const struct cache_settings *settings = job->settings;
	const uint64_t scramble = random_hash(settings->seed, 0xcac4e, 0);

	for (uint32_t k = 0;
	     k < (uint32_t)wanted * LOOKS_A_POINT / DIRECTIONS && job->count < wanted; k++) {
		struct random random = {random_hash(settings->seed, k, 0xcac4e1)};
		double place[2];
		struct surface first;
		struct v3 direction;

		sobol_point(k, scramble, place);
		if (!settings->look(settings->context, place[0], place[1], &first, &direction))
			continue;
		for (int d = 0; d < DIRECTIONS; d++)
			job_walk(job, wanted, first, direction, &random);
	}
}

/* ---- records ---- */

struct cache_sorted {
	float key;
	int point;
};

static int compare_sorted(const void *a, const void *b)
{
	const struct cache_sorted *left = a, *right = b;

	if (left->key != right->key)
		return left->key < right->key ? -1 : 1;
	return left->point < right->point ? -1 : 1;
}

static int widest_axis(const struct cache_job *job, const int *order, int count)
{
	float least[CACHE_AXES], most[CACHE_AXES];
	int widest = 0;

	for (int axis = 0; axis < CACHE_AXES; axis++) {
		least[axis] = INFINITY;
		most[axis] = -INFINITY;
		for (int k = 0; k < count; k++) {
			least[axis] = fminf(least[axis], job->key[order[k]].axis[axis]);
			most[axis] = fmaxf(most[axis], job->key[order[k]].axis[axis]);
		}
		if (most[axis] - least[axis] > most[widest] - least[widest])
			widest = axis;
	}
	return widest;
}

/*
 * Chooses where to divide sorted points: in the middle of their extent, but so that each part has
 * at least an eighth of them, and between different keys, as flat surfaces have many equal normals.
 * Returns the number of points in the first part, or 0 if all keys are equal.
 */
static int divide_at(const struct cache_sorted *sorted, int count)
{
	const float middle = (sorted[0].key + sorted[count - 1].key) / 2;
	int want = 0;

	while (want < count && sorted[want].key <= middle)
		want++;
	want = want < count / 8 ? count / 8 : want > count - count / 8 ? count - count / 8 : want;
	for (int off = 0; off < count; off++)
		for (int side = -1; side <= 1; side += 2) {
			const int at = want + side * off;

			if (at > 0 && at < count && sorted[at - 1].key < sorted[at].key)
				return at;
		}
	return 0;
}

/* Divides points until no part has more than CACHE_POINTS. Returns the node, or ~record. */
static int job_divide(struct cache_job *job, int first, int count, struct cache_sorted *room)
{
	int *const order = job->order + first;
	const int axis = widest_axis(job, order, count);
	struct cache_split *split;
	int node, child, part = 0;

	for (int k = 0; k < count; k++)
		room[k] = (struct cache_sorted){job->key[order[k]].axis[axis], order[k]};
	qsort(room, (size_t)count, sizeof(*room), compare_sorted);
	if (count > CACHE_POINTS)
		part = divide_at(room, count);
	if (!part) {
		job->leaf[job->cache->records] = (struct cache_leaf){first, count};
		return ~job->cache->records++;
	}
	node = job->splits++;
	split = &job->cache->split[node];
	split->axis = axis;
	split->at = room[part - 1].key;
	for (int k = 0; k < count; k++)
		order[k] = room[k].point;
	child = job_divide(job, first, part, room);
	split->child[0] = child;
	child = job_divide(job, first + part, count - part, room);
	split->child[1] = child;
	return node;
}

static float spread_of(const struct surface *point, const int *order, int count)
{
	const float share = 1 / (float)count;
	struct v3 mean = {0, 0, 0};
	float square = 0;

	for (int k = 0; k < count; k++)
		mean = v3_mad(mean, share, point[order[k]].position);
	for (int k = 0; k < count; k++) {
		const struct v3 d = v3_sub(point[order[k]].position, mean);

		square += v3_dot(d, d) * share;
	}
	return sqrtf(square);
}

static int job_make_records(struct cache_job *job)
{
	struct cache *cache = job->cache;
	const size_t most = (size_t)job->count;
	struct cache_sorted *room = malloc(most * sizeof(*room));

	cache->split = malloc(most * sizeof(*cache->split));
	job->leaf = malloc(most * sizeof(*job->leaf));
	if (!room || !cache->split || !job->leaf) {
		free(room);
		return -ENOMEM;
	}
	job_divide(job, 0, job->count, room);
	free(room);
	return job->splits ? 0 : -ENODATA;
}

/* ---- light ---- */

/* Traces the open light and the links of one record. */
static void job_trace_record(void *context, int record, int worker)
{
	struct cache_job *job = context;
	const struct cache_settings *settings = job->settings;
	struct transport *t = &job->transport[worker];
	const size_t row_size = 3 * (size_t)job->cache->lights;
	float *row = job->cache->row + (size_t)record * row_size;
	const struct cache_leaf *leaf = &job->leaf[record];
	const int *order = job->order + leaf->first;
	const float share = 1.0f / CACHE_POINTS;

	memset(row, 0, row_size * sizeof(*row));
	t->link = job->link + (size_t)record * LINKS_MAX;
	t->links = 0;
	t->links_max = LINKS_MAX;
	for (int k = 0; k < CACHE_POINTS; k++) {
		const struct surface *s = &job->point[order[k % leaf->count]];

		transport_begin(t, random_hash(settings->seed, 0xcac4e, 2), (uint32_t)record,
				(uint32_t)k);
		transport_link(t, s, row);
	}
	for (size_t i = 0; i < row_size; i++)
		row[i] *= share;
	for (int k = 0; k < t->links; k++)
		t->link[k].weight = rgb_scale(t->link[k].weight, share);
	job->links[record] = t->links;
}

static float larger(float a, float b)
{
	return a > b ? a : b;
}

/* Makes one pass over a strip: to = open + links * from. Returns whether it has settled. */
static bool pass_strip(const struct cache_job *job, int channel, const float *open, size_t stride,
		       int width, const float *from, float *to)
{
	float change[STRIP] = {0}, most[STRIP] = {0};

	for (int r = 0; r < job->cache->records; r++) {
		const struct transport_link *link = job->link + (size_t)r * LINKS_MAX;
		const float *old = from + (size_t)r * STRIP;
		float sum[STRIP] = {0};

		memcpy(sum, open + (size_t)r * stride, (size_t)width * sizeof(*sum));
		for (int k = 0; k < job->links[r]; k++) {
			const float *restrict add = from + (size_t)link[k].record * STRIP;
			const float weight = link[k].weight.c[channel];

			for (int i = 0; i < STRIP; i++)
				sum[i] += weight * add[i];
		}
		for (int i = 0; i < STRIP; i++) {
			change[i] = larger(fabsf(sum[i] - old[i]), change[i]);
			most[i] = larger(sum[i], most[i]);
		}
		memcpy(to + (size_t)r * STRIP, sum, sizeof(sum));
	}
	for (int i = 1; i < STRIP; i++) {
		change[0] = larger(change[i], change[0]);
		most[0] = larger(most[i], most[0]);
	}
	return change[0] <= SETTLED * most[0];
}

/* Passes light on between records, for a strip of lights and one channel. */
static void job_settle_strip(void *context, int item, int worker)
{
	struct cache_job *job = context;
	struct cache *cache = job->cache;
	const int strips = (cache->lights + STRIP - 1) / STRIP, channel = item / strips;
	const int first = item % strips * STRIP;
	const int width = cache->lights - first < STRIP ? cache->lights - first : STRIP;
	const size_t size = (size_t)cache->records * STRIP, stride = 3 * (size_t)cache->lights;
	float *open = cache->row + (size_t)channel * (size_t)cache->lights + (size_t)first;
	float *from = job->strip + (size_t)worker * 2 * size, *to = from + size;

	memset(from, 0, 2 * size * sizeof(*from));
	for (int r = 0; r < cache->records; r++)
		memcpy(from + (size_t)r * STRIP, open + (size_t)r * stride,
		       (size_t)width * sizeof(*from));
	/* A row is light that leaves a surface, which is the first of the bounces. */
	for (int pass = 1; pass < job->settings->bounces; pass++) {
		float *const swap = from;
		const bool settled = pass_strip(job, channel, open, stride, width, from, to);

		from = to;
		to = swap;
		if (settled)
			break;
	}
	for (int r = 0; r < cache->records; r++)
		memcpy(open + (size_t)r * stride, from + (size_t)r * STRIP,
		       (size_t)width * sizeof(*from));
}

/* ---- all of it ---- */

static void job_free(struct cache_job *job, int threads)
{
	for (int k = 0; k < threads && job->transport; k++)
		transport_free(&job->transport[k]);
	free(job->point);
	free(job->key);
	free(job->order);
	free(job->leaf);
	free(job->link);
	free(job->links);
	free(job->transport);
	free(job->strip);
}

static int job_reserve(struct cache_job *job, int threads)
{
	struct cache *cache = job->cache;
	const size_t records = (size_t)cache->records;

	cache->spread = malloc(records * sizeof(*cache->spread));
	cache->row = malloc(records * 3 * (size_t)cache->lights * sizeof(*cache->row));
	job->link = malloc(records * LINKS_MAX * sizeof(*job->link));
	job->links = malloc(records * sizeof(*job->links));
	job->transport = calloc((size_t)threads, sizeof(*job->transport));
	job->strip = malloc((size_t)threads * 2 * records * STRIP * sizeof(*job->strip));
	if (!cache->spread || !cache->row || !job->link || !job->links || !job->transport ||
	    !job->strip)
		return -ENOMEM;
	for (int k = 0; k < threads; k++) {
		const int err = transport_create(&job->transport[k], job->settings->world,
						 job->settings->cells, job->settings->bounces);

		if (err)
			return err;
		job->transport[k].cache = cache;
	}
	return 0;
}

/* Returns the number of points to look for: fewer if there are so many lights that rows would take
 * more than FLOATS_MAX. */
static int points_wanted(const struct cache_settings *settings)
{
	int records = FLOATS_MAX / (3 * settings->cells->count);

	if (records > settings->records)
		records = settings->records;
	return POINTS_A_RECORD * (records < CACHE_RECORDS_MAX ? records : CACHE_RECORDS_MAX);
}

static int job_run(struct cache_job *job, struct pool *pool)
{
	struct cache *cache = job->cache;
	const int wanted = points_wanted(job->settings);
	int err;

	job->point = malloc((size_t)wanted * sizeof(*job->point));
	job->key = malloc((size_t)wanted * sizeof(*job->key));
	job->order = malloc((size_t)wanted * sizeof(*job->order));
	if (!job->point || !job->key || !job->order)
		return -ENOMEM;
	job_find_points(job, wanted);
	if (job->count < POINTS_A_RECORD * RECORDS_LEAST)
		return -ENODATA;
	err = job_make_records(job);
	if (!err)
		err = job_reserve(job, pool_threads(pool));
	if (err)
		return err;
	for (int r = 0; r < cache->records; r++)
		cache->spread[r] = spread_of(job->point, job->order + job->leaf[r].first,
					     job->leaf[r].count);
	pool_run(pool, cache->records, job_trace_record, job);
	pool_run(pool, 3 * ((cache->lights + STRIP - 1) / STRIP), job_settle_strip, job);
	return 0;
}

int cache_create(struct cache **out, const struct cache_settings *settings, struct pool *pool)
{
	struct cache_job job = {.settings = settings};
	struct cache *cache;
	int err;

	*out = NULL;
	if (settings->bounces < 1 || settings->records < RECORDS_LEAST)
		return 0;
	cache = calloc(1, sizeof(*cache));
	if (!cache)
		return -ENOMEM;
	cache->bounds = world_bounds(settings->world, WITH_OBJECTS);
	cache->lights = settings->cells->count;
	job.cache = cache;
	err = job_run(&job, pool);
	job_free(&job, pool_threads(pool));
	if (err) {
		cache_destroy(cache);
		return err == -ENODATA ? 0 : err;
	}
	*out = cache;
	return 0;
}
