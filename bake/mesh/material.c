/* SPDX-License-Identifier: MIT */
#include "bake/mesh/material.h"

#include <stddef.h>

#include "hal/colour/transfer.h"

#define ALPHA_MIN 1e-3f	 /* as near to a mirror as single precision allows */
#define BASE_LEAST 1e-6f /* what a white metal leaves to its base is 0 / 0 */

const char *const material_kind_names[] = {"diffuse", "glossy", "glass", NULL};

void texture_prepare(struct texture *texture)
{
	for (int code = 0; code < 256; code++)
		texture->decode[code] = (float)transfer_decode(TRANSFER_SRGB, code / 255.0);
}

void texture_prepare_data(struct texture *texture)
{
	for (int code = 0; code < 256; code++)
		texture->decode[code] = (float)code / 255;
}

static struct rgb texture_texel(const struct texture *texture, int x, int y)
{
	const struct image *image = &texture->image;
	const size_t at = 3 * ((size_t)y * (size_t)image->width + (size_t)x);

	if (image->f32)
		return rgb_make(image->f32[at], image->f32[at + 1], image->f32[at + 2]);
	return rgb_make(texture->decode[image->u8[at]], texture->decode[image->u8[at + 1]],
			texture->decode[image->u8[at + 2]]);
}

/* The two texels of a row or column that a coordinate lies between. */
struct between {
	int texel[2];
	float share; /* of the second */
};

static int wrap_texel(int i, int n, enum texture_wrap wrap)
{
	if (wrap != TEXTURE_REPEAT)
		return i < 0 ? 0 : i >= n ? n - 1 : i;
	i %= n;
	return i < 0 ? i + n : i;
}

/* at: 0..1 from edge to edge, of n texels */
static struct between find_between(float at, int n, enum texture_wrap wrap, bool nearest)
{
	const float x = at * (float)n - 0.5f;
	const int first = (int)floorf(x);
	struct between b = {{wrap_texel(first, n, wrap), wrap_texel(first + 1, n, wrap)},
			    x - floorf(x)};

	if (nearest)
		b.share = b.share >= 0.5f;
	return b;
}

/* Brings a coordinate to 0..1. */
static float wrap_coordinate(float u, enum texture_wrap wrap)
{
	const float part = u - floorf(u);

	if (wrap == TEXTURE_CLAMP)
		return fminf(fmaxf(u, 0), 1);
	if (wrap == TEXTURE_MIRROR && fmodf(floorf(u), 2) != 0)
		return 1 - part;
	return part;
}

static void texture_find(const struct texture *texture, float u, float v, struct between *across,
			 struct between *down)
{
	const enum texture_wrap *wrap = texture->wrap;

	*across = find_between(wrap_coordinate(u, wrap[0]), texture->image.width, wrap[0],
			       texture->nearest);
	*down = find_between(1 - wrap_coordinate(v, wrap[1]), texture->image.height, wrap[1],
			     texture->nearest);
}

struct rgb texture_at(const struct texture *texture, float u, float v)
{
	struct between across, down;
	struct rgb row[2];

	texture_find(texture, u, v, &across, &down);
	for (int k = 0; k < 2; k++)
		row[k] = rgb_add(rgb_scale(texture_texel(texture, across.texel[0], down.texel[k]),
					   1 - across.share),
				 rgb_scale(texture_texel(texture, across.texel[1], down.texel[k]),
					   across.share));
	return rgb_add(rgb_scale(row[0], 1 - down.share), rgb_scale(row[1], down.share));
}

float texture_alpha_at(const struct texture *texture, float u, float v)
{
	const uint8_t *alpha = texture->image.alpha;
	const size_t w = (size_t)texture->image.width;
	struct between across, down;
	float row[2];

	if (!alpha)
		return 1;
	texture_find(texture, u, v, &across, &down);
	for (int k = 0; k < 2; k++) {
		const uint8_t *line = alpha + (size_t)down.texel[k] * w;

		row[k] = (float)line[across.texel[0]] * (1 - across.share) +
			 (float)line[across.texel[1]] * across.share;
	}
	return (row[0] * (1 - down.share) + row[1] * down.share) / 255;
}

void texture_hash(const struct texture *texture, XXH3_state_t *state)
{
	const struct image *image = &texture->image;
	const size_t values = 3 * (size_t)image->width * (size_t)image->height;

	XXH3_64bits_update(state, &image->width, sizeof(image->width));
	XXH3_64bits_update(state, &image->height, sizeof(image->height));
	if (image->u8)
		XXH3_64bits_update(state, image->u8, values);
	else
		XXH3_64bits_update(state, image->f32, values * sizeof(float));
	if (image->alpha)
		XXH3_64bits_update(state, image->alpha, values / 3);
	for (int k = 0; k < 2; k++)
		if (texture->wrap[k] != TEXTURE_REPEAT)
			XXH3_64bits_update(state, &texture->wrap[k], sizeof(texture->wrap[k]));
	if (texture->nearest)
		XXH3_64bits_update(state, &texture->nearest, sizeof(texture->nearest));
}

