/* SPDX-License-Identifier: MIT */
/*
 * The response as a sum of basis functions: ln f(u) = ln u + sum of b_k(u) a_k, u being the code
 * value over its range, 0..1. The b_k are cubic B-splines in ln((u + e) / (1 - u + e)), e = 0.1:
 * finer towards black, where powers bend, and towards white, where shoulders do. What ln u takes
 * away makes f proportional to light where it is dark.
 */
#ifndef INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_SPLINE_H
#define INLAY_BAKE_CALIBRATE_RESPONSE_LIGHT_SPLINE_H

#define LIGHT_PIECES_MAX 24
#define LIGHT_SPLINE_MAX (LIGHT_PIECES_MAX + 3)

struct light_spline {
	int pieces;	 /* 1..LIGHT_PIECES_MAX, of equal width between from and to */
	double from, to; /* u; below, a straight line goes on, above, a parabola */
};

int light_spline_count(const struct light_spline *spline); /* pieces + 3 */

/* b_k(u) and, unless NULL, d b_k / d u. u > 0. */
void light_spline_at(const struct light_spline *spline, double u, double *value, double *slope);

#endif
