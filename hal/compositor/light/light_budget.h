/* SPDX-License-Identifier: MIT */
/*
 * The lights that a budget allows to drop: as many of the weakest as together change no pixel by
 * more than the budget. light_selection_choose() has the bound b_i and its proof. Here b_i is an
 * integer, so that sums are exact and the same on every machine.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_BUDGET_H
#define INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_BUDGET_H

#include "hal/compositor/light/selection.h"

#define LIGHT_BUDGET_WHITE (UINT64_C(1) << 40) /* stands for a bound of 1, white */

/* Separates the lights to drop from the others. */
struct light_cut {
	uint64_t bound; /* drop all lights below it */
	int equal;	/* and this many of those equal to it */
	int count;	/* total number of lights to drop */
};

/* sum[grounds][3]: sum of u over all lights. */
void light_budget_grounds(const struct basis *basis, double (*sum)[3]);

/* bound[lights]: b_i, rounded up; at most 2 * LIGHT_BUDGET_WHITE. ground_sum: as above. */
void light_budget_bounds(const struct basis *basis, int pose, const double (*ground_sum)[3],
			 const double (*radiance)[3], enum threshold_mode mode, double gain,
			 uint64_t *bound);

/* Finds the largest number of lights whose bounds sum to at most room. O(count). */
struct light_cut light_budget_cut(const uint64_t *bound, int count, uint64_t room);

#endif
