/* SPDX-License-Identifier: MIT */
/*
 * Sums of unit normals around directions. Boxes around normals, halved again and again, let a box
 * that lies wholly on one side of the bound count as one: n sums around n directions take about n
 * log n where the normals lie on a line, as those of a cone do, and n^1.5 where they fill the
 * sphere.
 */
#ifndef INLAY_BAKE_MESH_NORMAL_SUMS_H
#define INLAY_BAKE_MESH_NORMAL_SUMS_H

#include <stdint.h>

#include "bake/base/vec3.h"

struct weighted_normal {
	struct v3 normal;
	float weight;
};

struct normal_box {
	struct v3 low, high, sum;
	uint32_t from, to; /* normals in it */
	uint32_t next;	   /* the box after all boxes in it */
};

/* boxes: room for 2 count - 1. Reorders the normals. Returns how many boxes there are. */
uint32_t normal_sums_begin(struct normal_box *boxes, struct weighted_normal *all, uint32_t count);

/* Sum of weight * normal over those whose cosine to a direction is at least a bound. */
struct v3 normal_sums_around(const struct normal_box *boxes, uint32_t box_count,
			     const struct weighted_normal *all, struct v3 direction, float bound);

#endif
