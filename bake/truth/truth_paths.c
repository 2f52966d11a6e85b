/* SPDX-License-Identifier: MIT */
#include "bake/truth/truth_paths.h"

#define GLASS_MAX 32
#define WEIGHT_SURE 0.1f

/* ---- scattering ---- */

/* Probability of sampling a glossy surface by its coat. A metal has nothing else: each sample of
 * its black base would be lost, and its picture noisy. */
static float coat_chance(const struct bsdf *bsdf)
{
	return rgb_peak(bsdf->colour) > 0 ? 0.5f : 1;
}

/* Returns f cos(theta). density: that with which sample_bsdf() draws wi. */
static struct rgb eval_bsdf(const struct surface *s, struct v3 wo, struct v3 wi, float *density)
{
	const float cos_o = v3_dot(s->normal, wo), cos_i = v3_dot(s->normal, wi);
	struct rgb f, coat;
	float coat_density, chance;

	*density = 0;
	if (cos_i <= 0 || v3_dot(s->geometric, wi) <= 0)
		return rgb_make(0, 0, 0);
	f = rgb_scale(s->bsdf.colour, bsdf_base(&s->bsdf, cos_o, cos_i) * cos_i / PI_F);
	*density = cos_i / PI_F;
	if (s->bsdf.kind != MATERIAL_GLOSSY)
		return f;
	coat = bsdf_coat(&s->bsdf, s->normal, wo, wi, &coat_density);
	chance = coat_chance(&s->bsdf);
	*density = (1 - chance) * *density + chance * coat_density;
	return rgb_add(f, coat);
}

static bool sample_bsdf(const struct surface *s, struct v3 wo, struct random *random, struct v3 *wi)
{
	if (s->bsdf.kind == MATERIAL_GLOSSY && random_next(random) < coat_chance(&s->bsdf)) {
		if (!bsdf_coat_sample(&s->bsdf, s->normal, wo, random, wi))
			return false;
	} else {
		const float u = random_next(random), v = random_next(random);

		*wi = hemisphere_cosine(s->normal, u, v);
	}
	return v3_dot(s->geometric, *wi) > 0;
}

/* Share of the light that arrives straight from a direction: from a lamp at the distance far, or
 * the sky's. */
static struct rgb passed_from(struct tracer *t, enum presence presence, struct v3 origin,
			      struct v3 wi, float far)
{
	const struct passage p = world_passage(t->scene->world, presence, origin, wi, far);

	t->rays++;
	return p.bent ? rgb_make(0, 0, 0) : p.passed;
}

/* Direct light from a sampled point of the sky, weighted by the balance heuristic. */
static struct rgb light_from_sky(struct tracer *t, enum presence presence, const struct surface *s,
				 struct v3 wo, const float point[2])
{
	float density, other;
	const struct v3 wi = sky_sample(t->sky, point[0], point[1], &density);
	const struct rgb f = eval_bsdf(s, wo, wi, &other);

	if (density <= 0 || other <= 0 || wi.z < 0)
		return rgb_make(0, 0, 0);
	return rgb_scale(
		rgb_mul(f, rgb_mul(passed_from(t, presence, surface_leave(s, wi), wi, INFINITY),
				   sky_radiance(t->sky, wi))),
		1 / (density + other));
}

/* Light of a lamp that arrives straight from a direction. */
static struct rgb lamp_arriving(struct tracer *t, enum presence presence, struct v3 origin,
				struct v3 wi, const struct truth_lamp *lamp)
{
	const float far = lamp_distance(lamp, origin, wi);

	return far < INFINITY ? rgb_mul(passed_from(t, presence, origin, wi, far), lamp->radiance)
			      : rgb_make(0, 0, 0);
}

/* Weight of a sample over its density, by the power heuristic: under a small lamp the rare other
 * samples hardly count, while the balance heuristic would leave their noise. */
static float power_weight(float density, float other)
{
	return density / (density * density + other * other);
}

/* Direct light from a sampled point of each lamp. */
static struct rgb light_from_lamps(struct tracer *t, enum presence presence,
				   const struct surface *s, struct v3 wo, const float point[2])
{
	struct rgb sum = {{0, 0, 0}};

	for (int k = 0; k < t->sky->lamp_count; k++) {
		const struct truth_lamp *lamp = &t->sky->lamps[k];
		const struct v3 wi = lamp_sample(lamp, s->position, point[0], point[1]);
		float other;
		const struct rgb f = eval_bsdf(s, wo, wi, &other);

		if (other > 0)
			sum = rgb_add(
				sum,
				rgb_scale(rgb_mul(f, lamp_arriving(t, presence,
								   surface_leave(s, wi), wi, lamp)),
					  power_weight(lamp_density(lamp, s->position), other)));
	}
	return sum;
}

/* Light of all lamps that a direction of this density, drawn by the BSDF, meets. */
static struct rgb lamps_met(struct tracer *t, enum presence presence, const struct surface *s,
			    struct v3 wi, float density)
{
	struct rgb sum = {{0, 0, 0}};

