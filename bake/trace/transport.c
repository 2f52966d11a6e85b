/* SPDX-License-Identifier: MIT */
#include "bake/trace/transport.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "bake/trace/cache.h"

#define PIXEL_STEP UINT32_C(0x632be5ab) /* separates the keys of one path's surfaces */
/* A fan has an eighth as many directions as there are lights, or up to twice that, within these.
 * Chosen by trial. */
#define DIRECTIONS_MIN 32
#define DIRECTIONS_MAX 256
/* Surfaces up to this depth send a ray to every cell; a fan of fewer rays misses most small
 * lamps. */
#define ALL_CELLS_DEPTH 1
#define GLASS_MAX 32 /* a path passes at most this many surfaces of glass in a row */
/* Russian roulette: a path of less weight goes on with a probability in proportion to it. Chosen by
 * trial. */
#define WEIGHT_SURE 0.02f
/* A surface nearer than this many spreads of its record is traced as without a cache: in corners
 * light changes too much over a record. */
#define CACHE_NEAR 2
/* With a cache, this many paths go on from a first surface. They end at the next surface, so that
 * they are cheap. */
#define PATHS_MAX 4
/* Steps of the low-discrepancy sequence R2 (Roberts 2018), which places several directions below
 * the horizon. */
#define PLASTIC_1 0.7548777f
#define PLASTIC_2 0.5698403f

/* The directions in which a path goes on, and the weight that all of them carry, in equal parts. */
struct onward {
	struct v3 direction[PATHS_MAX];
	int count;
	float weight;
};

/* The directions that may meet a mesh; all others are free. */
struct cone {
	struct v3 axis;
	float cosine;
};

static void add_path(struct transport *t, enum presence presence, const struct surface *s,
		     struct v3 wo, struct rgb weight, int depth, const struct transport_rows *rows);

/* ---- setting up ---- */

static void fill_fans(struct transport *t)
{
	for (uint32_t fan = 0; fan < TRANSPORT_FANS; fan++) {
		const uint64_t scramble = random_hash(fan, 0xfa2, 0);

		for (uint32_t k = 0; k < (uint32_t)t->directions; k++) {
			const uint32_t a = sobol_first(k) ^ (uint32_t)scramble;
			const uint32_t b = sobol_second(k) ^ (uint32_t)(scramble >> 32);

			t->fan[fan * (uint32_t)t->directions + k] =
				hemisphere_cosine(v3_make(0, 0, 1), random_unit(a), random_unit(b));
		}
	}
}

int transport_create(struct transport *t, const struct world *world, const struct cells *cells,
		     int bounces)
{
	int err;

	*t = (struct transport){.world = world, .cells = cells, .bounces = bounces};
	t->directions = DIRECTIONS_MIN;
	while (t->directions < cells->count / 8 && t->directions < DIRECTIONS_MAX)
		t->directions *= 2;
	err = ray_batch_create(&t->rays);
	if (!err)
		err = ray_batch_create(&t->guess.rays);
	if (err) {
		transport_free(t);
		return err;
	}
	t->guess.index = malloc(WORLD_RAYS_MAX * sizeof(*t->guess.index));
	t->guess.ball = calloc((size_t)cells->count, sizeof(*t->guess.ball));
	t->guess.stopped = calloc((size_t)cells->count, sizeof(*t->guess.stopped));
	t->cell = malloc(WORLD_RAYS_MAX * sizeof(*t->cell));
	t->value = malloc((size_t)cells->count * sizeof(*t->value));
	t->fan = malloc((size_t)TRANSPORT_FANS * (size_t)t->directions * sizeof(*t->fan));
	if (!t->guess.index || !t->guess.ball || !t->guess.stopped || !t->cell || !t->value ||
	    !t->fan) {
		transport_free(t);
		return -ENOMEM;
	}
	fill_fans(t);
	return 0;
}

void transport_free(struct transport *t)
{
	ray_batch_free(&t->rays);
	ray_batch_free(&t->guess.rays);
	free(t->guess.index);
	free(t->guess.ball);
	free(t->guess.stopped);
	free(t->cell);
	free(t->value);
	free(t->fan);
	*t = (struct transport){.bounces = 0};
}

void transport_begin(struct transport *t, uint64_t seed, uint32_t pixel, uint32_t sample)
{
	const uint64_t choice = random_hash(seed, pixel, 0xc401ce);
	const uint64_t below = random_hash(seed, pixel, 0xbe10);

	t->random.state = random_hash(seed, pixel, sample);
	t->pixel = (uint32_t)random_hash(seed, pixel, 0x5eed);
	t->sample = sample;
	t->choice = random_unit(sobol_first(sobol_shuffle(sample, (uint32_t)choice)) ^
				(uint32_t)(choice >> 32));
	sobol_point(sobol_shuffle(sample, (uint32_t)random_mix(below)), below, t->below);
}

