/* SPDX-License-Identifier: MIT */
/*
 * The light that a choice leaves out, returned as nine terms: light_selection_choose() in mode
 * harmonics. Private to hal/compositor.
 *
 * Real spherical harmonics up to l = 2, made orthonormal over the lights with their solid angles as
 * weights; the first is the constant, which is what mode ambient returns. The fit of the other
 * eight,
 *
 *     q_j = sum over k of B_k(j) sum over dropped i of w_i L_i B_k(i),
 *
 * is that of least squares over the sky, and sum of w_j q_j = 0: it moves light and makes none.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_RETURN_H
#define INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_RETURN_H

#include "hal/compositor/light/selection.h"

/* Those of a basis's lights but for the constant: [lights], to be freed. NULL: no memory. Where the
 * lights are too few to tell them apart, the later ones are 0. */
double (*light_return_terms(const struct basis *basis))[LIGHT_RETURN_TERMS];

/*
 * Before the dropped lights are 0: fills returned[] and dropped_error. With a budget, the share of
 * the eight terms is as large as keeps the change of each pixel within it.
 */
void light_return(struct light_selection *selection, const struct basis *basis,
		  const float (*peak)[3], double gain);

#endif