static void use_hash(const struct texture_use *use, XXH3_state_t *state)
{
	if (!use->texture)
		return;
	XXH3_64bits_update(state, &use->set, sizeof(use->set));
	XXH3_64bits_update(state, use->place, sizeof(use->place));
}

void material_hash(const struct material *m, XXH3_state_t *state)
{
	XXH3_64bits_update(state, &m->kind, sizeof(m->kind));
	XXH3_64bits_update(state, &m->colour, sizeof(m->colour));
	XXH3_64bits_update(state, &m->specular, sizeof(m->specular));
	XXH3_64bits_update(state, &m->metal, sizeof(m->metal));
	XXH3_64bits_update(state, &m->roughness, sizeof(m->roughness));
	XXH3_64bits_update(state, &m->ior, sizeof(m->ior));
	if (m->thin)
		XXH3_64bits_update(state, &m->thin, sizeof(m->thin));
	use_hash(&m->placed, state);
	use_hash(&m->bumps, state);
	if (m->bumps.texture)
		XXH3_64bits_update(state, &m->bump_scale, sizeof(m->bump_scale));
	use_hash(&m->map.use, state);
	if (m->map.use.texture) {
		XXH3_64bits_update(state, &m->map.base, sizeof(m->map.base));
		XXH3_64bits_update(state, &m->map.specular, sizeof(m->map.specular));
		XXH3_64bits_update(state, &m->map.metallic, sizeof(m->map.metallic));
		XXH3_64bits_update(state, &m->map.roughness, sizeof(m->map.roughness));
	}
	if (m->alpha_mode != ALPHA_OPAQUE) {
		XXH3_64bits_update(state, &m->alpha_mode, sizeof(m->alpha_mode));
		XXH3_64bits_update(state, &m->alpha, sizeof(m->alpha));
		XXH3_64bits_update(state, &m->alpha_cut, sizeof(m->alpha_cut));
	}
}

void texture_use_place(const struct texture_use *use, const struct material_point *point,
		       float uv[2])
{
	const float *at = point->uv[use->set], *p = use->place;

	uv[0] = p[0] * at[0] + p[1] * at[1] + p[2];
	uv[1] = p[3] * at[0] + p[4] * at[1] + p[5];
}

/* Finds the texture of the colour, and where it is looked up. */
static const struct texture *colour_texture(const struct material *material,
					    const struct material_point *point, float uv[2])
{
	if (material->placed.texture) {
		texture_use_place(&material->placed, point, uv);
		return material->placed.texture;
	}
	uv[0] = point->uv[0][0];
	uv[1] = point->uv[0][1];
	return material->texture;
}

/* Sets what the map changes. tint: of texture and vertices. */
static void apply_map(const struct surface_map *map, const struct material_point *point,
		      struct rgb tint, struct bsdf *bsdf)
{
	const struct rgb base = rgb_mul(map->base, tint);
	float uv[2], roughness, metal;
	struct rgb texel;

	texture_use_place(&map->use, point, uv);
	texel = texture_at(map->use.texture, uv[0], uv[1]);
	if (map->glossiness) {
		const float gloss = texture_alpha_at(map->use.texture, uv[0], uv[1]);

		roughness = 1 - (1 - map->roughness) * gloss;
		bsdf->specular = rgb_mul(map->specular, texel);
		bsdf->colour = rgb_scale(base, 1 - rgb_peak(bsdf->specular));
	} else {
		roughness = map->roughness * texel.c[1];
		metal = map->metallic * texel.c[2];
		bsdf->specular = rgb_add(rgb_scale(map->specular, 1 - metal),
					 rgb_scale(base, metal));
		bsdf->colour = rgb_scale(base, 1 - metal);
	}
	bsdf->alpha = fmaxf(roughness * roughness, ALPHA_MIN);
}

float material_coverage(const struct material *material, const struct material_point *point)
{
	float uv[2], alpha = material->alpha * point->alpha;
	const struct texture *texture = colour_texture(material, point, uv);

	if (material->alpha_mode == ALPHA_OPAQUE)
		return 1;
	if (texture)
		alpha *= texture_alpha_at(texture, uv[0], uv[1]);
	if (material->alpha_mode == ALPHA_MASK)
		return alpha >= material->alpha_cut;
	return fminf(alpha, 1);
}