/* ---- parts ---- */

static struct cone cone_of(const struct bounds *bounds, struct v3 from)
{
	const struct v3 to = v3_sub(bounds->centre, from);
	const float distance = v3_length(to);
	struct cone cone = {{0, 0, 1}, -2};

	if (bounds->radius < 0) {
		cone.cosine = 2;
	} else if (distance > bounds->radius) {
		const float sine = bounds->radius / distance;

		cone.axis = v3_scale(to, 1 / distance);
		cone.cosine = sqrtf(1 - sine * sine) - 1e-5f;
	}
	return cone;
}

static void push_ray(struct transport *t, struct v3 d, int id)
{
	const int at = t->rays.count++;

	t->rays.x[at] = d.x;
	t->rays.y[at] = d.y;
	t->rays.z[at] = d.z;
	t->cell[at] = id;
}

static struct v3 pushed_ray(const struct transport *t, int at)
{
	return v3_make(t->rays.x[at], t->rays.y[at], t->rays.z[at]);
}

static void trace_rays(struct transport *t, enum presence presence, struct v3 origin)
{
	world_occluded(t->world, presence, origin, &t->rays);
	t->ray_count += (uint64_t)t->rays.count;
}

/* Finds rays to cells that meet a ball inside an object, and collects the others. It tries the ball
 * that an earlier ray to the same cell met and, if the last of these was blocked otherwise, all. */
static void pass_balls(struct transport *t, const struct inside *inside, struct v3 origin)
{
	struct ray_batch *rest = &t->guess.rays;
	struct inside_view view;

	inside_see(inside, origin, &view);
	rest->count = 0;
	for (int k = 0; k < t->rays.count; k++) {
		const struct v3 d = pushed_ray(t, k);
		const int cell = t->cell[k];
		bool stopped = inside_meets(&view, t->guess.ball[cell], d);

		if (!stopped && t->guess.stopped[cell]) {
			const int ball = inside_find(&view, d);

			stopped = ball >= 0;
			if (stopped)
				t->guess.ball[cell] = (uint8_t)ball;
		}
		t->rays.blocked[k] = stopped;
		rest->x[rest->count] = d.x;
		rest->y[rest->count] = d.y;
		rest->z[rest->count] = d.z;
		t->guess.index[rest->count] = k;
		rest->count += !stopped;
	}
}

/* Traces a batch of rays to cells. The ray tracer gets only those that no ball blocks. */
static void trace_cells(struct transport *t, enum presence presence, struct v3 origin)
{
	const struct inside *inside = world_inside(t->world);

	if (presence != WITH_OBJECTS || !inside->count) {
		trace_rays(t, presence, origin);
		return;
	}
	t->ray_count += (uint64_t)t->rays.count;
	pass_balls(t, inside, origin);
	world_occluded(t->world, presence, origin, &t->guess.rays);
	for (int n = 0; n < t->guess.rays.count; n++) {
		const int k = t->guess.index[n];

		t->rays.blocked[k] = t->guess.rays.blocked[n];
		t->guess.stopped[t->cell[k]] = t->guess.rays.blocked[n];
	}
}

/*
 * Weighted reservoir sampling: keeps one of a stream of candidates, with a probability in
 * proportion to its weight; it carries the sum of all weights. The random number of a candidate is
 * a function of its id, so that two streams that differ in few candidates mostly keep the same one.
 */
static void onward_offer(struct onward *onward, struct v3 direction, float weight, uint32_t key,
			 uint32_t id)
{
	onward->weight += weight;
	if (random_unit(random_hash32(key ^ (id * UINT32_C(0x9e3779b1)))) * onward->weight < weight)
		onward->direction[0] = direction;
}

/* Returns the place of a stratified draw in the sum of all candidates' weights. */
static float onward_place(const struct onward *onward, int k, float choice, float total)
{
	return ((float)k + choice) / (float)onward->count * total;
}

/* Draws a candidate whose weight begins at sum, unless a later candidate is drawn. */
static void onward_draw(struct onward *onward, struct v3 direction, float sum, float choice,
			float total)
{
	for (int k = 0; k < onward->count; k++)
		if (sum <= onward_place(onward, k, choice, total))
			onward->direction[k] = direction;
}

