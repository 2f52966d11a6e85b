/* SPDX-License-Identifier: MIT */
/*
 * Groups of neighbouring lights (basis_format.h), and what the lights of one have in common in a
 * frame: the one place where encoder and compositor agree on it.
 */
#ifndef INLAY_HAL_BASIS_BASIS_GROUPS_H
#define INLAY_HAL_BASIS_BASIS_GROUPS_H

#include <stdint.h>

#include "hal/basis/basis_format.h"

/* A group's even light is no more than this times the cut of groups: what its column is rounded by,
 * half of 1 / 127 of its largest value, is then a quarter of the cut where that value is 1. */
#define BASIS_GROUP_MOST 64

struct basis_groups {
	int lights, count; /* count: K; 0 where each light is its own */
	uint16_t *of;	   /* [lights] */
	uint32_t *first;   /* [count + 1]: where each group's lights begin */
	uint16_t *light;   /* [lights]: by groups, ascending in each */
};

/* gather: [lights], or NULL where each light is its own. -ENOMEM. */
int basis_groups_create(struct basis_groups *groups, const struct basis_coarse *gather, int lights,
			int coarse);
void basis_groups_free(struct basis_groups *groups); /* idempotent; zeroed is fine */

/* A group's column by itself is never left out if it changes more, unless a light's may be. */
#define BASIS_GROUP_CUT 0.001

/* Below this groups' columns may be left out, where those of lights may be below column_cut: that
 * times sqrt(N / K), up to BASIS_GROUP_CUT, but no less than it. What is left out adds up like the
 * root of its number, and there are K groups however many lights. */
double basis_group_cut(const struct basis_groups *groups, double column_cut);

/* q of each light: its part of the group's sum of weight [lights], >= 0; 0 where that is 0. share
 * may be weight. */
void basis_groups_share(const struct basis_groups *groups, const double *weight, double *share);

/*
 * S of a group, channel by channel, of what its lights send: x [lights][4], of which three count.
 * It is the mean of x_i / q_i over the lights of the group that have a share, without those that
 * are more than three times the mean of the others, a lamp among sky: they would leave every other
 * light a large difference. 0 <= S <= the sum of x over the group, and S <= most.
 */
void basis_group_even(const struct basis_groups *groups, int group, const double *share,
		      const double (*x)[4], const double most[3], double even[3]);

#endif