struct v3 material_bump(const struct material *material, const struct material_point *point,
			struct v3 along_u, struct v3 along_v, struct v3 normal)
{
	const struct v3 u = v3_unit(v3_mad(along_u, -v3_dot(along_u, normal), normal));
	struct v3 v = v3_cross(normal, u), local;
	struct rgb texel;
	float uv[2];

	if (v3_dot(v, along_v) < 0)
		v = v3_scale(v, -1);
	texture_use_place(&material->bumps, point, uv);
	texel = texture_at(material->bumps.texture, uv[0], uv[1]);
	local = v3_make((2 * texel.c[0] - 1) * material->bump_scale,
			(2 * texel.c[1] - 1) * material->bump_scale, 2 * texel.c[2] - 1);
	return v3_unit(v3_from_frame(local, u, v, normal));
}

struct bsdf material_at_point(const struct material *material, const struct material_point *point)
{
	float uv[2];
	const struct texture *texture = colour_texture(material, point, uv);
	struct rgb tint = point->colour;
	struct bsdf bsdf = {
		.kind = material->kind,
		.colour = material->colour,
		.specular = material->specular,
		.alpha = fmaxf(material->roughness * material->roughness, ALPHA_MIN),
		.ior = material->ior,
		.thin = material->thin,
	};

	if (texture)
		tint = rgb_mul(tint, texture_at(texture, uv[0], uv[1]));
	bsdf.colour = rgb_mul(bsdf.colour, tint);
	for (int c = 0; c < 3; c++)
		bsdf.specular.c[c] -= material->metal.c[c] * (1 - fminf(tint.c[c], 1));
	if (material->map.use.texture)
		apply_map(&material->map, point, tint, &bsdf);
	for (int c = 0; c < 3; c++)
		bsdf.colour.c[c] = fminf(bsdf.colour.c[c], 1);
	if (bsdf.kind == MATERIAL_GLOSSY)
		coat_energy_find(&bsdf.energy, bsdf.alpha, rgb_peak(bsdf.specular));
	return bsdf;
}

/* (1 - c)^5 */
static float schlick_power(float c)
{
	const float m = fminf(fmaxf(1 - c, 0), 1);

	return m * m * m * m * m;
}

/* The coat of the strongest channel counts, so that no channel can gain energy. */
float bsdf_base(const struct bsdf *bsdf, float cos_o, float cos_i)
{
	if (bsdf->kind == MATERIAL_DIFFUSE)
		return 1;
	return bsdf_base_mean(bsdf, cos_o) * coat_energy_at(bsdf->energy.base, cos_i) /
	       fmaxf(bsdf->energy.base_mean, BASE_LEAST);
}

float bsdf_base_mean(const struct bsdf *bsdf, float cos_o)
{
	return bsdf->kind == MATERIAL_DIFFUSE ? 1 : coat_energy_at(bsdf->energy.base, cos_o);
}

static float ggx_lambda(float alpha, float c)
{
	const float tangent2 = fmaxf(1 - c * c, 0) / fmaxf(c * c, 1e-12f);

	return 0.5f * (sqrtf(1 + alpha * alpha * tangent2) - 1);
}

struct rgb bsdf_coat(const struct bsdf *bsdf, struct v3 n, struct v3 wo, struct v3 wi,
		     float *density)
{
	const float cos_o = v3_dot(n, wo), cos_i = v3_dot(n, wi);
	struct rgb f = {{0, 0, 0}};
	struct v3 h;
	float nh, oh, power, shape, gain;

	*density = 0;
	if (bsdf->kind != MATERIAL_GLOSSY || cos_o <= 0 || cos_i <= 0)
		return f;
	h = v3_unit(v3_add(wo, wi));
	nh = v3_dot(n, h);
	oh = v3_dot(wo, h);
	{
		const float a2 = bsdf->alpha * bsdf->alpha;
		/* for narrow lobes |n x h|^2 keeps the digits that 1 - (n.h)^2 cancels */
		const struct v3 across = v3_cross(n, h);
		const float root = v3_dot(across, across) + a2 * nh * nh;
		const float d = a2 / (PI_F * root * root);
		const float lambda_o = ggx_lambda(bsdf->alpha, cos_o);
		const float lambda_i = ggx_lambda(bsdf->alpha, cos_i);

		shape = d / (4 * cos_o * (1 + lambda_o + lambda_i));
		*density = d / (4 * cos_o * (1 + lambda_o));
	}
	power = schlick_power(oh);
	gain = coat_energy_at(bsdf->energy.gain, cos_o);
	for (int c = 0; c < 3; c++) {
		const float once = bsdf->specular.c[c] + (1 - bsdf->specular.c[c]) * power;

		f.c[c] = shape * once * (1 + bsdf->specular.c[c] * gain);
	}
	return f;
}