/*
 * Draws one of the blocked rays of the batch, whose weights are in value[], or one other candidate.
 * At the first surface the draws of a pixel's samples are stratified over all of them: rays lie in
 * the order of the sky, so that the second surfaces are well spread, too. With a cache PATHS_MAX
 * are drawn there; the k-th that draws the other candidate takes other[k]. Samples that are traced
 * with either presence are not stratified: where a candidate is in one stream only, the two would
 * draw different neighbours, and their difference would be noise.
 */
static struct onward choose_onward(struct transport *t, int depth, const struct v3 *other,
				   float other_weight)
{
	const bool spread = depth == 0 && !t->compared;
	const uint32_t key = (uint32_t)random_bits(&t->random);
	struct onward onward = {.count = spread && t->cache ? PATHS_MAX : 1};
	float total = other_weight, sum = 0;

	for (int k = 0; k < t->rays.count; k++)
		if (t->rays.blocked[k])
			total += t->value[t->cell[k]];
	for (int k = 0; k < t->rays.count; k++) {
		const int cell = t->cell[k];

		if (!t->rays.blocked[k])
			continue;
		if (!spread) {
			onward_offer(&onward, pushed_ray(t, k), t->value[cell], key,
				     (uint32_t)cell);
			continue;
		}
		onward_draw(&onward, pushed_ray(t, k), sum, t->choice, total);
		sum += t->value[cell];
	}
	if (!spread)
		onward_offer(&onward, other[0], other_weight, key, UINT32_MAX);
	for (int k = 0; k < onward.count && spread && other_weight > 0; k++)
		if (sum <= onward_place(&onward, k, t->choice, total))
			onward.direction[k] = other[k];
	onward.weight = total;
	return onward;
}

/*
 * Maps a point of the unit square to a cosine-weighted direction around n that points below the
 * horizon. On the unit disc onto which the hemisphere projects, these are the part beyond the
 * ellipse of the horizon. Across the slope the disc stays; down the slope each chord is compressed
 * to that part.
 */
static struct v3 direction_below(struct v3 n, float u, float v)
{
	/* A surface that faces straight down has no slope: any direction will do. */
	const float level = hypotf(n.x, n.y);
	const float x = level > 0 ? n.x / level : 1, y = level > 0 ? n.y / level : 0;
	const struct v3 down = v3_make(x * n.z, y * n.z, -level), across = v3_cross(n, down);
	float a, b, chord;

	disc_from_square(u, v, &a, &b);
	chord = sqrtf(fmaxf(1 - b * b, 1e-12f));
	a = chord * (n.z + (1 - n.z) * 0.5f * (fminf(fmaxf(a / chord, -1), 1) + 1));
	return v3_from_frame(v3_make(a, b, sqrtf(fmaxf(1 - a * a - b * b, 0))), down, across, n);
}

static float fract(float x)
{
	return x - floorf(x);
}

/* Returns the share of a cosine-weighted hemisphere around n that lies below the horizon. */
static float share_below(struct v3 n)
{
	return n.z < 1 - 1e-6f ? 0.5f * (1 - n.z) : 0;
}

/* Adds value[] times weight to a row. */
static void deposit_values(const struct transport *t, struct rgb weight, float *row)
{
	const int count = t->cells->count;
	const float *restrict value = t->value;

	for (int c = 0; c < 3; c++) {
		float *restrict out = row + (size_t)c * (size_t)count;
		const float w = weight.c[c];

		if (w != 0)
			for (int i = 0; i < count; i++)
				out[i] += w * value[i];
	}
}

/* Adds a row of three channels times weight to a row. */
static void deposit_row(struct rgb weight, const float *restrict from, float *restrict row,
			size_t count)
{
	for (size_t c = 0; c < 3; c++, from += count, row += count)
		for (size_t i = 0; i < count; i++)
			row[i] += weight.c[c] * from[i];
}

static void deposit_cell(const struct transport *t, int cell, struct rgb weight, float *row)
{
	for (int c = 0; c < 3; c++)
		row[(size_t)c * (size_t)t->cells->count + (size_t)cell] += weight.c[c];
}

/* Adds weight to the light of a direction of the sky. */
static void deposit_sky(const struct transport *t, struct v3 direction, struct rgb weight,
			float *row)
{
	const int cell = cells_of(t->cells, direction);

	if (cell >= 0)
		deposit_cell(t, cell, weight, row);
}

/* Tells whether the coat's lobe is wider than a cell. Rays to cells hardly ever hit a narrower
 * lobe; that is sampled by rays of its own alone. */
