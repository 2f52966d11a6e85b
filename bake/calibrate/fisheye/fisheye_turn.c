/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/fisheye_parts.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "hal/optics/vec.h"

/* a I + b [w]x + c w w^T */
static void turn_polynomial(const double w[3], double a, double b, double c, double m[9])
{
	const double cross[9] = {0, -w[2], w[1], w[2], 0, -w[0], -w[1], w[0], 0};

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			m[3 * i + k] = (i == k ? a : 0) + b * cross[3 * i + k] + c * w[i] * w[k];
}

void turn_matrix(const double w[3], double rotation[9])
{
	const double angle = vec_length(w), u = angle * angle;
	const bool small = angle < 1e-4;
	const double half = sin(angle / 2);

	turn_polynomial(w, cos(angle), small ? 1 - u / 6 : sin(angle) / angle,
			small ? 0.5 - u / 24 : 2 * half * half / u, rotation);
}

void turn_jacobian(const double w[3], double jacobian[9])
{
	const double angle = vec_length(w), u = angle * angle;
	const bool small = angle < 1e-3;
	const double half = sin(angle / 2);
	const double s = small ? 1 - u / 6 : sin(angle) / angle;

	turn_polynomial(w, s, small ? 0.5 - u / 24 : 2 * half * half / u,
			small ? 1.0 / 6 - u / 120 : (1 - s) / u, jacobian);
}

void turn_multiply(const double a[9], const double b[9], double product[9])
{
	double m[9];

	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			m[3 * i + k] = a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] +
				       a[3 * i + 2] * b[6 + k];
	memcpy(product, m, sizeof(m));
}

void turn_degrees(const double r[9], double deg[3])
{
	const double across = hypot(r[0], r[3]);

	deg[1] = atan2(-r[6], across) * (180 / M_PI);
	if (across > 1e-12) {
		deg[0] = atan2(r[7], r[8]) * (180 / M_PI);
		deg[2] = atan2(r[3], r[0]) * (180 / M_PI);
	} else {
		deg[0] = 0;
		deg[2] = atan2(-r[1], r[4]) * (180 / M_PI);
	}
}
