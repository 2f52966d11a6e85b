/* SPDX-License-Identifier: MIT */
/*
 * The lights of the sky: the upper nodes of a geodesic dome (thesis 2.2.1, figure 2.7).
 *
 * The dome is a regular icosahedron with a vertex at the zenith and one above azimuth 0; each face
 * is divided f times, by equal angles. Light i is a node at or above the horizon, and shines from
 * its spherical Voronoi cell: the part of the upper hemisphere that is nearer to it than to any
 * other light. Nodes below the horizon have no cells, so the cells cover the hemisphere: their
 * solid angles sum to 2 pi.
 *
 * The combinatorial position of a node on the icosahedron decides whether it lies on the horizon;
 * rounding does not. So the count depends only on f:
 *     5 f^2 + 1   f odd
 *     5 f^2 + 6   f even
 * that is 6, 26, 46, 86, 186, 406 for f = 1, 2, 3, 4, 6, 9.
 *
 * Order of lights: by row of the division from the zenith, then by azimuth from 0 to 2 pi. The
 * order must never change, because files refer to lights by index.
 *
 * Parts of the sky may be finer: cells of this base dome are divided into those of a dome of a
 * multiple of its frequency, whose nodes contain the base dome's. Lights are then all nodes of the
 * base dome in their order, followed by the further nodes of each finer frequency, ascending, in
 * the order of that dome. Cells are those of all these nodes.
 */
#ifndef INLAY_HAL_OPTICS_DOME_H
#define INLAY_HAL_OPTICS_DOME_H

#include <stdbool.h>

#include "hal/base/fault.h"

#define DOME_FREQUENCY_MAX 72
#define DOME_LIGHTS_MAX 32768  /* also in a basis file */
#define DOME_NODES_APART 0.003 /* least angle between two nodes, rad; at frequency 72 it is 0.012 */

struct dome_cells;  /* the outlines of the cells */
struct dome_lookup; /* finds the cell of a direction */

/* A round part of the sky in which lights are finer. */
struct dome_fine {
	double direction[3]; /* unit; z >= 0 */
	double radius_rad;   /* every cell of the base dome that the cap touches is divided */
	int frequency;	     /* a multiple of the base dome's */
};

struct dome {
	int frequency; /* of the base dome; 0: made of nodes that were given */
	int count;
	double (*direction)[3]; /* unit; z >= 0, exactly 0 on the horizon */
	double *solid_angle_sr; /* w_i; sum = 2 pi to 1e-12 */
	double *projected_sr;	/* integral of cos(theta) over the cell; sum = pi to 1e-12 */
	struct dome_cells *cells;
	struct dome_lookup *lookup;
};

/* Creates a dome. 0; -EINVAL: frequency outside 1..DOME_FREQUENCY_MAX; -ENOMEM. The dome is zeroed
 * on failure. */
int dome_create(struct dome *dome, int frequency, struct fault *fault);
/*
 * Creates a dome that has finer parts. Where they overlap, the finest counts. As above; -EINVAL:
 * part fine[*wrong] is below the horizon, or its frequency is no multiple of the base dome's or
 * above DOME_FREQUENCY_MAX. *wrong is -1 where no part is to blame.
 */
int dome_create_fine(struct dome *dome, int frequency, const struct dome_fine *fine, int count,
		     int *wrong, struct fault *fault);
/*
 * Creates a dome of given nodes, as a file lists them: node k is node[k * stride] and the two
 * numbers after it. frequency is for information: the base dome's; 0: unknown. -EINVAL: no node or
 * more than DOME_LIGHTS_MAX, a node that is not unit or is below the horizon, two that are less
 * than DOME_NODES_APART apart, or cells that reach 83 degrees or have 512 corners.
 */
int dome_create_nodes(struct dome *dome, const double *node, int stride, int count, int frequency,
		      struct fault *fault);
void dome_free(struct dome *dome); /* idempotent; zeroed is fine */

/* Whether there are other lights than those of a whole dome of its frequency. */
bool dome_is_fine(const struct dome *dome);

/* Polar angle from the zenith, 0..pi/2, and azimuth from +X towards +Y, -pi..pi. */
void dome_angles(const struct dome *dome, int light, double *theta_rad, double *phi_rad);

/* Radius of a cap around the node that holds the whole cell, rad. */
double dome_cell_reach_rad(const struct dome *dome, int light);

/* The light whose node is nearest (its cell holds dir): exactly the result of comparing the dot
 * products with all nodes; among equals the lowest index wins. -1 below the horizon (z < 0) and for
 * an invalid dir (zero, NaN, infinity). dir need not be unit. Constant time. */
int dome_cell_of(const struct dome *dome, const double dir[3]);

/* Draws a unit direction, uniform by solid angle in the cell, from two numbers in [0, 1). The
 * mapping is continuous except for cuts along the arcs from the node to the corners, so
 * low-discrepancy points stay so. */
void dome_cell_sample(const struct dome *dome, int light, double u, double v, double dir[3]);

/* Writes at most room corners of the cell, counter-clockwise seen from outside the dome. Returns
 * the number of all corners. */
int dome_cell_corners(const struct dome *dome, int light, double (*corner)[3], int room);

#endif
