/* SPDX-License-Identifier: MIT */
/*
 * Returns the dropped light as nine terms: light_selection_choose() in mode harmonics. Private to
 * hal/compositor.
 *
 * The terms B_k are the real spherical harmonics up to l = 2, made orthonormal over the lights with
 * solid angles as weights. The first is the constant, which is what mode ambient returns. The other
 * eight give the least-squares fit to the dropped light over the sky:
 *
 *     q_j = sum over k = 1..8 of B_k(j) sum over dropped i of w_i L_i B_k(i)
 *
 * sum over j of w_j q_j = 0: the fit moves light over the sky and adds none.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_RETURN_H
#define INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_RETURN_H

#include "hal/compositor/light/selection.h"

/* Returns B_1..B_8 in each light: [lights]; the caller frees it. NULL: no memory. Terms that depend
 * linearly on earlier ones, as there are too few lights, are 0. */
double (*light_return_terms(const struct basis *basis))[LIGHT_RETURN_TERMS];

/*
 * Fills returned[] and dropped_error of a selection whose used[] is set and whose radiance[] still
 * holds the dropped lights. With a budget, s is as large as the budget allows.
 */
void light_return(struct light_selection *selection, const struct basis *basis,
		  const float (*peak)[3], double gain);

#endif
