/* SPDX-License-Identifier: MIT */
/*
 * What rays meet: objects, stand-ins for real surfaces, and the ground plane Z = 0.
 *
 * The same world exists twice: with the objects (what the finished picture shows) and without them
 * (what the camera sees).
 */
#ifndef INLAY_BAKE_TRACE_WORLD_H
#define INLAY_BAKE_TRACE_WORLD_H

#include <stdbool.h>
#include <stdint.h>

#include "bake/mesh/mesh.h"

enum presence { WITH_OBJECTS, WITHOUT_OBJECTS, PRESENCE_COUNT };
enum surface_kind { SURFACE_NONE, SURFACE_OBJECT, SURFACE_STANDIN, SURFACE_GROUND };

/* A point on a surface. */
struct surface {
	enum surface_kind kind;
	struct v3 position;
	struct v3 normal;    /* of the smoothed surface, on the side the ray came from */
	struct v3 geometric; /* of the triangle, on that side */
	bool outer;	     /* that side is the one the triangle's winding calls outside */
	float offset;	     /* rays that leave start this far off the surface */
	struct bsdf bsdf;
};

/* Encloses all meshes of a presence; radius < 0: there are none. */
struct bounds {
	struct v3 centre;
	float radius;
};

/* Rays of one origin, as Embree takes sixteen at a time. Directions need not be unit. */
#define WORLD_RAYS_MAX 32768
struct ray_batch {
	int count;
	float *x, *y, *z; /* [WORLD_RAYS_MAX] */
	uint8_t *blocked; /* [WORLD_RAYS_MAX]; the answer */
};

struct world;

int world_create(struct world **world, struct fault *fault);

/* mesh must outlive the world. material: NULL for the mesh's own. */
int world_add(struct world *world, const struct mesh *mesh, const struct material *material,
	      enum surface_kind kind, struct fault *fault);

/* A Lambertian plane; extent 0: without end, else the radius of a disc around the origin. */
void world_ground(struct world *world, struct rgb albedo, double extent);

/* After all meshes and the ground: builds what tracing needs. */
int world_commit(struct world *world, struct fault *fault);

bool world_has_ground(const struct world *world);
bool world_has_standins(const struct world *world);
struct rgb world_ground_albedo(const struct world *world);
struct bounds world_bounds(const struct world *world, enum presence presence);

/* The nearest surface along a ray (unit direction), the ground included. False: none. */
bool world_nearest(const struct world *world, enum presence presence, struct v3 origin,
		   struct v3 direction, struct surface *surface);

/* Whether a ray meets a mesh (the ground does not count). */
bool world_blocked(const struct world *world, enum presence presence, struct v3 origin,
		   struct v3 direction);

/* Which rays of a batch meet a mesh (the ground does not count: only rays upwards are asked). */
void world_occluded(const struct world *world, enum presence presence, struct v3 origin,
		    struct ray_batch *batch);

/* Where rays into a direction start. */
static inline struct v3 surface_leave(const struct surface *s, struct v3 direction)
{
	const float side = v3_dot(s->geometric, direction) < 0 ? -s->offset : s->offset;

	return v3_mad(s->position, side, s->geometric);
}

void world_destroy(struct world *world);

int ray_batch_create(struct ray_batch *batch);
void ray_batch_free(struct ray_batch *batch);

#endif
