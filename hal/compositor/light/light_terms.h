/* SPDX-License-Identifier: MIT */
/*
 * Data of a basis that all light vectors need and no frame changes, computed once. Private to
 * hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_TERMS_H
#define INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_TERMS_H

#include "hal/basis/basis.h"
#include "hal/basis/basis_groups.h"
#include "hal/lights/lamps.h"

/*
 * The order of sums over lights, which is fixed because sums of doubles depend on it:
 *     part j = light j + light j + 4 + light j + 8 ...    for the first N - N % 4 lights
 *     part 0 also gets the rest
 *     sum = light_parts(part 0, part 1, part 2, part 3)
 * So results are the same on every machine. Four parts let additions overlap.
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
	double *share; /* [grounds + 1][lights]: q of V for each ground, then q of T */
	/* P by rows: coarse light k gathers light[n] with weight[n],
	 *     first[k] <= n < first[k + 1]
	 * All NULL if each light is a coarse light. */
	uint32_t *first; /* [coarse + 1] */
	uint16_t *light; /* ascending */
	double *weight;	 /* integers; BASIS_COARSE_ONE stands for 1 */
	/* Lamps at places (near/), lights N + K + l; set after the creation. */
	int lamps;
	double lamp_ground[LAMPS_MAX][3]; /* u of the unit of each lamp on the ground */
};

/* Index in light_vector.sent of the first lamp: after lights, and groups where there are any. */
static inline int light_terms_lamp(const struct light_terms *terms)
{
	return terms->groups.count ? 2 * terms->lights + terms->coarse : terms->lights;
}

int light_terms_create(struct light_terms *terms, const struct basis *basis); /* -ENOMEM */
void light_terms_free(struct light_terms *terms);			      /* zeroed is fine */

#endif
