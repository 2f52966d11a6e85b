/* SPDX-License-Identifier: MIT */
/*
 * The response as a sum of basis functions, u being the code value over its range, 0..1:
 *     ln f(u) = ln u + sum of b_k(u) a_k
 * The b_k are cubic B-splines in ln((u + e) / (1 - u + e)), e = 0.1: finer towards black, where
 * powers bend, and towards white, where shoulders do. The term ln u makes f proportional to light
 * in the dark.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_SPLINE_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_SPLINE_H

#define LIGHT_PIECES_MAX 24
#define LIGHT_SPLINE_MAX (LIGHT_PIECES_MAX + 3)

struct light_spline {
	int pieces;	 /* 1..LIGHT_PIECES_MAX, of equal width between from and to */
	double from, to; /* u; continued by a straight line below, by a parabola above */
};

int light_spline_count(const struct light_spline *spline); /* pieces + 3 */

/* Computes b_k(u) and, unless NULL, d b_k / d u. u > 0. */
void light_spline_at(const struct light_spline *spline, double u, double *value, double *slope);

#endif