/* Heitz, Sampling the GGX Distribution of Visible Normals (2018). */
bool bsdf_coat_sample(const struct bsdf *bsdf, struct v3 n, struct v3 wo, struct random *random,
		      struct v3 *wi)
{
	const float alpha = bsdf->alpha;
	struct v3 s, t, view, s2, t2, h;
	float x, y, lift, blend;

	v3_frame(n, &s, &t);
	view = v3_unit(
		v3_make(alpha * v3_dot(wo, s), alpha * v3_dot(wo, t), fmaxf(v3_dot(wo, n), 1e-6f)));
	v3_frame(view, &s2, &t2);
	/* Heitz shrinks the half of the disc towards t2: t2 must point towards the normal. */
	if (view.x * view.x + view.y * view.y > 0) {
		s2 = v3_unit(v3_make(-view.y, view.x, 0));
		t2 = v3_cross(view, s2);
	}
	{
		const float u = random_next(random), v = random_next(random);
		const float r = sqrtf(u), phi = 2 * PI_F * v;

		x = r * cosf(phi);
		y = r * sinf(phi);
	}
	blend = 0.5f * (1 + view.z);
	y = (1 - blend) * sqrtf(fmaxf(1 - x * x, 0)) + blend * y;
	lift = sqrtf(fmaxf(1 - x * x - y * y, 0));
	h = v3_from_frame(v3_make(x, y, lift), s2, t2, view);
	h = v3_unit(v3_make(alpha * h.x, alpha * h.y, fmaxf(h.z, 0)));
	h = v3_from_frame(h, s, t, n);
	*wi = v3_unit(v3_sub(v3_scale(h, 2 * v3_dot(wo, h)), wo));
	return v3_dot(*wi, n) > 0;
}

struct glass_ways bsdf_glass_ways(const struct bsdf *bsdf, struct v3 n, bool entering, struct v3 wo)
{
	const bool dense = entering || bsdf->thin;
	const float ratio = dense ? 1 / bsdf->ior : bsdf->ior; /* outside over inside */
	const float cos_o = fminf(fmaxf(v3_dot(n, wo), 0), 1);
	const float sin2 = ratio * ratio * (1 - cos_o * cos_o);
	struct glass_ways ways = {1, v3_unit(v3_sub(v3_scale(n, 2 * cos_o), wo)), {0, 0, 0}};

	if (sin2 < 1) {
		const float cos_t = sqrtf(1 - sin2);
		const float s = (ratio * cos_o - cos_t) / (ratio * cos_o + cos_t);
		const float p = (cos_o - ratio * cos_t) / (cos_o + ratio * cos_t);

		ways.reflectance = 0.5f * (s * s + p * p);
		ways.passed =
			v3_unit(v3_sub(v3_scale(n, ratio * cos_o - cos_t), v3_scale(wo, ratio)));
	}
	if (bsdf->thin)
		ways.reflectance = 2 * ways.reflectance / (1 + ways.reflectance);
	if (bsdf_is_pane(bsdf))
		ways.passed = v3_scale(wo, -1);
	if (bsdf->ior == 1)
		ways.reflectance = 0; /* without rounding */
	return ways;
}

struct v3 bsdf_glass_sample(const struct bsdf *bsdf, struct v3 n, bool entering, struct v3 wo,
			    struct random *random, struct rgb *weight)
{
	const struct glass_ways ways = bsdf_glass_ways(bsdf, n, entering, wo);

	if (random_next(random) < ways.reflectance) {
		*weight = rgb_make(1, 1, 1);
		return ways.mirrored;
	}
	*weight = bsdf->colour;
	return ways.passed;
}

void disc_from_square(float u, float v, float *x, float *y)
{
	const float a = 2 * u - 1, b = 2 * v - 1;
	float r, phi;

	if (a == 0 && b == 0) {
		*x = *y = 0;
		return;
	}
	if (fabsf(a) > fabsf(b)) {
		r = a;
		phi = PI_F / 4 * (b / a);
	} else {
		r = b;
		phi = PI_F / 2 - PI_F / 4 * (a / b);
	}
	*x = r * cosf(phi);
	*y = r * sinf(phi);
}

struct v3 hemisphere_cosine(struct v3 n, float u, float v)
{
	struct v3 s, t;
	float x, y;

	disc_from_square(u, v, &x, &y);
	v3_frame(n, &s, &t);
	return v3_from_frame(v3_make(x, y, sqrtf(fmaxf(1 - x * x - y * y, 0))), s, t, n);
}