static bool coat_is_wide(const struct transport *t, const struct bsdf *bsdf)
{
	return !t->coat.state && bsdf->alpha * bsdf->alpha * 2 * (float)t->cells->count > 1;
}

/* ---- the first surfaces: a ray to every cell ---- */

/* Takes one direction in each cell above the surface. value[] becomes the light that a white
 * surface reflects from each cell; rays becomes the directions that may be blocked. */
static void aim_at_cells(struct transport *t, const struct surface *s, float cos_o,
			 const struct cone *cone, int depth)
{
	const struct cells *cells = t->cells;
	const uint32_t pixel = t->pixel + (uint32_t)depth * PIXEL_STEP;
	const bool flat = s->kind == SURFACE_GROUND && s->bsdf.kind == MATERIAL_DIFFUSE;
	/* The second surface takes the samples in another order, so that its directions do not
	 * correlate with the direction that led there. */
	const uint32_t sample = depth ? sobol_shuffle(t->sample, pixel) : t->sample;
	const struct v3 *row = cells_pick(cells, flat ? cells->ground : cells->uniform, pixel,
					  sample);

	t->rays.count = 0;
	for (int k = 0; k < cells->count; k++) {
		const struct v3 d = row[k];
		const int i = cells->order[k];
		float cos_i;

		t->value[i] = 0;
		if (v3_dot(s->normal, cells->node[i]) < -cells->reach[i])
			continue;
		cos_i = v3_dot(s->normal, d);
		if (cos_i <= 0 || v3_dot(s->geometric, d) <= 0)
			continue;
		t->value[i] = flat ? cells->share[i]
				   : cells->sr[i] * cos_i * (1 / PI_F) *
					      bsdf_base(&s->bsdf, cos_o, cos_i);
		if (v3_dot(cone->axis, d) >= cone->cosine)
			push_ray(t, d, i);
	}
}

/* Returns the light that reaches the origin along a ray of the batch through glass, if it is in the
 * way. */
static struct passage ray_passage(const struct transport *t, enum presence presence,
				  struct v3 origin, int at)
{
	if (t->rays.blocked[at] == RAY_GLASS)
		return world_through_glass(t->world, presence, origin, pushed_ray(t, at), INFINITY);
	return (struct passage){.open = false};
}

/* Adds the light that glass lets through to a surface of this colour. Straight light comes from the
 * ray's own cell; bent light comes from other cells, is noisy, and goes to bounce. value[] keeps
 * the share that glass mirrors. */
static void pass_rays(struct transport *t, enum presence presence, struct v3 origin,
		      struct rgb colour, float *row, float *bounce)
{
	for (int k = 0; k < t->rays.count; k++) {
		const struct passage p = ray_passage(t, presence, origin, k);
		const int cell = t->cell[k];
		const struct rgb weight = rgb_scale(rgb_mul(colour, p.passed), t->value[cell]);

		if (p.bent)
			deposit_sky(t, p.sky, weight, bounce);
		else if (p.open)
			deposit_cell(t, cell, weight, row);
		if (p.open)
			t->value[cell] *= p.mirrored;
	}
}

/* Adds the coat's light by the rays that were not blocked, weighted by the balance heuristic
 * between one ray a cell (of density 1 / sr) and rays drawn from the coat itself. */
static void add_coat_by_cells(struct transport *t, enum presence presence, const struct surface *s,
			      struct v3 wo, struct rgb weight, float *row)
{
	const struct v3 origin = surface_leave(s, s->geometric);

	for (int k = 0; k < t->rays.count; k++) {
		const struct passage p = ray_passage(t, presence, origin, k);
		const int cell = t->cell[k];
		float density;
		struct rgb f;

		if (t->rays.blocked[k] && !p.open)
			continue;
		f = bsdf_coat(&s->bsdf, s->normal, wo, pushed_ray(t, k), &density);
		if (p.open)
			f = rgb_mul(f, p.passed);
		if (rgb_peak(f) <= 0 || cells_of(t->cells, pushed_ray(t, k)) != cell)
			continue;
		f = rgb_scale(rgb_mul(weight, f), 1 / (1 / t->cells->sr[cell] + density));
		if (p.bent)
			deposit_sky(t, p.sky, f, row);
		else
			deposit_cell(t, cell, f, row);
	}
}

