/* SPDX-License-Identifier: MIT */
/* From a solid's function to a closed mesh of triangles. */
#ifndef INLAY_BAKE_DEMO_POLYGONISE_H
#define INLAY_BAKE_DEMO_POLYGONISE_H

#include "bake/demo/implicit.h"

struct trimesh {
	int vertex_count, triangle_count;
	double (*position)[3];
	double (*normal)[3]; /* unit, outward: the function's gradient, not the triangles' */
	int (*triangle)[3];  /* anti-clockwise seen from outside */
};

struct solid {
	struct implicit (*at)(const void *context, const double p[3]);
	const void *context;
	double low[3], high[3]; /* a box that holds all of it */
};

/*
 * Surface nets: one vertex in each cell of a grid that the surface crosses, one pair of triangles
 * across each crossed grid edge; then the vertices are spread evenly over the surface. Features
 * thinner than two steps may be lost or come out pinched. -ENOMEM.
 */
int polygonise(struct trimesh *mesh, const struct solid *solid, double step);

void trimesh_free(struct trimesh *mesh); /* idempotent; zeroed is fine */

#endif
