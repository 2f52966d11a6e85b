/* SPDX-License-Identifier: MIT */
#include "bake/tiles/sight.h"

#define GLASS_MAX 32 /* a path passes at most this many surfaces of glass in a row */
/* Two points count as one if they are nearer than this share of their distance to the camera: about
 * a pixel of a picture 1,000 pixels wide. */
#define SAME_PLACE 1e-3f
/* The sky is taken to be this far away, in world units. */
#define FAR_AWAY 1e6f

static bool is_glass(const struct surface *s)
{
	return s->kind == SURFACE_OBJECT && s->bsdf.kind == MATERIAL_GLASS;
}

/* The mirrored ray that is followed: weighted reservoir sampling over the surfaces on the way. */
struct chosen_mirror {
	struct surface at;
	struct v3 direction;
	struct rgb weight; /* weight of the chosen ray alone */
	float share, sum;  /* largest channel of its weight; sum of these over all rays */
};

static void chosen_offer(struct chosen_mirror *chosen, struct random *random,
			 const struct surface *at, struct v3 direction, struct rgb weight)
{
	const float share = rgb_peak(weight);

	chosen->sum += share;
	if (share <= 0 || random_next(random) * chosen->sum >= share)
		return;
	chosen->at = *at;
	chosen->direction = direction;
	chosen->weight = weight;
	chosen->share = share;
}

void sight_through_glass(const struct world *world, struct random *random,
			 const struct surface *surface, struct v3 direction, struct sight *passed,
			 struct sight *mirrored)
{
	struct chosen_mirror chosen = {.sum = 0};
	int surfaces = 0;

	*passed = (struct sight){{{1, 1, 1}}, true, *surface, direction};
	*mirrored = (struct sight){.met = false};
	while (passed->met && is_glass(&passed->surface)) {
		const struct surface s = passed->surface;
		const struct glass_ways ways = bsdf_glass_ways(&s.bsdf, s.normal, s.outer,
							       v3_scale(passed->direction, -1));

		chosen_offer(&chosen, random, &s, ways.mirrored,
			     rgb_scale(passed->weight, ways.reflectance));
		if (ways.reflectance >= 1 || ++surfaces > GLASS_MAX) {
			passed->weight = rgb_make(0, 0, 0);
			break;
		}
		passed->weight = rgb_mul(rgb_scale(passed->weight, 1 - ways.reflectance),
					 s.bsdf.colour);
		passed->direction = ways.passed;
		passed->met = world_nearest(world, WITH_OBJECTS, surface_leave(&s, ways.passed),
					    ways.passed, &passed->surface);
	}
	if (chosen.sum <= 0)
		return;
	mirrored->weight = rgb_scale(chosen.weight, chosen.sum / chosen.share);
	mirrored->direction = chosen.direction;
	mirrored->met = world_nearest(world, WITH_OBJECTS,
				      surface_leave(&chosen.at, chosen.direction), chosen.direction,
				      &mirrored->surface);
}

bool sight_place(const struct scene *scene, const struct sight *sight, double place[2])
{
	const struct tsai_camera *camera = &scene->camera;
	const struct v3 to = sight->met ? v3_sub(sight->surface.position, scene->eye)
					: v3_scale(sight->direction, FAR_AWAY);
	const float distance = v3_length(to);
	const double point[3] = {(double)scene->eye.x + (double)to.x,
				 (double)scene->eye.y + (double)to.y,
				 (double)scene->eye.z + (double)to.z};
	struct surface shown;
	bool met;

	if (distance <= 0 || tsai_project(camera, point, place) < 0 || !(place[0] >= 0) ||
	    !(place[1] >= 0) || place[0] >= camera->width || place[1] >= camera->height)
		return false;
	met = world_nearest(scene->world, WITHOUT_OBJECTS, scene->eye, v3_scale(to, 1 / distance),
			    &shown);
	if (!met || !sight->met)
		return !met && !sight->met;
	return v3_length(v3_sub(shown.position, sight->surface.position)) <= SAME_PLACE * distance;
}