/* Adds the light of all visible cells, and draws the ray that goes on. */
static struct onward spread_to_cells(struct transport *t, enum presence presence,
				     const struct surface *s, struct v3 wo, struct rgb weight,
				     int depth, float *row, float *bounce)
{
	const struct bounds bounds = world_bounds(t->world, presence);
	const bool wide = s->bsdf.kind == MATERIAL_GLOSSY && coat_is_wide(t, &s->bsdf);
	const struct cone everywhere = {{0, 0, 1}, -2};
	const struct cone cone = wide ? everywhere : cone_of(&bounds, s->position);
	const float cos_o = v3_dot(s->normal, wo), below = share_below(s->normal);
	struct v3 down[PATHS_MAX] = {{0, 0, 0}};
	float weight_down = 0;
	struct onward onward;

	aim_at_cells(t, s, cos_o, &cone, depth);
	trace_cells(t, presence, surface_leave(s, s->geometric));
	pass_rays(t, presence, surface_leave(s, s->geometric), rgb_mul(weight, s->bsdf.colour), row,
		  bounce);
	if (below > 0) {
		const float u = depth ? random_next(&t->random) : (float)t->below[0];
		const float v = depth ? random_next(&t->random) : (float)t->below[1];

		for (int k = 0; k < (t->cache ? PATHS_MAX : 1); k++)
			down[k] = direction_below(s->normal, fract(u + (float)k * PLASTIC_1),
						  fract(v + (float)k * PLASTIC_2));
		weight_down = below *
			      bsdf_base(&s->bsdf, cos_o, fmaxf(v3_dot(s->normal, down[0]), 0));
	}
	onward = choose_onward(t, depth, down, weight_down);
	for (int k = 0; k < t->rays.count; k++)
		if (t->rays.blocked[k])
			t->value[t->cell[k]] = 0;
	deposit_values(t, rgb_mul(weight, s->bsdf.colour), row);
	if (wide)
		add_coat_by_cells(t, presence, s, wo, weight, row);
	return onward;
}

/* ---- further surfaces: a few rays ---- */

/* Adds the light seen in a fan of a few directions, turned at random around the normal, and draws
 * the ray that goes on. */
static struct onward spread_fan(struct transport *t, enum presence presence,
				const struct surface *s, struct v3 wo, struct rgb weight,
				float *row)
{
	const struct bounds bounds = world_bounds(t->world, presence);
	const struct cone cone = cone_of(&bounds, s->position);
	const float cos_o = v3_dot(s->normal, wo), each = 1.0f / (float)t->directions;
	const struct v3 origin = surface_leave(s, s->geometric);
	const struct rgb colour = rgb_mul(weight, s->bsdf.colour);
	const uint64_t bits = random_bits(&t->random);
	const struct v3 *fan = t->fan + (bits & (TRANSPORT_FANS - 1)) * (uint64_t)t->directions;
	const float turn = 2 * PI_F * random_unit((uint32_t)(bits >> 32));
	const float turn_cos = cosf(turn), turn_sin = sinf(turn);
	const uint32_t key = (uint32_t)(bits >> 16);
	struct onward onward = {.count = 1};
	struct v3 a, b, x, y;

	v3_frame(s->normal, &a, &b);
	x = v3_mad(v3_scale(a, turn_cos), turn_sin, b);
	y = v3_mad(v3_scale(b, turn_cos), -turn_sin, a);
	t->rays.count = 0;
	for (int k = 0; k < t->directions; k++) {
		const struct v3 d = v3_from_frame(fan[k], x, y, s->normal);
		const float value = each * bsdf_base(&s->bsdf, cos_o, fan[k].z);

		if (v3_dot(s->geometric, d) <= 0)
			continue;
		if (d.z < 0)
			onward_offer(&onward, d, value, key, (uint32_t)k);
		else if (v3_dot(cone.axis, d) < cone.cosine)
			deposit_sky(t, d, rgb_scale(colour, value), row);
		else
			push_ray(t, d, k);
	}
	trace_rays(t, presence, origin);
	for (int k = 0; k < t->rays.count; k++) {
		const struct passage p = ray_passage(t, presence, origin, k);
		const struct v3 d = pushed_ray(t, k);
		const float value = each * bsdf_base(&s->bsdf, cos_o, fan[t->cell[k]].z);

		if (p.open)
			deposit_sky(t, p.sky, rgb_scale(rgb_mul(colour, p.passed), value), row);
		if (t->rays.blocked[k])
			onward_offer(&onward, d, p.open ? value * p.mirrored : value, key,
				     (uint32_t)t->cell[k]);
		else
			deposit_sky(t, d, rgb_scale(colour, value), row);
	}
	return onward;
}

/* ---- going on ---- */

/* Returns the light that glass lets through if a ray from s meets glass first. If it is not open,
 * all light is left for the path that goes on. */
