/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "bake/base/vec3.h"

#define NONE UINT32_MAX
#define FEW 32		   /* corners of a place: up to here all pairs of them are compared */
#define CREASE_SLACK 1e-5f /* rounding error between triangles of one plane */

/*
 * Sums of unit normals around directions. Boxes around normals, halved again and again, let a box
 * that lies wholly on one side of the bound count as one: n sums around n directions take about n
 * log n where the normals lie on a line, as those of a cone do, and n^1.5 where they fill the
 * sphere.
 */

struct weighted_normal {
	struct v3 normal;
	float weight;
};

struct normal_box {
	struct v3 low, high, sum;
	uint32_t from, to; /* normals in it */
	uint32_t next;	   /* the box after all boxes in it */
};

#define LEAF 8

static float axis_of(struct v3 v, int axis)
{
	return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static struct normal_box box_around(const struct weighted_normal *all, uint32_t from, uint32_t to)
{
	struct normal_box box = {.low = {INFINITY, INFINITY, INFINITY},
				 .high = {-INFINITY, -INFINITY, -INFINITY},
				 .from = from,
				 .to = to};

	for (uint32_t k = from; k < to; k++) {
		const struct v3 n = all[k].normal;

		box.low = v3_make(fminf(box.low.x, n.x), fminf(box.low.y, n.y),
				  fminf(box.low.z, n.z));
		box.high = v3_make(fmaxf(box.high.x, n.x), fmaxf(box.high.y, n.y),
				   fmaxf(box.high.z, n.z));
		box.sum = v3_mad(box.sum, all[k].weight, n);
	}
	return box;
}

/* Puts the normals of the lower half of a box before those of the upper half. Returns where these
 * begin. */
static uint32_t box_split(const struct normal_box *box, struct weighted_normal *all)
{
	const struct v3 size = v3_sub(box->high, box->low);
	const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
	const float low = axis_of(box->low, axis), high = axis_of(box->high, axis);
	const float half = low / 2 + high / 2 < high ? low / 2 + high / 2 : low;
	uint32_t upper = box->from;

	if (!(low < high))
		return box->to;
	for (uint32_t k = box->from; k < box->to; k++) {
		const struct weighted_normal n = all[k];

		if (axis_of(n.normal, axis) <= half) {
			all[k] = all[upper];
			all[upper++] = n;
		}
	}
	return upper;
}

/* Adds the boxes of a range, a box before those in it. The depth is bounded: each axis can be
 * halved as often as a float has values. */
static uint32_t boxes_add(struct normal_box *boxes, uint32_t at, struct weighted_normal *all,
			  uint32_t from, uint32_t to)
{
	uint32_t upper, next = at + 1;

	boxes[at] = box_around(all, from, to);
	upper = to - from > LEAF ? box_split(&boxes[at], all) : to;
	if (upper > from && upper < to) {
		next = boxes_add(boxes, next, all, from, upper);
		next = boxes_add(boxes, next, all, upper, to);
	}
	return boxes[at].next = next;
}

/* boxes: room for 2 count - 1. Reorders the normals. Returns how many boxes there are. */
static uint32_t normal_sums_begin(struct normal_box *boxes, struct weighted_normal *all,
				  uint32_t count)
{
	return boxes_add(boxes, 0, all, 0, count);
}

/* Sum of weight * normal over those whose cosine to a direction is at least a bound. */
static struct v3 normal_sums_around(const struct normal_box *boxes, uint32_t box_count,
				    const struct weighted_normal *all, struct v3 d, float bound)
{
	struct v3 sum = {0, 0, 0};

	for (uint32_t b = 0; b < box_count;) {
		const struct normal_box *box = &boxes[b];
		const struct v3 low = box->low, high = box->high;
		const struct v3 near = v3_make(d.x > 0 ? high.x : low.x, d.y > 0 ? high.y : low.y,
					       d.z > 0 ? high.z : low.z);
		const struct v3 far = v3_make(d.x > 0 ? low.x : high.x, d.y > 0 ? low.y : high.y,
					      d.z > 0 ? low.z : high.z);
		const bool leaf = box->next == b + 1;

		if (!(v3_dot(d, near) >= bound)) { /* also where a direction is none */
			b = box->next;
		} else if (v3_dot(d, far) >= bound) {
			sum = v3_add(sum, box->sum);
			b = box->next;
		} else {
			for (uint32_t k = box->from; k < box->to && leaf; k++)
				if (v3_dot(d, all[k].normal) >= bound)
					sum = v3_mad(sum, all[k].weight, all[k].normal);
			b++;
		}
	}
	return sum;
}

/* A vertex by its position, for sorting. */
struct vertex_place {
	float p[3];
	uint32_t vertex;
};

/*
 * State of mesh_smooth(). Corner k of triangle t has the number 3 t + k. A place is a position that
 * one or more old vertices share. Each old vertex becomes one or more new ones.
 */
struct smoother {
	struct mesh_part *part;
	size_t corners;
	uint32_t places;
	float cos_crease;
	struct v3 *face;   /* [triangles]: unit normal */
	float *angle;	   /* [corners], in rad */
	uint32_t *at;	   /* [old vertices]: place */
	uint32_t *first;   /* [places + 1]: where the corners of a place begin in list */
	uint32_t *list;	   /* [corners], sorted by place */
	struct v3 *smooth; /* [corners] */
	uint32_t *slot;	   /* [slots]: new vertices by old vertex and normal; NONE: empty */
	size_t slots;	   /* a power of two, at least twice as many as there can be new vertices */
	uint32_t *source;  /* [new vertices]: the old vertex */
	struct v3 *normal; /* [new vertices] */
	uint32_t made;	   /* new vertices so far */
};

static struct v3 corner_at(const struct mesh_part *part, size_t corner)
{
	const float *p = part->position[part->index[corner / 3][corner % 3]];

	return v3_make(p[0], p[1], p[2]);
}

/* Makes edges unit before multiplying them: the product of tiny ones would underflow. */
static void measure_triangles(struct smoother *s)
{
	for (size_t t = 0; t < s->corners / 3; t++) {
		for (size_t k = 0; k < 3; k++) {
			const struct v3 here = corner_at(s->part, 3 * t + k);
			const struct v3 a =
				v3_unit(v3_sub(corner_at(s->part, 3 * t + (k + 1) % 3), here));
			const struct v3 b =
				v3_unit(v3_sub(corner_at(s->part, 3 * t + (k + 2) % 3), here));
			const struct v3 across = v3_cross(a, b);

			s->angle[3 * t + k] = atan2f(v3_length(across), v3_dot(a, b));
			if (k == 0)
				s->face[t] = v3_unit(across);
		}
	}
}

static int compare_places(const void *a, const void *b)
{
	const struct vertex_place *p = a, *q = b;

	for (int axis = 0; axis < 3; axis++)
		if (p->p[axis] != q->p[axis])
			return p->p[axis] < q->p[axis] ? -1 : 1;
	return (p->vertex > q->vertex) - (p->vertex < q->vertex);
}

/* Numbers the places. Several vertices share one when they differ in texture coordinates, or when
 * the file has them twice. */
static int find_places(struct smoother *s)
{
	const size_t vertices = (size_t)s->part->vertices;
	struct vertex_place *all = malloc((vertices + 1) * sizeof(*all));

	if (!all)
		return -ENOMEM;
	for (size_t v = 0; v < vertices; v++) {
		memcpy(all[v].p, s->part->position[v], sizeof(all[v].p));
		all[v].vertex = (uint32_t)v;
	}
	qsort(all, vertices, sizeof(*all), compare_places);
	s->places = 0;
	for (size_t v = 0; v < vertices; v++) {
		s->places += v > 0 &&
			     (all[v].p[0] != all[v - 1].p[0] || all[v].p[1] != all[v - 1].p[1] ||
			      all[v].p[2] != all[v - 1].p[2]);
		s->at[all[v].vertex] = s->places;
	}
	s->places++;
	free(all);
	return 0;
}

static uint32_t corner_place(const struct smoother *s, size_t corner)
{
	return s->at[s->part->index[corner / 3][corner % 3]];
}

static int list_corners(struct smoother *s)
{
	const int err = find_places(s);

	if (err)
		return err;
	s->first = calloc((size_t)s->places + 2, sizeof(*s->first));
	if (!s->first)
		return -ENOMEM;
	/* Counts are kept two places on: filling then moves first[p + 1] from the start of p's
	 * list to its end. */
	for (size_t c = 0; c < s->corners; c++)
		s->first[corner_place(s, c) + 2]++;
	for (uint32_t p = 2; p < s->places + 2; p++)
		s->first[p] += s->first[p - 1];
	for (size_t c = 0; c < s->corners; c++)
		s->list[s->first[corner_place(s, c) + 1]++] = (uint32_t)c;
	return 0;
}

/* The sum vanishes where a crease of 180 degrees smooths opposite sides of a sheet. */
static struct v3 normal_of_sum(struct v3 sum, struct v3 own)
{
	return v3_length(sum) > CREASE_SLACK ? v3_unit(sum) : own;
}

static void smooth_few(struct smoother *s, const uint32_t *list, uint32_t count)
{
	for (uint32_t c = 0; c < count; c++) {
		const struct v3 own = s->face[list[c] / 3];
		struct v3 sum = {0, 0, 0};

		for (uint32_t k = 0; k < count; k++) {
			const struct v3 other = s->face[list[k] / 3];

			if (v3_dot(own, other) >= s->cos_crease - CREASE_SLACK)
				sum = v3_mad(sum, s->angle[list[k]], other);
		}
		s->smooth[list[c]] = normal_of_sum(sum, own);
	}
}

static int smooth_many(struct smoother *s, const uint32_t *list, uint32_t count)
{
	struct weighted_normal *all = malloc(count * sizeof(*all));
	struct normal_box *boxes = malloc(2 * (size_t)count * sizeof(*boxes));
	const int err = all && boxes ? 0 : -ENOMEM;
	uint32_t box_count;

	if (!err) {
		for (uint32_t c = 0; c < count; c++)
			all[c] = (struct weighted_normal){s->face[list[c] / 3], s->angle[list[c]]};
		box_count = normal_sums_begin(boxes, all, count);
		for (uint32_t c = 0; c < count; c++) {
			const struct v3 own = s->face[list[c] / 3];
			const struct v3 sum = normal_sums_around(boxes, box_count, all, own,
								 s->cos_crease - CREASE_SLACK);

			s->smooth[list[c]] = normal_of_sum(sum, own);
		}
	}
	free(all);
	free(boxes);
	return err;
}

/* Computes the normals of all corners, place by place. */
static int smooth_corners(struct smoother *s)
{
	int err = 0;

	for (uint32_t p = 0; p < s->places && !err; p++) {
		const uint32_t *list = s->list + s->first[p];
		const uint32_t count = s->first[p + 1] - s->first[p];

		if (count > FEW)
			err = smooth_many(s, list, count);
		else
			smooth_few(s, list, count);
	}
	return err;
}

/* Returns the new vertex of an old one that has this normal, made when there is none. */
static uint32_t vertex_with(struct smoother *s, uint32_t vertex, struct v3 normal)
{
	size_t k = XXH3_64bits_withSeed(&normal, sizeof(normal), vertex) & (s->slots - 1);
	uint32_t v;

	while ((v = s->slot[k]) != NONE &&
	       (s->source[v] != vertex || memcmp(&s->normal[v], &normal, sizeof(normal)) != 0))
		k = (k + 1) & (s->slots - 1);
	if (v != NONE)
		return v;
	v = s->slot[k] = s->made++;
	s->source[v] = vertex;
	s->normal[v] = normal;
	return v;
}

/* Gives each new vertex the value of the old one that it is made of. Returns NULL, too, where the
 * part has no such values. */
static void *values_of_made(const struct smoother *s, const void *values, size_t size)
{
	char *made = values ? calloc((size_t)s->made + 1, size) : NULL;

	for (size_t v = 0; v < s->made && made; v++)
		memcpy(made + v * size, (const char *)values + s->source[v] * size, size);
	return made;
}

/* Replaces the part's arrays by those of the new vertices. */
static int replace_vertices(struct smoother *s)
{
	struct mesh_part *part = s->part;
	float(*position)[4] = values_of_made(s, part->position, sizeof(*position));
	float(*uv)[2] = values_of_made(s, part->uv, sizeof(*uv));
	float(*uv2)[2] = values_of_made(s, part->uv2, sizeof(*uv2));
	float(*colour)[4] = values_of_made(s, part->colour, sizeof(*colour));

	if (!position || (part->uv && !uv) || (part->uv2 && !uv2) || (part->colour && !colour)) {
		free(position);
		free(uv);
		free(uv2);
		free(colour);
		return -ENOMEM;
	}
	free(part->position);
	free(part->uv);
	free(part->uv2);
	free(part->colour);
	free(part->normal);
	part->position = position;
	part->uv = uv;
	part->uv2 = uv2;
	part->colour = colour;
	part->normal = s->normal;
	part->vertices = (int)s->made;
	s->normal = NULL;
	return 0;
}

static int split_vertices(struct smoother *s)
{
	uint32_t *became = malloc((s->corners + 1) * sizeof(*became));
	int err;

	if (!became)
		return -ENOMEM;
	memset(s->slot, 0xff, s->slots * sizeof(*s->slot));
	for (size_t c = 0; c < s->corners; c++)
		became[c] = vertex_with(s, s->part->index[c / 3][c % 3], s->smooth[c]);
	err = replace_vertices(s);
	for (size_t c = 0; c < s->corners && !err; c++)
		s->part->index[c / 3][c % 3] = became[c];
	free(became);
	return err;
}

static void *smoother_room(size_t count, size_t size)
{
	return malloc((count + 1) * size);
}

int mesh_smooth(struct mesh_part *part, double crease_deg)
{
	const size_t triangles = (size_t)part->triangles, vertices = (size_t)part->vertices;
	struct smoother s = {
		.part = part,
		.corners = 3 * triangles,
		.cos_crease = (float)cos(crease_deg * (M_PI / 180)),
		.face = smoother_room(triangles, sizeof(*s.face)),
		.angle = smoother_room(3 * triangles, sizeof(*s.angle)),
		.at = smoother_room(vertices, sizeof(*s.at)),
		.list = smoother_room(3 * triangles, sizeof(*s.list)),
		.smooth = smoother_room(3 * triangles, sizeof(*s.smooth)),
		.slots = 64,
		.source = smoother_room(3 * triangles, sizeof(*s.source)),
		.normal = smoother_room(3 * triangles, sizeof(*s.normal)),
	};
	int err;

	while (s.slots < 6 * triangles)
		s.slots *= 2;
	s.slot = smoother_room(s.slots, sizeof(*s.slot));
	err = s.face && s.angle && s.at && s.list && s.smooth && s.slot && s.source && s.normal
		      ? 0
		      : -ENOMEM;
	if (!err) {
		measure_triangles(&s);
		err = list_corners(&s);
	}
	if (!err)
		err = smooth_corners(&s);
	if (!err)
		err = split_vertices(&s);
	free(s.face);
	free(s.angle);
	free(s.at);
	free(s.first);
	free(s.list);
	free(s.smooth);
	free(s.slot);
	free(s.source);
	free(s.normal);
	return err;
}
