/* SPDX-License-Identifier: MIT */
/*
 * Keeps the place of light inside cells: a small lamp that is off the middle of its cell lights
 * what faces it as it does, and not as the even cell would.
 *
 * The sampler measures cell i in three thirds: pixel p in the direction d counts for third k with
 *     w_p edge_ik . d          edge_i: dual basis of the corners a_i0, a_i1, a_i2
 * The corners are those of a triangle around the cell, in the plane through the cell's mean
 * direction m_i (not unit) that is perpendicular to it. The radiance L_ik of a third is the mean
 * with these weights, W_ik is their sum. Per channel
 *     q_ik = W_ik L_ik / sum_k W_ik L_ik        e_ik = W_ik / sum_k W_ik
 *     c_i = m_i + sum_k (q_ik - e_ik) a_ik                        centroid of the light in the cell
 * Light with the centroid c_i is shared among the cells j around it by their barycentric weights
 * b_j at c_i in the triangles between the directions of all m_j (dome_parts.h):
 *     L_j w_j = sum_i b_ij F_i,      F_i = w_i sum_k W_ik L_ik / sum_k W_ik
 * Even light in a cell stays where it is, because c_i = m_i then. All lights are then multiplied by
 *     sum_i F_i c_iz / sum_i F_i m_iz(after)
 * so that a plane that faces the zenith has exactly the irradiance of the picture. This factor
 * differs from 1 where c_i is below the lowest m_j, which leaves no cell to share with, and by the
 * curvature of the sphere within cells.
 */
#ifndef INLAY_HAL_OPTICS_DOME_PLACED_H
#define INLAY_HAL_OPTICS_DOME_PLACED_H

#include "hal/optics/dome.h"

#define DOME_PLACED_THIRDS 3

struct dome_placed;

/* 0; -ENOMEM; -EINVAL: the dome's cells are too wide or too few for that. */
int dome_placed_create(struct dome_placed **placed, const struct dome *dome);

/* How much light from a direction in the cell counts for each of its thirds. */
void dome_placed_thirds(const struct dome_placed *placed, int light, const double dir[3],
			double part[DOME_PLACED_THIRDS]);

/* Takes W of all thirds: weight[DOME_PLACED_THIRDS * light + k]. */
void dome_placed_even(struct dome_placed *placed, const double *weight);

/* Makes light[lights] of third[DOME_PLACED_THIRDS * lights] in 1 to 3 channels. */
void dome_placed_run(struct dome_placed *placed, const double (*third)[3], int channels,
		     double (*light)[3]);

/*
 * The same for light of which the direction is known: lists the lights that share it, with weights
 * such that light of irradiance E, on a surface that faces it, adds weight E / w_j to L_j. The
 * weights sum to 1 up to the factor above, which is bounded here. light: one near dir; *facet as in
 * dome_facets_weights(). Returns how many there are, 0 to 3; 0 below the horizon.
 */
int dome_placed_share(const struct dome_placed *placed, int light, int *facet, const double dir[3],
		      int to[3], double weight[3]);

void dome_placed_destroy(struct dome_placed *placed); /* NULL is harmless */

#endif