static struct passage next_passage(const struct transport *t, enum presence presence,
				   const struct surface *s, struct v3 direction,
				   const struct surface *next)
{
	if (direction.z >= 0 && next->bsdf.kind == MATERIAL_GLASS)
		return world_passage(t->world, presence, surface_leave(s, direction), direction,
				     INFINITY);
	return (struct passage){.open = false};
}

/* Goes on from s to the next surface; without one the path ends. No light of the sky is lost, as
 * directions given here were found blocked or point below the horizon. */
static void follow_path(struct transport *t, enum presence presence, const struct surface *s,
			struct v3 direction, struct rgb weight, int depth,
			const struct transport_rows *rows)
{
	const float peak = rgb_peak(weight);
	const bool gathered = t->gathered;
	const struct v3 gathered_at = t->gathered_at;
	struct surface next;

	if (depth > t->bounces || peak == 0)
		return;
	if (peak < WEIGHT_SURE) {
		if (random_next(&t->random) * WEIGHT_SURE >= peak)
			return;
		weight = rgb_scale(weight, WEIGHT_SURE / peak);
	}
	t->ray_count++;
	t->gathered = true;
	t->gathered_at = s->position;
	if (world_nearest(t->world, presence, surface_leave(s, direction), direction, &next)) {
		t->mirrored = next_passage(t, presence, s, direction, &next).mirrored;
		add_path(t, presence, &next, v3_scale(direction, -1), weight, depth, rows);
	}
	t->gathered = gathered;
	t->gathered_at = gathered_at;
}

/* Goes on in all directions drawn, which share the weight. */
static void follow_onward(struct transport *t, enum presence presence, const struct surface *s,
			  const struct onward *onward, struct rgb weight, int depth,
			  const struct transport_rows *rows)
{
	const struct rgb each = rgb_scale(weight, 1.0f / (float)onward->count);

	for (int k = 0; k < onward->count; k++)
		follow_path(t, presence, s, onward->direction[k], each, depth, rows);
}

/* Draws a ray from the coat, and adds the light of the sky that it sees, also through glass.
 * Returns false if nothing is left to follow; else *next is the surface it meets and *onward its
 * weight. If `shared`, add_coat_by_cells() adds the other part of the balance heuristic. */
static bool sample_coat(struct transport *t, enum presence presence, const struct surface *s,
			struct v3 wo, struct rgb weight, bool shared, struct surface *next,
			struct v3 *wi, struct rgb *onward, float *row)
{
	struct passage passage = {.open = true, .passed = {{1, 1, 1}}};
	float density;
	struct random *random = t->coat.state ? &t->coat : &t->random;
	struct rgb f;
	bool met;
	int cell;

	if (!bsdf_coat_sample(&s->bsdf, s->normal, wo, random, wi) ||
	    v3_dot(s->geometric, *wi) <= 0)
		return false;
	t->coat.state = 0;
	f = bsdf_coat(&s->bsdf, s->normal, wo, *wi, &density);
	if (density <= 0)
		return false;
	f = rgb_mul(weight, f);
	t->ray_count++;
	met = world_nearest(t->world, presence, surface_leave(s, *wi), *wi, next);
	if (met)
		passage = next_passage(t, presence, s, *wi, next);
	t->mirrored = passage.mirrored;
	*onward = rgb_scale(f, passage.open ? passage.mirrored / density : 1 / density);
	if (!passage.open)
		return true;
	f = rgb_mul(f, passage.passed);
	cell = cells_of(t->cells, *wi);
	if (cell >= 0) {
		const float other = shared ? 1 / t->cells->sr[cell] : 0;
		const struct rgb part = rgb_scale(f, 1 / (density + other));

		if (passage.bent)
			deposit_sky(t, passage.sky, part, row);
		else
			deposit_cell(t, cell, part, row);
	}
	return passage.mirrored > 0;
}

/*
 * Chooses how the path goes on at glass. If the light that passes all surfaces of glass is added
 * already, *mirrored is m, the probability that this surface or one behind it mirrors, and becomes
 * m', that of the ones behind. With R the reflectance of this surface,
 *     m = 1 - (1 - R) (1 - m'),  mirrored here with probability R / m
 */
static struct v3 choose_way(struct transport *t, const struct surface *s, struct v3 wo,
			    float *mirrored, struct rgb *tint)
{
	struct glass_ways ways;

	if (*mirrored == 0)
		return bsdf_glass_sample(&s->bsdf, s->normal, s->outer, wo, &t->random, tint);
	ways = bsdf_glass_ways(&s->bsdf, s->normal, s->outer, wo);
	if (random_next(&t->random) * *mirrored < ways.reflectance) {
		*mirrored = 0;
		*tint = rgb_make(1, 1, 1);
		return ways.mirrored;
	}
	*mirrored = (*mirrored - ways.reflectance) / (1 - ways.reflectance);
	*tint = s->bsdf.colour;
	return ways.passed;
}

