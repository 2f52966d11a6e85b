/* SPDX-License-Identifier: MIT */
/*
 * The lights: the upper nodes of a geodesic dome (thesis 2.2.1, figure 2.7), each with a weight
 * over the upper hemisphere. The weights of any direction sum to 1.
 *
 * A regular icosahedron with a vertex at the zenith and one above azimuth 0; each face divided f
 * times, by equal angles (the thesis) or equal chords. Light i is a node at or above the horizon.
 * Its shape is one of
 *   cell  weight 1 in its spherical Voronoi cell, the part of the upper hemisphere that is nearer
 *         to it than to any other such node, 0 elsewhere;
 *   tent  weight 1 at the node, and where a direction's ray meets the flat triangles between nodes
 *         linear in the place: 0 at all other nodes, continuous everywhere. Below the lowest nodes
 *         the two of them beside a direction share it, as in a triangle with the horizon below one.
 * Nodes below the horizon do not compete, so that the lights cover the hemisphere: their solid
 * angles, the integrals of their weights, sum to 2 pi.
 *
 * Which nodes lie on the horizon is decided by their combinatorial position on the icosahedron, not
 * by rounding, so the count is a function of f and the division alone:
 *     5 f^2 + 1            f odd
 *     5 f^2 + 6            f even, by angles
 *     5 f^2 + 1 + 5 f / 2  f even, by chords
 * that is 6, 26, 46, 86, 186, 406 for f = 1, 2, 3, 4, 6, 9 by angles (6, 26, 46, 91, 196, 406 by
 * chords).
 *
 * Order of lights: by row of the division from the zenith, then by azimuth from 0 to 2 pi; stable
 * for ever, since files refer to lights by index.
 */
#ifndef INLAY_HAL_OPTICS_DOME_H
#define INLAY_HAL_OPTICS_DOME_H

#include "hal/base/fault.h"

#define DOME_FREQUENCY_MAX 64

enum dome_division { DOME_ANGLES, DOME_CHORDS, DOME_DIVISION_COUNT };

extern const char *const dome_division_names[]; /* "angles", "chords", NULL */

enum dome_shape { DOME_CELLS, DOME_TENTS, DOME_SHAPE_COUNT };

extern const char *const dome_shape_names[]; /* "cells", "tents", NULL */

struct dome_cells;  /* the outlines of the cells */
struct dome_lookup; /* finds the cell of a direction */
struct dome_tents;  /* the triangles between the nodes */

struct dome {
	int frequency;
	enum dome_division division;
	enum dome_shape shape;
	int count;
	double (*direction)[3]; /* unit; z >= 0, exactly 0 on the horizon */
	double *solid_angle_sr; /* w_i; sum = 2 pi to 1e-12 */
	double *projected_sr;	/* integral of weight times cos(theta); sum = pi to 1e-12 */
	struct dome_cells *cells;
	struct dome_lookup *lookup;
	struct dome_tents *tents; /* NULL of cells */
};

/* -EINVAL: frequency outside 1..DOME_FREQUENCY_MAX, unknown division or
 * shape; -ENOMEM. The dome is zeroed
 * on failure. */
int dome_create_shaped(struct dome *dome, int frequency, enum dome_division division,
		       enum dome_shape shape, struct fault *fault);
/* Of cells. */
int dome_create(struct dome *dome, int frequency, enum dome_division division, struct fault *fault);
void dome_free(struct dome *dome); /* idempotent; zeroed is fine */

/* Polar angle from the zenith 0..pi/2, azimuth from +X towards +Y, -pi..pi. */
void dome_angles(const struct dome *dome, int light, double *theta_rad, double *phi_rad);

/* The lights that have a part in a direction, and how much: > 0, sum 1. Returns how many, 1 to 3;
 * none below the horizon (z < 0) and for no direction (zero, NaN, infinity). dir need not be unit.
 * O(1), about 20 ns for cells, 90 for tents. */
int dome_weights(const struct dome *dome, const double dir[3], int light[3], double weight[3]);

/* That of one light, 0 where it has no part. */
double dome_weight(const struct dome *dome, int light, const double dir[3]);

/*
 * A unit direction of a light, from two numbers in [0, 1). Continuous but for a few cuts: low-
 * discrepancy points stay so. Of a cell by solid angle; of a tent with its weight as density on the
 * flat triangles, so that weight over density, the solid angle on average, hardly varies where
 * they are small: by 3 % at f = 9, twofold at f = 1.
 */
void dome_light_sample(const struct dome *dome, int light, double u, double v, double dir[3]);

/* With what density dome_light_sample() draws dir (unit), per sr: its integral is 1. */
double dome_light_density(const struct dome *dome, int light, const double dir[3]);

/* Nothing of the light is farther from its node. */
double dome_light_reach_rad(const struct dome *dome, int light);

/* The light whose node is nearest (its cell holds dir), exactly as comparing the dot products with
 * all nodes would find it; among equals the lowest index wins. -1 below the horizon (z < 0) and for
 * no direction (zero, NaN, infinity). dir need not be unit. O(1): the candidates of a grid cell. */
int dome_cell_of(const struct dome *dome, const double dir[3]);

/* Cells are there whatever the shape of the lights. */

/* A unit direction uniform by solid angle in the cell, from two numbers in [0, 1). Continuous but
 * for cuts along the arcs from the node to the corners: low-discrepancy points stay so. */
void dome_cell_sample(const struct dome *dome, int light, double u, double v, double dir[3]);

/* Corners of the cell, counter-clockwise seen from outside the dome. Returns their number, writes
 * at most room of them. */
int dome_cell_corners(const struct dome *dome, int light, double (*corner)[3], int room);

#endif