	for (int k = 0; k < t->sky->lamp_count; k++) {
		const struct truth_lamp *lamp = &t->sky->lamps[k];

		sum = rgb_add(sum,
			      rgb_scale(lamp_arriving(t, presence, surface_leave(s, wi), wi, lamp),
					power_weight(density, lamp_density(lamp, s->position))));
	}
	return sum;
}

static float way_to(struct v3 from, bool met, const struct surface *s)
{
	return met ? v3_length(v3_sub(s->position, from)) : INFINITY;
}

/* ---- paths ---- */

/* Follows a path through glass until another surface is met. Returns false when the path has ended;
 * its light is added then. counted: not if it has passed straight through panes. */
static bool pass_glass(struct tracer *t, enum presence presence, struct surface *s, struct v3 *wo,
		       bool counted, struct rgb *weight, struct rgb *light)
{
	for (int k = 0; s->bsdf.kind == MATERIAL_GLASS; k++) {
		struct rgb tint;
		const struct v3 d = bsdf_glass_sample(&s->bsdf, s->normal, s->outer, *wo,
						      &t->random, &tint);
		struct surface next;
		struct rgb shines;
		struct v3 from;
		bool met;

		if (k == GLASS_MAX)
			return false;
		*weight = rgb_mul(*weight, tint);
		counted &= bsdf_is_pane(&s->bsdf) && v3_dot(d, s->normal) < 0;
		t->rays++;
		from = surface_leave(s, d);
		met = world_nearest(t->scene->world, presence, from, d, &next);
		if (!counted) {
			shines = sky_lamps(t->sky, from, d, way_to(from, met, &next));
			if (!met)
				shines = rgb_add(shines, sky_radiance(t->sky, d));
			*light = rgb_add(*light, rgb_mul(*weight, shines));
		}
		if (!met)
			return false;
		*s = next;
		*wo = v3_scale(d, -1);
	}
	return true;
}

static bool path_survives(struct tracer *t, struct rgb *weight)
{
	const float peak = rgb_peak(*weight);

	if (peak >= WEIGHT_SURE)
		return true;
	if (random_next(&t->random) * WEIGHT_SURE >= peak)
		return false;
	*weight = rgb_scale(*weight, WEIGHT_SURE / peak);
	return true;
}

/* Path tracing: at each surface one sample of the sky and one of the BSDF. */
struct rgb truth_radiance(struct tracer *t, enum presence presence, const struct surface *at,
			  struct v3 wo, int depth, const float *point)
{
	struct rgb light = {{0, 0, 0}}, weight = {{1, 1, 1}};
	struct surface s = *at;
	/* The ray that led here has been followed straight through panes to the sky, except the
	 * camera's. */
	bool counted = depth > 0;

	for (;; depth++) {
		float fresh[2], density, other;
		struct surface next;
		struct rgb f;
		struct v3 wi;
		bool met;

		if (!pass_glass(t, presence, &s, &wo, counted, &weight, &light))
			return light;
		counted = true;
		fresh[0] = random_next(&t->random);
		fresh[1] = random_next(&t->random);
		if (!point)
			point = fresh;
		light = rgb_add(light, rgb_mul(weight, light_from_sky(t, presence, &s, wo, point)));
		light = rgb_add(light,
				rgb_mul(weight, light_from_lamps(t, presence, &s, wo, point)));
		point = NULL;
		if (!sample_bsdf(&s, wo, &t->random, &wi))
			return light;
		f = eval_bsdf(&s, wo, wi, &density);
		if (density <= 0)
			return light;
		t->rays++;
		met = world_nearest(t->scene->world, presence, surface_leave(&s, wi), wi, &next);
		if (wi.z >= 0 && (!met || bsdf_is_pane(&next.bsdf))) {
			const struct rgb sky = rgb_mul(
				passed_from(t, presence, surface_leave(&s, wi), wi, INFINITY),
				sky_radiance(t->sky, wi));

			other = sky_density(t->sky, wi);
			light = rgb_add(light, rgb_mul(weight, rgb_scale(rgb_mul(f, sky),
									 1 / (density + other))));
		}
		light = rgb_add(light, rgb_mul(weight, rgb_mul(f, lamps_met(t, presence, &s, wi,
									    density))));
		if (!met)
			return light;
		weight = rgb_mul(weight, rgb_scale(f, 1 / density));
		if (depth == t->bounces || !path_survives(t, &weight))
			return light;
		s = next;
		wo = v3_scale(wi, -1);
	}
}

/* Light, of the sky or of a lamp at the distance far, that does not arrive straight from a
 * direction. */
static struct rgb lost_from(struct tracer *t, struct v3 origin, struct v3 wi, float far,
			    struct rgb radiance)
{
	const struct rgb passed = passed_from(t, WITH_OBJECTS, origin, wi, far);
	const struct rgb lost = {{1 - passed.c[0], 1 - passed.c[1], 1 - passed.c[2]}};

	return rgb_mul(lost, radiance);
}

/* What arrives at flat ground without objects, as irradiance / pi. What objects block of the lamps'
 * light is added to *lost, unless that is NULL. */