/* Follows the path through glass to the next surface of another kind. Returns false if it has
 * ended. */
static bool pass_glass(struct transport *t, enum presence presence, struct surface *s,
		       struct v3 *wo, struct rgb *weight, float *row)
{
	float mirrored = t->mirrored;

	t->mirrored = 0;
	for (int k = 0; s->bsdf.kind == MATERIAL_GLASS; k++) {
		struct rgb tint;
		const struct v3 d = choose_way(t, s, *wo, &mirrored, &tint);
		struct surface next;

		if (k == GLASS_MAX)
			return false;
		*weight = rgb_mul(*weight, tint);
		t->ray_count++;
		if (!world_nearest(t->world, presence, surface_leave(s, d), d, &next)) {
			deposit_sky(t, d, *weight, row);
			return false;
		}
		*s = next;
		*wo = v3_scale(d, -1);
	}
	return true;
}

/*
 * Adds the light of a surface's diffuse base from the cache. Returns false if the path has to go
 * on. The base of a coated surface is taken as Lambertian with the same albedo towards wo:
 *     f = colour / pi * bsdf_base_mean(cos_o)
 * Differences between both presences of a sample are not taken from the cache, as the objects
 * change rows that hardly see them.
 */
static bool add_cached(struct transport *t, const struct surface *s, struct v3 wo,
		       struct rgb weight, float *row)
{
	const size_t count = 3 * (size_t)t->cells->count;
	int record;

	if (!t->cache || !t->gathered || t->compared || (t->link && t->links == t->links_max))
		return false;
	record = cache_find(t->cache, s);
	if (!t->link && v3_length(v3_sub(s->position, t->gathered_at)) <
				CACHE_NEAR * cache_spread(t->cache, record))
		return false;
	weight = rgb_scale(rgb_mul(weight, s->bsdf.colour),
			   bsdf_base_mean(&s->bsdf, v3_dot(s->normal, wo)));
	if (t->link) {
		t->link[t->links++] = (struct transport_link){record, weight};
		return true;
	}
	deposit_row(weight, cache_row(t->cache, record), row, count / 3);
	return true;
}

/* Adds the light that leaves a surface towards wo, and goes on. depth is the number of surfaces
 * before this one, without glass. */
static void add_path(struct transport *t, enum presence presence, const struct surface *at,
		     struct v3 wo, struct rgb weight, int depth, const struct transport_rows *rows)
{
	float *const row = depth == 0 ? rows->direct : rows->bounce;
	struct surface s = *at, mirrored;
	struct rgb base, coat = {{0, 0, 0}};
	struct onward onward = {.count = 0};
	struct v3 wi;
	bool all, shared, cached;

	if (!pass_glass(t, presence, &s, &wo, &weight, row))
		return;
	cached = add_cached(t, &s, wo, weight, row);
	all = depth <= ALL_CELLS_DEPTH && !cached;
	if (!cached)
		onward = all ? spread_to_cells(t, presence, &s, wo, weight, depth, row,
					       rows->bounce)
			     : spread_fan(t, presence, &s, wo, weight, row);
	base = rgb_scale(rgb_mul(weight, s.bsdf.colour), onward.weight);
	shared = all && coat_is_wide(t, &s.bsdf);
	if (s.bsdf.kind != MATERIAL_GLOSSY ||
	    !sample_coat(t, presence, &s, wo, weight, shared, &mirrored, &wi, &coat, row)) {
		follow_onward(t, presence, &s, &onward, base, depth + 1, rows);
		return;
	}
	/* There are two ways on. Both are followed from the first surface, one at random later. */
	if (depth > 0) {
		const float share = rgb_peak(coat) / fmaxf(rgb_peak(coat) + rgb_peak(base), 1e-30f);

		if (random_next(&t->random) < share) {
			coat = rgb_scale(coat, 1 / share);
			base = rgb_make(0, 0, 0);
		} else {
			base = rgb_scale(base, 1 / (1 - share));
			coat = rgb_make(0, 0, 0);
		}
	}
	if (depth < t->bounces && rgb_peak(coat) > 0)
		add_path(t, presence, &mirrored, v3_scale(wi, -1), coat, depth + 1, rows);
	follow_onward(t, presence, &s, &onward, base, depth + 1, rows);
}

