/* SPDX-License-Identifier: MIT */
/*
 * What light vectors need of a basis and no frame changes, worked out once and shared by all of
 * them. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_TERMS_H
#define INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_TERMS_H

#include "hal/basis/basis.h"
#include "hal/basis/basis_groups.h"

/*
 * Sums over lights: part j is the sum of lights j, j + 4, j + 8 ... in this order, as long as there
 * are four more; part 0 gets the rest; and the parts are added up by light_parts(). It is written
 * down because sums of doubles depend on it, and is the same on every machine. There are four so
 * that additions need not wait for each other.
 */
#define LIGHT_PARTS 4

static inline double light_parts(double a, double b, double c, double d)
{
	return (a + b) + (c + d);
}

struct light_terms {
	const struct basis *basis; /* borrowed */
	int lights, coarse;
	double *solid_angle;	 /* [lights] */
	double (*ground_sum)[3]; /* [grounds]: sum of u */
	struct basis_groups groups;
	/* [grounds + 1][lights], those of T last: q (basis_format.h). */
	double *share;
	/* Those that coarse light k gathers of: from first[k] on, up to first[k + 1]. All NULL
	 * where each light is its own. */
	uint32_t *first; /* [coarse + 1] */
	uint16_t *light; /* ascending */
	double *weight;	 /* BASIS_COARSE_ONE is 1; whole numbers */
};

int light_terms_create(struct light_terms *terms, const struct basis *basis); /* -ENOMEM */
void light_terms_free(struct light_terms *terms);			      /* zeroed is fine */

#endif