static struct rgb light_on_ground(struct tracer *t, struct v3 at, struct rgb *lost)
{
	struct rgb light = t->sky->ground;

	for (int k = 0; k < t->sky->lamp_count; k++) {
		const struct truth_lamp *lamp = &t->sky->lamps[k];
		const struct v3 wi = lamp_sample(lamp, at, t->first[0], t->first[1]);
		const float far = lamp_distance(lamp, at, wi);
		const struct rgb radiance = rgb_scale(lamp->radiance,
						      wi.z / PI_F / lamp_density(lamp, at));

		if (wi.z <= 0 || far == INFINITY)
			continue;
		light = rgb_add(light, radiance);
		if (lost)
			*lost = rgb_add(*lost, lost_from(t, at, wi, far, radiance));
	}
	return light;
}

/* What objects take from the light from afar on flat ground, as irradiance / pi: what they block
 * less all the light they send. */
static struct rgb taken_from_ground(struct tracer *t, const struct surface *s)
{
	const struct world *world = t->scene->world;
	struct rgb taken = {{0, 0, 0}};
	struct surface next;
	float density;
	struct v3 wi = sky_sample(t->sky, t->first[0], t->first[1], &density);
	const float u = random_next(&t->random), v = random_next(&t->random);

	t->rays += 2;
	if (wi.z > 0 && density > 0)
		taken = rgb_scale(lost_from(t, s->position, wi, INFINITY, sky_radiance(t->sky, wi)),
				  wi.z / PI_F / (density + wi.z / PI_F));
	wi = hemisphere_cosine(s->normal, u, v);
	if (world_nearest(world, WITH_OBJECTS, s->position, wi, &next)) {
		const float other = sky_density(t->sky, wi), own = wi.z / PI_F;

		taken = rgb_add(taken, rgb_scale(lost_from(t, s->position, wi, INFINITY,
							   sky_radiance(t->sky, wi)),
						 own / (own + other)));
		if (t->bounces > 0)
			taken = rgb_add(taken, rgb_scale(truth_radiance(t, WITH_OBJECTS, &next,
									v3_scale(wi, -1), 1, NULL),
							 -1));
	}
	return taken;
}

/* Whether real surfaces need paths: only flat diffuse ground has formulas. */
static bool is_traced(const struct world *world)
{
	return world_has_standins(world) || world_ground_bsdf(world)->kind != MATERIAL_DIFFUSE;
}

bool truth_add_receiver(struct tracer *t, struct truth_receiver *to, const struct surface *s,
			struct v3 wo, double weight)
{
	const struct tracer before = *t;
	struct rgb with, without, taken;

	if (is_traced(t->scene->world)) {
		with = truth_radiance(t, WITH_OBJECTS, s, wo, 0, t->first);
		t->random = before.random;
		without = truth_radiance(t, WITHOUT_OBJECTS, s, wo, 0, t->first);
		taken = rgb_add(without, rgb_scale(with, -1));
	} else {
		const struct rgb albedo = world_ground_bsdf(t->scene->world)->colour;

		taken = taken_from_ground(t, s);
		without = rgb_mul(albedo, light_on_ground(t, s->position, &taken));
		taken = rgb_mul(albedo, taken);
	}
	to->weight += weight;
	to->taken = rgb_add(to->taken, rgb_scale(taken, (float)weight));
	to->without = rgb_add(to->without, rgb_scale(without, (float)weight));
	return rgb_peak(taken) > 0;
}

struct rgb truth_real_light(struct tracer *t, const struct surface *s, struct v3 wo)
{
	if (is_traced(t->scene->world))
		return truth_radiance(t, WITHOUT_OBJECTS, s, wo, 0, t->first);
	return rgb_mul(world_ground_bsdf(t->scene->world)->colour,
		       light_on_ground(t, s->position, NULL));
}

bool truth_through_glass(struct tracer *t, const struct surface *surface, struct v3 direction,
			 struct truth_sight *sight)
{
	struct sight *end = &sight->end;

	*sight = (struct truth_sight){.end = {{{1, 1, 1}}, true, *surface, direction}};
	for (int k = 0; end->met && end->surface.kind == SURFACE_OBJECT &&
			end->surface.bsdf.kind == MATERIAL_GLASS;
	     k++) {
		const struct surface s = end->surface;
		struct rgb tint;
		struct v3 from;

		if (k == GLASS_MAX)
			return false;
		end->direction = bsdf_glass_sample(&s.bsdf, s.normal, s.outer,
						   v3_scale(end->direction, -1), &t->random, &tint);
		end->weight = rgb_mul(end->weight, tint);
		sight->mirrored |= v3_dot(end->direction, s.normal) > 0;
		t->rays++;
		from = surface_leave(&s, end->direction);
		end->met = world_nearest(t->scene->world, WITH_OBJECTS, from, end->direction,
					 &end->surface);
		sight->lamps = rgb_add(
			sight->lamps,
			rgb_mul(end->weight, sky_lamps(t->sky, from, end->direction,
						       way_to(from, end->met, &end->surface))));
	}
	return true;
}
