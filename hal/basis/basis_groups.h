/* SPDX-License-Identifier: MIT */
/*
 * Groups of neighbouring lights (basis_format.h), and the common light S of a group in a frame.
 * Encoder and compositor both use these functions, so they agree.
 */
#ifndef INLAY_HAL_BASIS_BASIS_GROUPS_H
#define INLAY_HAL_BASIS_BASIS_GROUPS_H

#include <stdint.h>

#include "hal/basis/basis_format.h"

/* Limit of S, as a multiple of the cut of groups. Rounding changes a column by at most half of
 * 1 / 127 of its largest value; where that value is 1, this is a quarter of the cut:
 *     64 / 127 / 2 ~ 1 / 4
 */
#define BASIS_GROUP_MOST 64

struct basis_groups {
	int lights, count; /* count: K; 0 where each light is a coarse light: no groups */
	uint16_t *of;	   /* [lights]: group of each light */
	uint32_t *first;   /* [count + 1]: first entry of each group in light[] */
	uint16_t *light;   /* [lights]: sorted by group, ascending in each */
};

/* gather: P, [lights]; NULL: each light is a coarse light. -ENOMEM. */
int basis_groups_create(struct basis_groups *groups, const struct basis_coarse *gather, int lights,
			int coarse);
void basis_groups_free(struct basis_groups *groups); /* idempotent; zeroed is fine */

/* Upper limit of the cut of groups, unless column_cut is above it. */
#define BASIS_GROUP_CUT 0.001

/* Returns the cut of groups' columns, of which each block takes its cut_share:
 *     max(column_cut, min(column_cut * sqrt(N / K), BASIS_GROUP_CUT))
 * The errors of columns left out add up like the root of their number, and there are K groups
 * instead of N lights. */
double basis_group_cut(const struct basis_groups *groups, double column_cut);

/* Computes q of each light, >= 0:
 *     share[i] = weight[i] / sum of weight over its group       0 where the sum is 0
 * share may be the same array as weight. */
void basis_groups_share(const struct basis_groups *groups, const double *weight, double *share);

/*
 * Computes S of a group in each channel from the light x [lights][4] that its lights send (the
 * fourth column is ignored). S is the mean of x_i / q_i over lights with q_i > 0, without outliers:
 * a light above three times the mean of the others (a lamp in the sky) would leave a large
 * difference x - q S to every other light.
 *     0 <= S <= sum of x over the group,  S <= most
 */
void basis_group_even(const struct basis_groups *groups, int group, const double *share,
		      const double (*x)[4], const double most[3], double even[3]);

#endif
