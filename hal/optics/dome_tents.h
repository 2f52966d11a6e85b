/* SPDX-License-Identifier: MIT */
/*
 * Tents: lights that fall off linearly from their node to its neighbours (dome.h). The hemisphere
 * in triangles, and in each of them three weights.
 *
 * The triangles are those of the nodes' convex hull that face upwards: the cells' neighbours. Below
 * the hull's rim down to the horizon stand triangles between the rim's nodes and their feet, the
 * points of the horizon straight below them; a foot belongs to the light of its node, so that what
 * is seen below the rim is shared by two of its nodes.
 */
#ifndef INLAY_HAL_OPTICS_DOME_TENTS_H
#define INLAY_HAL_OPTICS_DOME_TENTS_H

#include "hal/optics/dome_cells.h"
#include "hal/optics/dome_lookup.h"

struct dome_tents;

/* Of nodes and their cells, which cells knows how to find (dome_lookup.h). -ENOMEM; -EINVAL: the
 * triangles do not cover the hemisphere. */
int dome_tents_create(struct dome_tents **tents, const struct dome_cells *cells,
		      const struct dome_lookup *lookup, const double (*node)[3], int count);
void dome_tents_destroy(struct dome_tents *tents); /* NULL is harmless */

/* As dome_weights(). */
int dome_tents_weights(const struct dome_tents *tents, const double dir[3], int light[3],
		       double weight[3]);

/* Solid angle, and integral of the cosine to the zenith. */
void dome_tents_measure(const struct dome_tents *tents, int light, double *solid_angle_sr,
			double *projected_sr);

double dome_tents_reach_rad(const struct dome_tents *tents, int light);

void dome_tents_sample(const struct dome_tents *tents, int light, double u, double v,
		       double dir[3]);
double dome_tents_density(const struct dome_tents *tents, int light, const double dir[3]);

#endif
