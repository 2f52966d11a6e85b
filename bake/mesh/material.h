/* SPDX-License-Identifier: MIT */
/*
 * Materials: how a surface scatters light.
 *
 *   diffuse   Lambert.
 *   glossy    a diffuse base under a rough dielectric or metal coat: GGX microfacets (Walter et al.
 *             2007, sampled by visible normals, Heitz 2018) with Schlick's Fresnel, coupled with
 * the base so that energy is conserved and reciprocity holds (Shirley et al. 1997). glass smooth
 * and clear: Fresnel reflection, refraction, both by chance; a tint for what passes through the
 * surface.
 *
 * Directions are unit vectors that point away from the surface.
 */
#ifndef INLAY_BAKE_MESH_MATERIAL_H
#define INLAY_BAKE_MESH_MATERIAL_H

#include <stdbool.h>
#include <xxhash.h>

#include "bake/base/random.h"
#include "bake/base/vec3.h"
#include "hal/image/image.h"

enum material_kind { MATERIAL_DIFFUSE, MATERIAL_GLOSSY, MATERIAL_GLASS, MATERIAL_KIND_COUNT };

extern const char *const material_kind_names[]; /* "diffuse", "glossy", "glass", NULL */

/* 8-bit code values are taken as sRGB, float ones as linear. Repeats; bilinear. Row 0 is at the
 * top, texture coordinate v runs upwards. */
struct texture {
	struct image image;
	float decode[256];
};

struct material {
	enum material_kind kind;
	struct rgb colour;	       /* 0..1: of the base, or what glass lets through */
	struct rgb specular;	       /* 0..1: the coat's reflectance at normal incidence */
	struct rgb metal;	       /* what of specular the texture multiplies, too */
	float roughness;	       /* 0..1; GGX alpha is its square */
	float ior;		       /* of glass */
	bool thin;		       /* glass: its surface is a whole pane */
	const struct texture *texture; /* multiplies colour; NULL for none */
};

/* A material at a point. */
struct bsdf {
	enum material_kind kind;
	struct rgb colour;
	struct rgb specular;
	float alpha;
	float ior;
	bool thin;
};

void texture_prepare(struct texture *texture); /* after image is set */
struct rgb texture_at(const struct texture *texture, float u, float v);

void texture_hash(const struct texture *texture, XXH3_state_t *state);

struct bsdf material_at(const struct material *material, float u, float v);

/*
 * The base's scattering for light from wi towards wo, as a factor on that of a Lambert surface:
 * f = colour / pi * this. 1 for diffuse surfaces; cosines to the normal are given.
 */
float bsdf_base(const struct bsdf *bsdf, float cos_o, float cos_i);

/* The coat: f * cos_i for light from wi, and the density (per sr) with which bsdf_coat_sample()
 * draws wi. Both 0 below the surface. */
struct rgb bsdf_coat(const struct bsdf *bsdf, struct v3 n, struct v3 wo, struct v3 wi,
		     float *density);

/* False when the sampled direction lies below the surface. */
bool bsdf_coat_sample(const struct bsdf *bsdf, struct v3 n, struct v3 wo, struct random *random,
		      struct v3 *wi);

/*
 * Glass's two ways. entering: wo is on the outer side of n. What is mirrored is not tinted, what
 * passes is, by colour; thin glass is two surfaces at once, with the light that goes to and fro
 * between them, tinted once and passed straight.
 */
struct glass_ways {
	float reflectance; /* of Fresnel; 1: nothing passes, and passed is not set */
	struct v3 mirrored, passed;
};

struct glass_ways bsdf_glass_ways(const struct bsdf *bsdf, struct v3 n, bool entering,
				  struct v3 wo);

/* Follows one of glass's two ways, chosen by chance with its own probability. entering: wo is on
 * the outer side of n. The weight is the tint where light passes through, 1 where it is mirrored.
 */
struct v3 bsdf_glass_sample(const struct bsdf *bsdf, struct v3 n, bool entering, struct v3 wo,
			    struct random *random, struct rgb *weight);

/* Cosine-weighted direction around n from a point of the unit square. */
struct v3 hemisphere_cosine(struct v3 n, float u, float v);

/* Uniform in area from the unit square to the unit disc (Shirley and Chiu 1997). */
void disc_from_square(float u, float v, float *x, float *y);

#endif
