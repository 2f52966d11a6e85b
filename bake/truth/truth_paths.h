/* SPDX-License-Identifier: MIT */
/* Paths of light under a panorama, one at a time. Private to truth*.c. */
#ifndef INLAY_BAKE_TRUTH_TRUTH_PATHS_H
#define INLAY_BAKE_TRUTH_TRUTH_PATHS_H

#include "bake/tiles/sight.h"
#include "bake/truth/sky.h"

/* Of one thread. */
struct tracer {
	const struct scene *scene;
	const struct sky *sky;
	int bounces;
	struct random random;
	float first[2]; /* stratified over a pixel's samples: the first surface's way to the sky */
	uint64_t rays;
};

/* Radiance that leaves a surface towards wo; depth: surfaces before it. point: of the unit square,
 * which point of the sky gives the first direct light; NULL: any. */
struct rgb truth_radiance(struct tracer *tracer, enum presence presence,
			  const struct surface *surface, struct v3 wo, int depth,
			  const float *point);

/* What is seen of real surfaces, and what objects take from it; sums over samples. */
struct truth_receiver {
	struct rgb taken, without;
	double weight;
};

/* A real surface that is seen, as much as weight says. Whether objects take anything from it. */
bool truth_add_receiver(struct tracer *tracer, struct truth_receiver *to,
			const struct surface *surface, struct v3 wo, double weight);

/* A way through the object's glass, each turn by chance. */
struct truth_sight {
	struct sight end;
	bool mirrored; /* somewhere */
};

/* False: it does not end. */
bool truth_through_glass(struct tracer *tracer, const struct surface *surface, struct v3 direction,
			 struct truth_sight *sight);

#endif
