/* SPDX-License-Identifier: MIT */
/*
 * Materials: how a surface scatters light.
 *
 *   diffuse   Lambert.
 *   glossy    a diffuse base under a rough dielectric or metal coat: GGX microfacets (Walter et al.
 *             2007, sampled by visible normals, Heitz 2018) with Schlick's Fresnel term. Light
 *             that meets several microfacets is added, and the base gets what the coat leaves
 *             (coat_energy.h).
 *   glass     smooth and clear: Fresnel reflection and refraction, one of them chosen by chance; a
 *             tint for light that passes through the surface.
 *
 * Directions are unit vectors that point away from the surface.
 */
#ifndef INLAY_BAKE_MESH_MATERIAL_H
#define INLAY_BAKE_MESH_MATERIAL_H

#include <stdbool.h>
#include <xxhash.h>

#include "bake/base/random.h"
#include "bake/base/vec3.h"
#include "bake/mesh/coat_energy.h"
#include "hal/image/image.h"

/* Coats up to this GGX alpha, roughness 0.25, are mirrors: their lobes are no wider than a cell of
 * 7 degrees. */
#define MATERIAL_MIRROR_ALPHA 0.0625f

enum material_kind { MATERIAL_DIFFUSE, MATERIAL_GLOSSY, MATERIAL_GLASS, MATERIAL_KIND_COUNT };

extern const char *const material_kind_names[]; /* "diffuse", "glossy", "glass", NULL */

/* What a texture shows beyond its edges. */
enum texture_wrap { TEXTURE_REPEAT, TEXTURE_CLAMP, TEXTURE_MIRROR };

/* A picture that is interpolated bilinearly. 8-bit code values are sRGB, unless they are data;
 * float ones are linear. Row 0 is at the top, texture coordinate v runs upwards. */
struct texture {
	struct image image;
	enum texture_wrap wrap[2]; /* across and down */
	bool nearest;		   /* texels are squares */
	float decode[256];	   /* linear value of each 8-bit code */
};

/* A texture that is looked up at
 *     (u, v) = (place[0] s + place[1] t + place[2], place[3] s + place[4] t + place[5])
 * with (s, t) of one of a part's two sets of coordinates. */
struct texture_use {
	const struct texture *texture; /* NULL: none */
	int set;
	float place[6];
};

/* A texture that changes the surface from point to point. */
struct surface_map {
	struct texture_use use;
	bool glossiness;     /* RGB is specular, alpha glossiness; else G roughness, B metalness */
	struct rgb base;     /* colour of a metal, and of the base of anything else */
	struct rgb specular; /* of what is no metal */
	float metallic, roughness; /* factors of the texture; glossiness: 1 - roughness is one */
};

enum alpha_mode { ALPHA_OPAQUE, ALPHA_MASK, ALPHA_BLEND };

struct material {
	enum material_kind kind;
	struct rgb colour;	       /* 0..1: albedo of the base; transmittance of glass */
	struct rgb specular;	       /* 0..1: the coat's reflectance at normal incidence */
	struct rgb metal;	       /* the share of specular that the texture multiplies too */
	float roughness;	       /* 0..1; GGX alpha is its square */
	float ior;		       /* glass: index of refraction */
	bool thin;		       /* glass: one surface stands for a whole pane */
	const struct texture *texture; /* multiplies colour; NULL for none */
	struct texture_use placed;     /* the same, if it is not at the first coordinates */
	struct surface_map map;	       /* if it has a texture, the values above are its means */
	struct texture_use bumps;      /* normals in tangent space */
	float bump_scale;
	enum alpha_mode
		alpha_mode;	/* rays miss the surface where alpha is below cut, or by chance */
	float alpha, alpha_cut; /* alpha is multiplied by that of texture and vertices */
};

/* Where a material is looked up. */
struct material_point {
	float uv[2][2];
	struct rgb colour; /* of the vertices, multiplies colour */
	float alpha;	   /* of the vertices */
};

