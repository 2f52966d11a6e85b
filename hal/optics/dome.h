/* SPDX-License-Identifier: MIT */
/*
 * The lights of the sky: the upper nodes of a geodesic dome (thesis 2.2.1, figure 2.7), each with a
 * weight over the upper hemisphere. The weights of any direction sum to 1.
 *
 * The dome is a regular icosahedron with a vertex at the zenith and one above azimuth 0; each face
 * is divided f times, by equal angles (the thesis) or equal chords. Light i is a node at or above
 * the horizon. Its shape is one of
 *   cell  weight 1 in its spherical Voronoi cell: the part of the upper hemisphere that is nearer
 *         to it than to any other light; 0 elsewhere;
 *   tent  weight 1 at its node, 0 at all other nodes, linear over the flat triangles between nodes
 *         that a direction's ray meets; continuous everywhere. Below the lowest nodes, the two
 *         nodes beside a direction share it (dome_tents.h).
 * Nodes below the horizon have no cells, so the lights cover the hemisphere: their solid angles,
 * the integrals of their weights, sum to 2 pi.
 *
 * The combinatorial position of a node on the icosahedron decides whether it lies on the horizon;
 * rounding does not. So the count depends only on f and the division:
 *     5 f^2 + 1            f odd
 *     5 f^2 + 6            f even, by angles
 *     5 f^2 + 1 + 5 f / 2  f even, by chords
 * that is 6, 26, 46, 86, 186, 406 for f = 1, 2, 3, 4, 6, 9 by angles (6, 26, 46, 91, 196, 406 by
 * chords).
 *
 * Order of lights: by row of the division from the zenith, then by azimuth from 0 to 2 pi. The
 * order must never change, because files refer to lights by index.
 *
 * Parts of the sky may be finer: cells of this base dome are divided into those of a dome of a
 * multiple of its frequency, whose nodes contain the base dome's. Lights are then all nodes of the
 * base dome in their order, followed by the further nodes of each finer frequency, ascending, in
 * the order of that dome. Cells and tents are those of all these nodes.
 */
#ifndef INLAY_HAL_OPTICS_DOME_H
#define INLAY_HAL_OPTICS_DOME_H

#include <stdbool.h>

#include "hal/base/fault.h"

#define DOME_FREQUENCY_MAX 72
#define DOME_LIGHTS_MAX 32768  /* also in a basis file */
#define DOME_NODES_APART 0.003 /* least angle between two nodes, rad; at frequency 72 it is 0.012 */

enum dome_division { DOME_ANGLES, DOME_CHORDS, DOME_DIVISION_COUNT };

extern const char *const dome_division_names[]; /* "angles", "chords", NULL */

enum dome_shape { DOME_CELLS, DOME_TENTS, DOME_SHAPE_COUNT };

extern const char *const dome_shape_names[]; /* "cells", "tents", NULL */

struct dome_cells;  /* the outlines of the cells */
struct dome_lookup; /* finds the cell of a direction */
struct dome_tents;  /* the triangles between the nodes */

/* A round part of the sky in which lights are finer. */
struct dome_fine {
	double direction[3]; /* unit; z >= 0 */
	double radius_rad;   /* every cell of the base dome that the cap touches is divided */
	int frequency;	     /* a multiple of the base dome's */
};

struct dome {
	int frequency; /* of the base dome; 0: made of nodes that were given */
	enum dome_division division;
	enum dome_shape shape;
	int count;
	double (*direction)[3]; /* unit; z >= 0, exactly 0 on the horizon */
	double *solid_angle_sr; /* w_i; sum = 2 pi to 1e-12 */
	double *projected_sr;	/* integral of weight * cos(theta); sum = pi to 1e-12 */
	struct dome_cells *cells;
	struct dome_lookup *lookup;
	struct dome_tents *tents; /* NULL if the shape is cells */
};

/* Creates a dome of a shape. 0; -EINVAL: frequency outside 1..DOME_FREQUENCY_MAX, unknown division
 * or shape; -ENOMEM. The dome is zeroed on failure. */
int dome_create_shaped(struct dome *dome, int frequency, enum dome_division division,
		       enum dome_shape shape, struct fault *fault);
/*
 * Creates a dome that has finer parts. Where they overlap, the finest counts. As above; -EINVAL:
 * part fine[*wrong] is below the horizon, or its frequency is no multiple of the base dome's or
 * above DOME_FREQUENCY_MAX. *wrong is -1 where no part is to blame.
 */
int dome_create_fine(struct dome *dome, int frequency, enum dome_division division,
		     enum dome_shape shape, const struct dome_fine *fine, int count, int *wrong,
		     struct fault *fault);
/*
 * Creates a dome of given nodes, as a file lists them: node k is node[k * stride] and the two
 * numbers after it. frequency and division are for information: the base dome's; frequency 0:
 * unknown. -EINVAL: no node or more than DOME_LIGHTS_MAX, a node that is not unit or is below the
 * horizon, two that are less than DOME_NODES_APART apart, or cells that reach 83 degrees or have
 * 512 corners.
 */
int dome_create_nodes(struct dome *dome, const double *node, int stride, int count, int frequency,
		      enum dome_division division, enum dome_shape shape, struct fault *fault);
/* Creates a dome whose lights are cells. */
int dome_create(struct dome *dome, int frequency, enum dome_division division, struct fault *fault);
void dome_free(struct dome *dome); /* idempotent; zeroed is fine */

/* Whether there are other lights than those of a whole dome of its frequency. */
bool dome_is_fine(const struct dome *dome);

/* Polar angle from the zenith, 0..pi/2, and azimuth from +X towards +Y, -pi..pi. */
void dome_angles(const struct dome *dome, int light, double *theta_rad, double *phi_rad);

/* Lists the lights with a weight > 0 in a direction; the weights sum to 1. Returns their number, 1
 * to 3; 0 below the horizon (z < 0) and for an invalid dir (zero, NaN, infinity). dir need not be
 * unit. Constant time, about 20 ns for cells, 90 ns for tents. */
int dome_weights(const struct dome *dome, const double dir[3], int light[3], double weight[3]);

/* The weight of one light in a direction, 0..1. */
double dome_weight(const struct dome *dome, int light, const double dir[3]);

/*
 * Draws a unit direction of a light from two numbers in [0, 1). The mapping is continuous except
 * for a few cuts, so low-discrepancy points stay so. In a cell: uniform by solid angle. In a tent:
 * with the light's weight as density on the flat triangles; weight / density, the solid angle on
 * average, then varies little where the triangles are small: by 3 % at f = 9, by a factor of 2 at f
 * = 1.
 */
void dome_light_sample(const struct dome *dome, int light, double u, double v, double dir[3]);

/* Probability density of dir (unit) under dome_light_sample(), per sr; its integral is 1. */
double dome_light_density(const struct dome *dome, int light, const double dir[3]);

/* Radius of a cap around the node that holds the whole light, rad. */
double dome_light_reach_rad(const struct dome *dome, int light);

/* The functions below are about cells, which exist whatever the shape of the lights. */

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
