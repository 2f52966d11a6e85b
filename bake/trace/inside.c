/* SPDX-License-Identifier: MIT */
#include "bake/trace/world.h"

#include <stdlib.h>

#include "bake/mesh/mesh_winding.h"

#define CANDIDATES 512 /* number of chords that are tried; chosen by trial */
/* Balls are made smaller by this factor, and count only for rays from less than FAR radii away, so
 * that rounding does not matter. */
#define SHRINK 0.98f
#define FAR 100.0f
#define OUTSIDE_MAX 8 /* after this many candidates outside the object the others are not tried */
/* A ball is left out if its centre is nearer to that of a larger ball than this share of the
 * larger one's radius. */
#define CENTRES_APART 0.6f

struct candidate {
	struct v3 centre;
	float radius;
};

/* ---- distances ---- */

/* Returns the squared distance from the origin to a segment. */
static float segment_distance2(struct v3 a, struct v3 b)
{
	const struct v3 along = v3_sub(b, a);
	const float length2 = v3_dot(along, along);
	const float s = length2 > 0 ? -v3_dot(a, along) / length2 : 0;
	const struct v3 near = v3_mad(a, fminf(fmaxf(s, 0), 1), along);

	return v3_dot(near, near);
}

/* Returns the squared distance from the origin to a triangle. */
static float triangle_distance2(struct v3 a, struct v3 b, struct v3 c)
{
	const struct v3 n = v3_cross(v3_sub(b, a), v3_sub(c, a));
	const float away = v3_dot(a, n), n2 = v3_dot(n, n);

	if (n2 > 0 && v3_dot(v3_cross(a, b), n) >= 0 && v3_dot(v3_cross(b, c), n) >= 0 &&
	    v3_dot(v3_cross(c, a), n) >= 0)
		return away * away / n2;
	return fminf(segment_distance2(a, b),
		     fminf(segment_distance2(b, c), segment_distance2(c, a)));
}

/* All triangles of an object, with balls around them. */
struct triangles {
	int64_t count;
	struct triangle {
		struct v3 corner[3], middle;
		float radius; /* around middle */
	} * at;
};

static bool triangles_make(struct triangles *all, const struct mesh_part *parts, int count)
{
	int64_t n = 0;

	for (int p = 0; p < count; p++)
		n += parts[p].triangles;
	*all = (struct triangles){.count = n, .at = malloc(((size_t)n + 1) * sizeof(*all->at))};
	if (!all->at)
		return false;
	n = 0;
	for (int p = 0; p < count; p++)
		for (int t = 0; t < parts[p].triangles; t++) {
			struct triangle *to = &all->at[n++];

			for (int k = 0; k < 3; k++)
				to->corner[k] = mesh_corner(&parts[p], t, k);
			to->middle = v3_scale(
				v3_add(to->corner[0], v3_add(to->corner[1], to->corner[2])),
				1.0f / 3);
			to->radius = 0;
			for (int k = 0; k < 3; k++)
				to->radius = fmaxf(to->radius,
						   v3_length(v3_sub(to->corner[k], to->middle)));
		}
	return true;
}

/* Returns the distance from a point to the nearest triangle, or `most` if that is less. */
static float triangles_distance(const struct triangles *all, struct v3 from, float most)
{
	float least = most;

	for (int64_t k = 0; k < all->count; k++) {
		const struct triangle *t = &all->at[k];
		const struct v3 to = v3_sub(t->middle, from);
		const float near = least + t->radius;

		if (v3_dot(to, to) < near * near)
			least = fminf(least, sqrtf(triangle_distance2(v3_sub(t->corner[0], from),
								      v3_sub(t->corner[1], from),
								      v3_sub(t->corner[2], from))));
	}
	return least;
}

/*
 * Returns the winding number of a closed surface around a point, from the solid angles of its
 * triangles (van Oosterom and Strackee 1983). If it is not 0, every way from there to infinity
 * crosses the surface.
 */
static int winding_number(const struct triangles *all, struct v3 from)
{
	double sum = 0;

	for (int64_t k = 0; k < all->count; k++) {
		const struct v3 a = v3_sub(all->at[k].corner[0], from);
		const struct v3 b = v3_sub(all->at[k].corner[1], from);
		const struct v3 c = v3_sub(all->at[k].corner[2], from);
		const float la = v3_length(a), lb = v3_length(b), lc = v3_length(c);

		sum += (double)atan2f(v3_dot(a, v3_cross(b, c)), la * lb * lc + v3_dot(a, b) * lc +
									 v3_dot(b, c) * la +
									 v3_dot(c, a) * lb);
	}
	return (int)lround(sum / (2 * M_PI));
}