void transport_add(struct transport *t, enum presence presence, const struct surface *surface,
		   struct v3 wo, struct rgb weight, const struct transport_rows *rows)
{
	t->compared = surface->kind != SURFACE_OBJECT;
	t->gathered = false;
	t->mirrored = 0;
	add_path(t, presence, surface, wo, weight, 0, rows);
}

void transport_add_sky(struct transport *t, struct v3 direction, struct rgb weight,
		       const struct transport_rows *rows)
{
	deposit_sky(t, direction, weight, rows->direct);
}

/* ---- shadow on flat ground ---- */

int transport_shadow_channels(const struct world *world)
{
	return world_has_tinted_panes(world) ? 3 : 1;
}

/* Adds the light of a ray's cell that objects block, and returns whether there is any. value[]
 * keeps the light that objects may reflect to the ground instead. */
static bool add_blocked(struct transport *t, struct v3 position, int at, float weight,
			const struct transport_rows *rows)
{
	const struct passage p = ray_passage(t, WITH_OBJECTS, position, at);
	const int cell = t->cell[at], channels = transport_shadow_channels(t->world);
	bool any = false;

	for (int c = 0; c < channels && t->rays.blocked[at]; c++) {
		const float lost = p.bent ? 1 : 1 - p.passed.c[c];

		rows->direct[(size_t)c * (size_t)t->cells->count + (size_t)cell] += weight * lost;
		any |= lost > 0;
	}
	t->value[cell] = t->cells->share[cell];
	if (p.bent)
		deposit_sky(t, p.sky, rgb_scale(p.passed, -weight * t->value[cell]), rows->bounce);
	if (p.open)
		t->value[cell] *= p.mirrored;
	return any;
}

bool transport_add_shadow(struct transport *t, struct v3 position, float weight,
			  const struct transport_rows *rows)
{
	const struct cells *cells = t->cells;
	const struct bounds bounds = world_bounds(t->world, WITH_OBJECTS);
	const struct cone cone = cone_of(&bounds, position);
	const struct surface ground = {
		.kind = SURFACE_GROUND,
		.position = position,
		.normal = {0, 0, 1},
		.geometric = {0, 0, 1},
	};
	const struct v3 *row = cells_pick(cells, cells->ground, t->pixel, t->sample);
	struct onward onward;
	bool any = false;

	t->compared = false;
	t->gathered = false;
	t->rays.count = 0;
	for (int k = 0; k < cells->count; k++)
		if (v3_dot(cone.axis, row[k]) >= cone.cosine)
			push_ray(t, row[k], cells->order[k]);
	trace_cells(t, WITH_OBJECTS, position);
	for (int k = 0; k < t->rays.count; k++)
		any |= add_blocked(t, position, k, weight, rows);
	onward = choose_onward(t, 0, NULL, 0);
	if (onward.weight == 0)
		return any;
	weight *= -onward.weight;
	follow_onward(t, WITH_OBJECTS, &ground, &onward, rgb_make(weight, weight, weight), 1, rows);
	return true;
}

/* ---- the coat of flat ground ---- */

bool transport_mirrors_object(struct transport *t, const struct surface *ground, struct v3 wo)
{
	const struct random before = t->random;
	struct surface met;
	struct v3 wi;
	bool drawn;

	if (ground->kind != SURFACE_GROUND || ground->bsdf.kind != MATERIAL_GLOSSY)
		return false;
	drawn = bsdf_coat_sample(&ground->bsdf, ground->normal, wo, &t->random, &wi);
	t->random = before;
	t->ray_count++;
	return drawn && world_nearest(t->world, WITH_OBJECTS, surface_leave(ground, wi), wi, &met);
}

void transport_add_mirrored(struct transport *t, const struct surface *ground, struct v3 wo,
			    const struct transport_rows *rows)
{
	t->compared = false;
	t->gathered = false;
	t->mirrored = 0;
	t->coat = t->random;
	add_path(t, WITH_OBJECTS, ground, wo, rgb_make(1, 1, 1), 0, rows);
	t->coat.state = 0;
}

/* ---- points of the cache ---- */

void transport_link(struct transport *t, const struct surface *s, float *row)
{
	const struct rgb white = {{1, 1, 1}};
	const struct transport_rows rows = {.direct = row, .bounce = row};
	struct onward onward;

	t->compared = false;
	t->gathered = false;
	onward = spread_to_cells(t, WITH_OBJECTS, s, s->normal, white, 0, row, row);
	follow_onward(t, WITH_OBJECTS, s, &onward, rgb_scale(white, onward.weight), 1, &rows);
}
