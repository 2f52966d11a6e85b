/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_foot.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>

static bool is_possible(const struct basis_footprint *foot)
{
	uint64_t any = 0;

	for (int j = 0; j < BASIS_FOOT_SQUARES; j++)
		any |= foot->row[j];
	return fabsf(foot->corner[0]) <= BASIS_FOOT_MOST &&
	       fabsf(foot->corner[1]) <= BASIS_FOOT_MOST && foot->side >= 0 &&
	       foot->side <= BASIS_FOOT_MOST && (foot->side > 0 || !any) && foot->reserved == 0;
}

int basis_foot_check(const struct basis_footprint *feet, uint32_t count, uint32_t *bad)
{
	for (uint32_t p = 0; p < count; p++)
		if (!is_possible(&feet[p])) {
			*bad = p;
			return -EINVAL;
		}
	return 0;
}