/* ---- balls ---- */

/* Chords start inside the middles of triangles whose numbers are evenly spaced. */
static int find_candidates(const struct triangles *all, inside_chord chord, const void *context,
			   struct candidate found[CANDIDATES])
{
	const int64_t wanted = all->count < CANDIDATES ? all->count : CANDIDATES;
	int n = 0;

	for (int64_t k = 0; k < wanted; k++) {
		const struct triangle *t = &all->at[k * all->count / wanted];
		const struct v3 in = v3_unit(v3_cross(v3_sub(t->corner[2], t->corner[0]),
						      v3_sub(t->corner[1], t->corner[0])));
		const struct v3 from = v3_mad(t->middle, 1e-3f * t->radius, in);
		float length;

		if (v3_dot(in, in) < 0.5f || !chord(context, from, in, &length))
			continue;
		found[n].centre = v3_mad(from, length / 2, in);
		found[n].radius = triangles_distance(all, found[n].centre, length);
		n++;
	}
	return n;
}

static int compare_candidates(const void *a, const void *b)
{
	const float left = ((const struct candidate *)a)->radius,
		    right = ((const struct candidate *)b)->radius;

	return (left < right) - (left > right);
}

/* Returns the least of distance / radius over the object's balls so far, and tells whether one of
 * them overlaps the candidate. */
static float nearest_ball(const struct inside *inside, int first, const struct candidate *c,
			  bool *overlaps)
{
	float nearest = INFINITY;

	*overlaps = false;
	for (int k = first; k < inside->count; k++) {
		const float radius = sqrtf(inside->radius2[k]);
		const float distance = v3_length(
			v3_sub(c->centre, v3_make(inside->x[k], inside->y[k], inside->z[k])));

		nearest = fminf(nearest, distance / radius);
		*overlaps |= distance < radius + c->radius;
	}
	return nearest;
}

/* Adds candidates, the largest first, except where a larger ball is near. Two balls that overlap
 * have the same winding number, as no triangle separates them. */
static void add_balls(struct inside *inside, const struct triangles *all, int most,
		      const struct candidate *found, int count)
{
	const int first = inside->count;
	int outside = 0;

	for (int k = 0; k < count && inside->count < INSIDE_MAX && inside->count - first < most &&
			outside < OUTSIDE_MAX;
	     k++) {
		const struct candidate c = {found[k].centre, found[k].radius * SHRINK};
		bool overlaps;

		if (nearest_ball(inside, first, &c, &overlaps) < CENTRES_APART)
			continue;
		if (!overlaps && !winding_number(all, c.centre)) {
			outside++;
			continue;
		}
		inside->x[inside->count] = c.centre.x;
		inside->y[inside->count] = c.centre.y;
		inside->z[inside->count] = c.centre.z;
		inside->radius2[inside->count++] = c.radius * c.radius;
	}
}

void inside_add(struct inside *inside, const struct mesh_part *parts, int count, int most,
		inside_chord chord, const void *context)
{
	struct candidate found[CANDIDATES];
	struct triangles all;
	int n;

	if (!mesh_is_closed(parts, count) || !triangles_make(&all, parts, count))
		return;
	n = find_candidates(&all, chord, context, found);
	qsort(found, (size_t)n, sizeof(*found), compare_candidates);
	add_balls(inside, &all, most, found, n);
	free(all.at);
}

void inside_see(const struct inside *inside, struct v3 from, struct inside_view *view)
{
	for (int k = 0; k < INSIDE_MAX; k++) {
		const float x = inside->x[k] - from.x, y = inside->y[k] - from.y,
			    z = inside->z[k] - from.z, r2 = inside->radius2[k];
		const float to2 = x * x + y * y + z * z;

		view->x[k] = x;
		view->y[k] = y;
		view->z[k] = z;
		view->least[k] = to2 < FAR * FAR * r2 ? to2 - r2 : INFINITY;
	}
}

int inside_find(const struct inside_view *view, struct v3 direction)
{
	int found = -1;

	for (int k = 0; k < INSIDE_MAX; k++)
		found = inside_meets(view, k, direction) ? k : found;
	return found;
}
