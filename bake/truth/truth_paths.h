/* SPDX-License-Identifier: MIT */
/* Paths of light, one at a time. Private to truth*.c. */
#ifndef INLAY_BAKE_TRUTH_TRUTH_PATHS_H
#define INLAY_BAKE_TRUTH_TRUTH_PATHS_H

#include "bake/tiles/sight.h"
#include "bake/truth/sky.h"

/* The state of one thread. */
struct tracer {
	const struct scene *scene;
	const struct sky *sky;
	int bounces;
	struct random random;
	/* stratified over a pixel's samples: where the first surface samples the sky */
	float first[2];
	uint64_t rays;
};

/* Radiance that leaves a surface towards wo. depth: number of surfaces before it on the path.
 * point: of the unit square, selects the direction of the first direct light; NULL: random. */
struct rgb truth_radiance(struct tracer *tracer, enum presence presence,
			  const struct surface *surface, struct v3 wo, int depth,
			  const float *point);

/* Real surfaces in a pixel, as sums over samples: their light without objects, and what objects
 * take from it. */
struct truth_receiver {
	struct rgb taken, without;
	double weight;
};

/* Adds a real surface that is seen with this weight. Returns whether objects take light from it. */
bool truth_add_receiver(struct tracer *tracer, struct truth_receiver *to,
			const struct surface *surface, struct v3 wo, double weight);

/* Light that a real surface sends towards wo without objects. */
struct rgb truth_real_light(struct tracer *tracer, const struct surface *surface, struct v3 wo);

/* A view ray through the object's glass; at each surface chance decides between mirroring and
 * passing. */
struct truth_sight {
	struct sight end;
	struct rgb lamps; /* light of lamps that it meets on its way */
	bool mirrored;	  /* at one surface at least */
};

/* Follows a view ray through the object's glass. Returns false if it meets too many surfaces. */
bool truth_through_glass(struct tracer *tracer, const struct surface *surface, struct v3 direction,
			 struct truth_sight *sight);

#endif
