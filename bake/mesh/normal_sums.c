/* SPDX-License-Identifier: MIT */
#include "bake/mesh/normal_sums.h"

#include <math.h>
#include <stdbool.h>

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

uint32_t normal_sums_begin(struct normal_box *boxes, struct weighted_normal *all, uint32_t count)
{
	return boxes_add(boxes, 0, all, 0, count);
}

/* Rounding keeps the order of products and of sums, so a box is judged as each normal in it would
 * be. */
struct v3 normal_sums_around(const struct normal_box *boxes, uint32_t box_count,
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
