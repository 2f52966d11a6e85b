/* SPDX-License-Identifier: MIT */
/*
 * Which lights may be left out: as many of the weakest as together change no pixel by more than a
 * share of white. light_selection_choose() has the bound; here it is a whole number for each light,
 * so that sums are exact and the same everywhere.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_BUDGET_H
#define INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_BUDGET_H

#include "hal/compositor/light/selection.h"

#define LIGHT_BUDGET_WHITE (UINT64_C(1) << 40) /* a bound of 1 */

/* Where the weaker lights end. */
struct light_cut {
	uint64_t bound; /* all below it, */
	int equal;	/* and so many that are at it */
	int count;	/* how many lights that is */
};

/* sum[grounds][3]: of each ground's u over all lights. */
void light_budget_grounds(const struct basis *basis, double (*sum)[3]);

/* bound[lights], rounded up; at most twice white. ground_sum: as above. */
void light_budget_bounds(const struct basis *basis, int pose, const double (*ground_sum)[3],
			 const double (*radiance)[3], enum threshold_mode mode, double gain,
			 uint64_t *bound);

/* The most lights whose bounds add up to no more than room, in time linear in their number. */
struct light_cut light_budget_cut(const uint64_t *bound, int count, uint64_t room);

#endif
