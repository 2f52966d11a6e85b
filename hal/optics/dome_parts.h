/* SPDX-License-Identifier: MIT */
/* The parts of dome.c: nodes, their cells, tables that find them, and the triangles between
 * nodes. */
#ifndef INLAY_HAL_OPTICS_DOME_PARTS_H
#define INLAY_HAL_OPTICS_DOME_PARTS_H

#include <math.h>
#include <stdbool.h>

#include "hal/optics/dome.h"

/* The nodes of a geodesic dome at or above the horizon, in the order of lights (dome.h). */

/* Number of nodes; frequency in 1..DOME_FREQUENCY_MAX. */
int dome_node_count(int frequency);

/* Fills direction[dome_node_count()]. 0 or -ENOMEM. */
int dome_nodes_fill(int frequency, double (*direction)[3]);

/* Makes the nodes of a dome with finer parts (dome.h), which the caller frees. The parts are valid.
 * -ENOMEM. */
int dome_nodes_create(int frequency, const struct dome_fine *fine, int parts,
		      double (**direction)[3], int *count);

/* The spherical Voronoi cells of a dome's nodes: outlines and solid angles. */

struct dome_cells {
	int *first;	     /* [count + 1]: corners of cell i are first[i]..first[i + 1] - 1 */
	double (*corner)[3]; /* unit; counter-clockwise from outside; z exactly 0 on the horizon */
	double *cumulative_sr; /* [corner]: sum of the solid angles of the cell's triangles (node,
				  corner, next corner) up to and including this corner */
	double *radius;	       /* [count]: of the cap around the node that holds the cell, rad */
};

/* Creates the cells of count nodes (unit, z >= 0), whose mutual angle is roughly spacing_rad. 0 or
 * -ENOMEM. */
int dome_cells_create(struct dome_cells **cells, const double (*node)[3], int count,
		      double spacing_rad);
void dome_cells_destroy(struct dome_cells *cells); /* NULL is harmless */

/* Integral of the unit direction over cell i, sr. */
void dome_cells_moment(const struct dome_cells *cells, int i, double moment[3]);

/* Solid angle of the spherical triangle between three unit vectors; negative if clockwise. */
double dome_triangle_sr(const double a[3], const double b[3], const double c[3]);

/*
 * Maps the upper hemisphere to a square, for grids: the octahedral projection
 *     (u, v) = (x, y) / (|x| + |y| + z)
 * The horizon is the diamond |u| + |v| = 1. Within a quadrant it is a central projection onto a
 * plane, so straight lines are great circles. The distance of two directions on the square is at
 * most sqrt(3) times their angle.
 */

#define DOME_MAP_STRETCH 1.7320508075688774

/* Maps dir, z >= 0. False for an invalid dir: zero, NaN, infinity. */
static inline bool dome_map(const double dir[3], double uv[2])
{
	const double sum = fabs(dir[0]) + fabs(dir[1]) + dir[2];

	uv[0] = dir[0] / sum;
	uv[1] = dir[1] / sum;
	return sum > 0 && sum < INFINITY;
}

/* Row or column of a grid of side x side cells over -1..1. */
static inline int dome_map_cell(double u, int side)
{
	const double at = floor((u + 1) * (0.5 * side));

	return at < 0 ? 0 : at >= side ? side - 1 : (int)at;
}

/* Finds what lies in a direction, such as the nearest node, in constant time: a grid over the
 * hemisphere lists the candidates in each grid cell. */

/* Creates a lookup of count items; item i lies in a cap of radius[i] (rad) around centre[i] (unit,
 * z >= 0). 0 or -ENOMEM. */
int dome_lookup_create(struct dome_lookup **lookup, const double *radius, const double (*centre)[3],
		       int count);
void dome_lookup_destroy(struct dome_lookup *lookup); /* NULL is harmless */

/* All items whose cap holds dir, and some more, in ascending order. None below the horizon and for
 * an invalid dir. */
const int *dome_lookup_candidates(const struct dome_lookup *lookup, const double dir[3],
				  int *count);

/* The item whose centre is nearest to dir; node: the centres given at creation. -1: none. */
int dome_lookup_find(const struct dome_lookup *lookup, const double (*node)[3],
		     const double dir[3]);

/* The flat triangles between a dome's nodes, and from its rim to the horizon (dome_facets.c). */

struct dome_triangles {
	int vertices; /* the nodes, then the feet of some of them */
	double (*vertex)[3];
	int *owner;	  /* the vertex's node: itself, or the node that it is the foot of */
	int count, room;  /* of triangles */
	int (*corner)[3]; /* vertices of each triangle, counter-clockwise from outside */
};

/* 0 or -ENOMEM. The caller frees the triangles, after a failure too. */
int dome_triangles_create(struct dome_triangles *triangles, const struct dome_cells *cells,
			  const struct dome_lookup *lookup, const double (*node)[3], int count);
void dome_triangles_free(struct dome_triangles *triangles); /* idempotent */

/*
 * Weights of a direction between the nodes around it, which are continuous and sum to 1: the
 * barycentric ones in the flat triangle (facet) that its ray meets.
 *
 * The facets are those of the nodes' convex hull that face upwards, the dual of the cells. The
 * lowest nodes may lie above the horizon; there, triangles between the hull's rim and the horizon
 * close the gap. Their lower corners are the feet, the points of the horizon straight below the
 * rim's nodes. A foot belongs to its node, so two nodes share each direction below the rim.
 */

struct dome_facets;

/* Creates the facets of count nodes from their cells and the lookup of these cells. 0; -ENOMEM;
 * -EINVAL: the triangles do not cover the hemisphere. */
int dome_facets_create(struct dome_facets **facets, const struct dome_cells *cells,
		       const struct dome_lookup *lookup, const double (*node)[3], int count);
void dome_facets_destroy(struct dome_facets *facets); /* NULL is harmless */

/* Lists the nodes with a weight > 0 in a direction; returns their number, 1 to 3; 0 below the
 * horizon (z < 0) and for an invalid dir (zero, NaN, infinity). dir need not be unit. It is fast
 * where dir is in a facet around that node. *facet is tried first, and becomes the facet that was
 * found; -1: none is known. */
int dome_facets_weights(const struct dome_facets *facets, int node, int *facet, const double dir[3],
			int to[3], double weight[3]);

#endif
