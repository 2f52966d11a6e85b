/* SPDX-License-Identifier: MIT */
/*
 * Rows of a bake's exact layer, read back in double precision from basis_format.h alone. Pixel (x,
 * y) is of pose 0, c is a channel, and `light` is the radiance of each light; NULL: 1 for all.
 */
#ifndef INLAY_TESTS_SUPPORT_BAKE_BAKED_ROWS_H
#define INLAY_TESTS_SUPPORT_BAKE_BAKED_ROWS_H

#include <stdbool.h>

#include "hal/basis/basis.h"

/* out[lights] = t_i, v_i, d_i or u_i of a pixel, by the kind. False, and zeros: no such row. */
bool baked_row(const struct basis *basis, int x, int y, enum basis_kind kind, int c, double *out);

/* sum over i of t_i L_i, and what the pixel mirrors: the light of the nearest node, without blur */
double baked_object(const struct basis *basis, int x, int y, int c, const double *light);

double baked_mirrored(const struct basis *basis, int x, int y, int c, const double *light);

/* The ground's ratio s / u, from V or from D and U; 1 where there is neither. */
double baked_ratio(const struct basis *basis, int x, int y, int c, const double *light);

/* Share of the background's light that comes through glass, 0..1. */
double baked_through(const struct basis *basis, int x, int y, int c);

/* Share of the pixel that the object covers, 0..1. */
double baked_coverage(const struct basis *basis, int x, int y);

#endif
