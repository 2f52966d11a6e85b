/* SPDX-License-Identifier: MIT */
#include "bake/mesh/coat_energy.h"

#include <pthread.h>

#define ROUGHNESSES 32 /* alpha is the square of k / (ROUGHNESSES - 1) */
/* Points of the integral: a Fibonacci lattice. */
#define POINTS 610
#define POINTS_BEFORE 377
#define COSINE_LEAST 1e-3

static struct coat_table {
	float whole[COAT_ANGLES];   /* E */
	float schlick[COAT_ANGLES]; /* B */
} coat_table[ROUGHNESSES];
static float mean_weight[COAT_ANGLES]; /* of each value in the mean */
static pthread_once_t coat_table_made = PTHREAD_ONCE_INIT;

/* Smith's Lambda */
static double ggx_lambda(double alpha, double c)
{
	return 0.5 * (sqrt(1 + alpha * alpha * (1 - c * c) / (c * c)) - 1);
}

/*
 * Integrates over the visible normals (Heitz 2018) seen from cosine mu, in the plane y = 0:
 *     w = G2 / G1 = (1 + Lambda(o)) / (1 + Lambda(o) + Lambda(i)),  0 where i is below the surface
 * Half of the disc is enough, as both halves are alike.
 */
static void integrate(double alpha, double mu, float *whole, float *schlick)
{
	const double ox = sqrt(1 - mu * mu), size = hypot(alpha * ox, mu);
	const double vx = alpha * ox / size, vz = mu / size;
	const double lambda_o = ggx_lambda(alpha, mu), blend = 0.5 * (1 + vz);
	double sum = 0, sum_schlick = 0;

	for (int i = 0; i < POINTS; i++) {
		const double r = sqrt((i + 0.5) / POINTS);
		const double phi = M_PI * (i * POINTS_BEFORE % POINTS + 0.5) / POINTS;
		const double y = r * sin(phi), chord = sqrt(1 - y * y);
		const double x = (1 - blend) * chord + blend * r * cos(phi);
		const double z = sqrt(fmax(1 - x * x - y * y, 0));
		const double hx = alpha * (z * vx - x * vz), hy = alpha * y, hz = z * vz + x * vx;
		const double length = sqrt(hx * hx + hy * hy + hz * hz);
		const double oh = (hx * ox + hz * mu) / length, ci = 2 * oh * hz / length - mu;

		if (ci > 0) {
			const double m2 = (1 - oh) * (1 - oh);
			const double w = (1 + lambda_o) / (1 + lambda_o + ggx_lambda(alpha, ci));

			sum += w;
			sum_schlick += w * m2 * m2 * (1 - oh);
		}
	}
	*whole = (float)(sum / POINTS);
	*schlick = (float)(sum_schlick / POINTS);
}

/*
 * With x = sqrt(mu) (n - 1) and the hat functions of linear interpolation:
 *     mean_weight[k] = 2 int hat_k(x) mu dmu = 4 / (n - 1)^4 int hat_k(x) x^3 dx
 */
static void make_weights(void)
{
	const double last = COAT_ANGLES - 1;

	for (int k = 0; k < COAT_ANGLES; k++)
		mean_weight[k] = (float)(4 / pow(last, 4) * (pow(k, 3) + k / 2.0));
	mean_weight[0] = (float)(4 / pow(last, 4) / 20);
	mean_weight[COAT_ANGLES - 1] =
		(float)(4 / pow(last, 4) *
			(pow(last, 3) / 2 - last * last / 2 + last / 4 - 1.0 / 20));
}

static void make_table(void)
{
	make_weights();
	for (int r = 0; r < ROUGHNESSES; r++)
		for (int k = 0; k < COAT_ANGLES; k++) {
			const double root = (double)k / (COAT_ANGLES - 1);
			const double roughness = (double)r / (ROUGHNESSES - 1);

			integrate(roughness * roughness, fmax(root * root, COSINE_LEAST),
				  &coat_table[r].whole[k], &coat_table[r].schlick[k]);
		}
}

static float mix(float a, float b, float share)
{
	return a + share * (b - a);
}

void coat_energy_find(struct coat_energy *e, float alpha, float specular)
{
	const float at = sqrtf(fminf(fmaxf(alpha, 0), 1)) * (ROUGHNESSES - 1);
	const int r = at < ROUGHNESSES - 2 ? (int)at : ROUGHNESSES - 2;
	const float share = at - (float)r;
	const struct coat_table *low = &coat_table[r], *high = low + 1;

	pthread_once(&coat_table_made, make_table);
	e->base_mean = 0;
	for (int k = 0; k < COAT_ANGLES; k++) {
		const float whole = mix(low->whole[k], high->whole[k], share);
		const float schlick = mix(low->schlick[k], high->schlick[k], share);

		e->gain[k] = 1 / whole - 1;
		e->base[k] = fmaxf(1 - (specular * (whole - schlick) + schlick) *
						   (1 + specular * e->gain[k]),
				   0);
		e->base_mean += mean_weight[k] * e->base[k];
	}
}
