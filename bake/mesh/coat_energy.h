/* SPDX-License-Identifier: MIT */
/*
 * How much light a rough coat reflects, and how much it leaves to the base below it.
 *
 * GGX counts light that meets one microfacet, and loses what meets several. With w the light that
 * meets one, drawn by visible normals, and o . h the cosine at the microfacet:
 *
 *     E(mu) = mean of w                    what a white coat keeps of the light from cosine mu
 *     B(mu) = mean of w (1 - o . h)^5      Schlick's part of it
 *     gain(mu) = 1 / E(mu) - 1
 *     R(mu) = (F0 (E - B) + B) (1 + F0 gain)
 *
 * The coat's light times 1 + F0 gain makes a white coat reflect all light (Turquin 2019). R is what
 * the coat of reflectance F0 then sends back. The base gets the rest, on the way in and on the way
 * out (Kulla and Conty 2017):
 *
 *     base = (1 - R(mu_o)) (1 - R(mu_i)) / (1 - mean of R),  mean of R = 2 int R(mu) mu dmu
 *
 * so that a white base under any coat sends back all light.
 */
#ifndef INLAY_BAKE_MESH_COAT_ENERGY_H
#define INLAY_BAKE_MESH_COAT_ENERGY_H

#include <math.h>

#define COAT_ANGLES 24

/* Coats of one roughness and reflectance; value k is at cosine (k / (COAT_ANGLES - 1))^2. */
struct coat_energy {
	float gain[COAT_ANGLES];
	float base[COAT_ANGLES]; /* 1 - R */
	float base_mean;	 /* 1 - mean of R */
};

/* alpha: of GGX, 0..1; specular: F0, 0..1. The first call takes some 10 ms; any thread may. */
void coat_energy_find(struct coat_energy *energy, float alpha, float specular);

/* Interpolates gain or base. */
static inline float coat_energy_at(const float value[COAT_ANGLES], float cosine)
{
	const float at = sqrtf(fminf(fmaxf(cosine, 0), 1)) * (COAT_ANGLES - 1);
	const int k = at < COAT_ANGLES - 2 ? (int)at : COAT_ANGLES - 2;

	return value[k] + (at - (float)k) * (value[k + 1] - value[k]);
}

#endif
