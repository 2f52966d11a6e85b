/* SPDX-License-Identifier: MIT */
/*
 * Tents: lights whose weight falls linearly from their node to its neighbours (dome.h). The
 * hemisphere is tiled by flat triangles (facets), each with three barycentric weights.
 *
 * The facets are those of the nodes' convex hull that face upwards, the dual of the cells. The
 * lowest nodes may lie above the horizon; there, triangles between the hull's rim and the horizon
 * close the gap. Their lower corners are the feet, the points of the horizon straight below the
 * rim's nodes. A foot belongs to the light of its node, so two nodes share each direction below the
 * rim.
 */
#ifndef INLAY_HAL_OPTICS_DOME_TENTS_H
#define INLAY_HAL_OPTICS_DOME_TENTS_H

#include "hal/optics/dome_cells.h"
#include "hal/optics/dome_lookup.h"

struct dome_tents;

/* Creates the tents of count nodes from their cells and the lookup of these cells. 0; -ENOMEM;
 * -EINVAL: the triangles do not cover the hemisphere. */
int dome_tents_create(struct dome_tents **tents, const struct dome_cells *cells,
		      const struct dome_lookup *lookup, const double (*node)[3], int count);
void dome_tents_destroy(struct dome_tents *tents); /* NULL is harmless */

/* The same contract as dome_weights(). */
int dome_tents_weights(const struct dome_tents *tents, const double dir[3], int light[3],
		       double weight[3]);

/* The same, faster for a direction in a triangle around that node. *facet is tried first, and
 * becomes the triangle that was found; -1: none is known. */
int dome_tents_weights_near(const struct dome_tents *tents, int node, int *facet,
			    const double dir[3], int light[3], double weight[3]);

/* Solid angle of a light, and the integral of its weight times the cosine to the zenith, in sr. */
void dome_tents_measure(const struct dome_tents *tents, int light, double *solid_angle_sr,
			double *projected_sr);

/* These have the contracts of dome_light_reach_rad(), _sample() and _density(). */
double dome_tents_reach_rad(const struct dome_tents *tents, int light);
void dome_tents_sample(const struct dome_tents *tents, int light, double u, double v,
		       double dir[3]);
double dome_tents_density(const struct dome_tents *tents, int light, const double dir[3]);

#endif
