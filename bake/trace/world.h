/* SPDX-License-Identifier: MIT */
/*
 * The surfaces that rays meet: objects, stand-ins for real surfaces, and the ground plane Z = 0.
 *
 * The world exists in two versions: with the objects, as the finished picture shows it, and without
 * them, as the camera sees it. A stand-in is geometry for a real surface: it receives shadows and
 * hides objects, but does not itself appear in the picture.
 */
#ifndef INLAY_BAKE_TRACE_WORLD_H
#define INLAY_BAKE_TRACE_WORLD_H

#include <stdbool.h>
#include <stdint.h>

#include "bake/mesh/mesh.h"

/*
 * Balls inside closed objects. No triangle of its object reaches into a ball, and every way out of
 * it crosses one, so that a ray that meets a ball is blocked, wherever it starts. This takes a
 * tenth of the time that Embree needs to find a triangle in the ray's way.
 */

#define INSIDE_MAX 64 /* a world has at most this many balls */

struct inside {
	int count;
	float x[INSIDE_MAX], y[INSIDE_MAX], z[INSIDE_MAX]; /* centres */
	float radius2[INSIDE_MAX];			   /* squared; 0 beyond count */
};

/* Finds the distance from a point to the next triangle in a direction. Returns false if there is
 * none. */
typedef bool (*inside_chord)(const void *context, struct v3 from, struct v3 direction,
			     float *length);

/*
 * Adds at most `most` balls inside an object of these parts. Adds none if memory runs out, or if
 * the surface is not closed (mesh_is_closed).
 */
void inside_add(struct inside *inside, const struct mesh_part *parts, int count, int most,
		inside_chord chord, const void *context);

/*
 * The balls as they are seen from one point. A ray of unit direction d meets a ball if
 *     dot(to, d) > 0  and  dot(to, d)^2 > |to|^2 - radius^2
 */
struct inside_view {
	float x[INSIDE_MAX], y[INSIDE_MAX],
		z[INSIDE_MAX]; /* `to` of the formula above: from the point to the ball's centre */
	float least[INSIDE_MAX]; /* |to|^2 - radius^2; infinity: too far away, or no ball */
};

void inside_see(const struct inside *inside, struct v3 from, struct inside_view *view);

static inline bool inside_meets(const struct inside_view *view, int k, struct v3 direction)
{
	const float along = view->x[k] * direction.x + view->y[k] * direction.y +
			    view->z[k] * direction.z;

	return (along > 0) & (along * along > view->least[k]);
}

/* Returns a ball that a ray (unit direction) meets, or a number below 0. */
int inside_find(const struct inside_view *view, struct v3 direction);

enum presence { WITH_OBJECTS, WITHOUT_OBJECTS, PRESENCE_COUNT };
enum surface_kind { SURFACE_NONE, SURFACE_OBJECT, SURFACE_STANDIN, SURFACE_GROUND };

/* A point on a surface, as a ray has met it. */
struct surface {
	enum surface_kind kind;
	const struct mesh *mesh; /* NULL: the ground */
	struct v3 position;
	struct v3 normal;    /* the smoothed normal, on the side that the ray came from */
	struct v3 geometric; /* unit normal of the triangle, on that side */
	bool outer;	     /* that side is outside by the triangle's winding */
	float offset;	     /* distance from the surface at which leaving rays start */
	struct bsdf bsdf;
};

/* A sphere around all meshes of one version of the world; radius < 0: there are none. */
struct bounds {
	struct v3 centre;
	float radius;
};

/* Rays from one origin, laid out for Embree, which traces 16 at a time. Directions need not be
 * unit. */
#define WORLD_RAYS_MAX 32768
struct ray_batch {
	int count;
	float *x, *y, *z; /* [WORLD_RAYS_MAX] */
	uint8_t *blocked; /* [WORLD_RAYS_MAX]: the results, enum ray_result */
};

enum ray_result {
	RAY_FREE,
	RAY_BLOCKED,
	RAY_GLASS /* only glass is in the way of the straight ray: world_through_glass() */
};

/* The light from the sky that glass lets pass along a ray. Light that it mirrors is not
 * followed. */
struct passage {
	bool open;	   /* the ray leaves all glass towards the sky; else the rest is 0 */
	bool bent;	   /* some of the glass is no pane (bsdf_is_pane) */
	struct v3 sky;	   /* direction in which the ray leaves */
	struct rgb passed; /* share of the light that passes */
	float mirrored;	   /* share that is mirrored, without tints */
};

struct world;

int world_create(struct world **world, struct fault *fault);

/* Adds a mesh, which must outlive the world. If material is NULL, the mesh's own are used. */
int world_add(struct world *world, const struct mesh *mesh, const struct material *material,
	      enum surface_kind kind, struct fault *fault);

/* Sets the ground, a plane without texture. extent is its radius around the origin; 0: it is
 * infinite. */
void world_ground(struct world *world, const struct material *material, double extent);

/* Builds the ray tracer's structures, after all meshes and the ground. -ENOMEM, -EIO. */
int world_commit(struct world *world, struct fault *fault);

bool world_has_ground(const struct world *world);
bool world_has_standins(const struct world *world);
bool world_has_tinted_panes(const struct world *world); /* their shadows are coloured */
const struct bsdf *world_ground_bsdf(const struct world *world);
const struct inside *world_inside(const struct world *world); /* balls inside the objects */
struct bounds world_bounds(const struct world *world, enum presence presence);

/* Finds the nearest surface along a ray (unit direction), the ground included. Returns false if
 * there is none. */
bool world_nearest(const struct world *world, enum presence presence, struct v3 origin,
		   struct v3 direction, struct surface *surface);

/* Follows a ray through glass to a light above the ground at the distance far; INFINITY: to the
 * sky, for a ray that points upwards. The passage is open if only glass is in its straight way, and
 * the ray reaches that distance or the sky by passing it. */
struct passage world_passage(const struct world *world, enum presence presence, struct v3 origin,
			     struct v3 direction, float far);

/* Does the same for a ray that is known to have only glass in its straight way. */
struct passage world_through_glass(const struct world *world, enum presence presence,
				   struct v3 origin, struct v3 direction, float far);

/* Finds which rays of a batch meet a mesh. The ground does not count: batches hold only rays that
 * point upwards. */
void world_occluded(const struct world *world, enum presence presence, struct v3 origin,
		    struct ray_batch *batch);

/* Returns the start of a ray that leaves the surface: s->offset away from it, on the side of the
 * direction. */
static inline struct v3 surface_leave(const struct surface *s, struct v3 direction)
{
	const float side = v3_dot(s->geometric, direction) < 0 ? -s->offset : s->offset;

	return v3_mad(s->position, side, s->geometric);
}

void world_destroy(struct world *world);

int ray_batch_create(struct ray_batch *batch);
void ray_batch_free(struct ray_batch *batch);

#endif
