/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/rotation.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "hal/optics/vec.h"

/*
 * Rodrigues' formula, with K = [v]x and t = |v|:
 *     R = I + a K + b K^2,   a = sin t / t,   b = (1 - cos t) / t^2
 * Each derivative is taken term by term; (da/dt) / t and (db/dt) / t by their series near 0, where
 * the closed forms lose their digits.
 */
void rotation_from_vector(const double v[3], double rotation[9], double slope[3][9])
{
	const double tt = vec_dot(v, v), t = sqrt(tt), half = sin(t / 2);
	const bool near = t < 1e-2;
	const double a = near ? 1 - tt / 6 * (1 - tt / 20 * (1 - tt / 42)) : sin(t) / t;
	const double b = near ? 0.5 - tt / 24 * (1 - tt / 30 * (1 - tt / 56))
			      : 2 * half * half / tt;
	const double da = near ? -1.0 / 3 + tt / 30 - tt * tt / 840 : (cos(t) - a) / tt;
	const double db = near ? -1.0 / 12 + tt / 180 - tt * tt / 6720 : (a - 2 * b) / tt;

	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++) {
			/* K_ij = -e_ijk v_k; (K^2)_ij = v_i v_j - tt (i == j) */
			const int k = 3 - i - j;
			const double sign = i == j ? 0 : (j - i + 3) % 3 == 1 ? -1 : 1;
			const double cross = i == j ? 0 : sign * v[k];
			const double square = v[i] * v[j] - (i == j) * tt;

			rotation[3 * i + j] = (i == j) + a * cross + b * square;
			for (int d = 0; d < 3; d++) {
				const double turn = i != j && k == d ? sign : 0;
				const double bend = (d == i) * v[j] + (d == j) * v[i] -
						    2 * (i == j) * v[d];

				slope[d][3 * i + j] = v[d] * (da * cross + db * square) + a * turn +
						      b * bend;
			}
		}
}

/* Via a unit quaternion, from its largest component, so that no digits are lost near a half
 * turn. */
void rotation_to_vector(const double r[9], double vector[3])
{
	const double squares[4] = {1 + r[0] + r[4] + r[8], 1 + r[0] - r[4] - r[8],
				   1 - r[0] + r[4] - r[8], 1 - r[0] - r[4] + r[8]};
	double q[4], sine, factor;
	int most = 0;

	for (int k = 1; k < 4; k++)
		if (squares[k] > squares[most])
			most = k;
	q[0] = most == 0   ? squares[0]
	       : most == 1 ? r[7] - r[5]
	       : most == 2 ? r[2] - r[6]
			   : r[3] - r[1];
	q[1] = most == 0   ? r[7] - r[5]
	       : most == 1 ? squares[1]
	       : most == 2 ? r[1] + r[3]
			   : r[2] + r[6];
	q[2] = most == 0   ? r[2] - r[6]
	       : most == 1 ? r[1] + r[3]
	       : most == 2 ? squares[2]
			   : r[5] + r[7];
	q[3] = most == 0   ? r[3] - r[1]
	       : most == 1 ? r[2] + r[6]
	       : most == 2 ? r[5] + r[7]
			   : squares[3];
	sine = vec_length(q + 1);
	if (!(sine > 0)) {
		memset(vector, 0, 3 * sizeof(*vector));
		return;
	}
	factor = 2 * atan2(q[0] < 0 ? -sine : sine, fabs(q[0])) / sine;
	for (int i = 0; i < 3; i++)
		vector[i] = factor * q[1 + i];
}