/* A material at a point: the texture looked up, roughness as GGX alpha. */
struct bsdf {
	enum material_kind kind;
	struct rgb colour;
	struct rgb specular;
	float alpha;
	float ior;
	bool thin;
	struct coat_energy energy; /* of glossy, for the strongest channel */
};

/* Fills decode; call it after image is set. */
void texture_prepare(struct texture *texture);
void texture_prepare_data(struct texture *texture); /* code values are no light: value / 255 */
struct rgb texture_at(const struct texture *texture, float u, float v);
float texture_alpha_at(const struct texture *texture, float u, float v);

/* Adds size and texels to a hash. */
void texture_hash(const struct texture *texture, XXH3_state_t *state);

/* Adds all values of a material, but for its textures' texels. */
void material_hash(const struct material *material, XXH3_state_t *state);

struct bsdf material_at_point(const struct material *material, const struct material_point *point);

/* The same on a part without colours. */
static inline struct bsdf material_at(const struct material *material, float u, float v)
{
	const struct material_point point = {{{u, v}, {u, v}}, {{1, 1, 1}}, 1};

	return material_at_point(material, &point);
}

/* Finds where a texture is looked up. */
void texture_use_place(const struct texture_use *use, const struct material_point *point,
		       float uv[2]);

/* The share of rays that meet the surface. */
float material_coverage(const struct material *material, const struct material_point *point);

/* The normal of the bumps: axes of the texture along u and v, and the surface's normal. */
struct v3 material_bump(const struct material *material, const struct material_point *point,
			struct v3 along_u, struct v3 along_v, struct v3 normal);

/*
 * Scattering of the base for light from wi towards wo, as a factor on that of a Lambert surface:
 *     f = colour / pi * bsdf_base(bsdf, n . wo, n . wi)
 * It is 1 for diffuse surfaces.
 */
float bsdf_base(const struct bsdf *bsdf, float cos_o, float cos_i);

/* Mean of bsdf_base() over light from all directions: the base's albedo towards wo over colour. */
float bsdf_base_mean(const struct bsdf *bsdf, float cos_o);

/* Scattering of the coat: f * cos_i for light from wi towards wo, and the density (per sr) with
 * which bsdf_coat_sample() draws wi. Both are 0 below the surface. */
struct rgb bsdf_coat(const struct bsdf *bsdf, struct v3 n, struct v3 wo, struct v3 wi,
		     float *density);

/* Draws a direction wi from the coat's visible normals. False when it lies below the surface. */
bool bsdf_coat_sample(const struct bsdf *bsdf, struct v3 n, struct v3 wo, struct random *random,
		      struct v3 *wi);

/* Tells whether light that passes goes straight on: such glass throws no dark shadow. */
static inline bool bsdf_is_pane(const struct bsdf *bsdf)
{
	return bsdf->kind == MATERIAL_GLASS && (bsdf->thin || bsdf->ior == 1);
}

/* The two directions in which light goes on at a glass surface. */
struct glass_ways {
	float reflectance; /* by Fresnel; 1: nothing passes, and passed is not set */
	struct v3 mirrored, passed;
};

/*
 * Reflects and refracts wo. entering: wo is on the outer side of n. Mirrored light is not tinted;
 * light that passes is multiplied by colour. Thin glass is two surfaces at once: its reflectance
 * includes the reflections between them, light is tinted once and passes straight.
 */
struct glass_ways bsdf_glass_ways(const struct bsdf *bsdf, struct v3 n, bool entering,
				  struct v3 wo);

/* Draws one of the two directions: the mirrored one with the probability of the reflectance. The
 * weight is the tint where light passes, 1 where it is mirrored. */
struct v3 bsdf_glass_sample(const struct bsdf *bsdf, struct v3 n, bool entering, struct v3 wo,
			    struct random *random, struct rgb *weight);

/* Maps a point of the unit square to a direction around n, cosine-weighted. */
struct v3 hemisphere_cosine(struct v3 n, float u, float v);

/* Maps the unit square to the unit disc, uniformly in area (Shirley and Chiu 1997). */
void disc_from_square(float u, float v, float *x, float *y);

#endif
