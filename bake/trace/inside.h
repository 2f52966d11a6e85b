/* SPDX-License-Identifier: MIT */
/*
 * Balls inside closed objects. No triangle of its object reaches into a ball, and every way out of
 * it crosses one, so that a ray that meets a ball is blocked, wherever it starts. This takes a
 * tenth of the time that Embree needs to find a triangle in the ray's way.
 */
#ifndef INLAY_BAKE_TRACE_INSIDE_H
#define INLAY_BAKE_TRACE_INSIDE_H

#include <stdbool.h>

#include "bake/mesh/mesh.h"

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

#endif
