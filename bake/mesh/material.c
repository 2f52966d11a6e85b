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

static struct rgb texture_texel(const struct texture *texture, int x, int y)
{
	const struct image *image = &texture->image;
	const size_t at = 3 * ((size_t)y * (size_t)image->width + (size_t)x);

	if (image->f32)
		return rgb_make(image->f32[at], image->f32[at + 1], image->f32[at + 2]);
	return rgb_make(texture->decode[image->u8[at]], texture->decode[image->u8[at + 1]],
			texture->decode[image->u8[at + 2]]);
}

static int texture_wrap(int i, int n)
{
	i %= n;
	return i < 0 ? i + n : i;
}

struct rgb texture_at(const struct texture *texture, float u, float v)
{
	const int w = texture->image.width, h = texture->image.height;
	const float x = (u - floorf(u)) * (float)w - 0.5f;
	const float y = (1 - (v - floorf(v))) * (float)h - 0.5f;
	const float fx = x - floorf(x), fy = y - floorf(y);
	const int x0 = texture_wrap((int)floorf(x), w), x1 = texture_wrap(x0 + 1, w);
	const int y0 = texture_wrap((int)floorf(y), h), y1 = texture_wrap(y0 + 1, h);
	const struct rgb top = rgb_add(rgb_scale(texture_texel(texture, x0, y0), 1 - fx),
				       rgb_scale(texture_texel(texture, x1, y0), fx));
	const struct rgb low = rgb_add(rgb_scale(texture_texel(texture, x0, y1), 1 - fx),
				       rgb_scale(texture_texel(texture, x1, y1), fx));

	return rgb_add(rgb_scale(top, 1 - fy), rgb_scale(low, fy));
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
}

struct bsdf material_at(const struct material *material, float u, float v)
{
	struct bsdf bsdf = {
		.kind = material->kind,
		.colour = material->colour,
		.specular = material->specular,
		.alpha = fmaxf(material->roughness * material->roughness, ALPHA_MIN),
		.ior = material->ior,
		.thin = material->thin,
	};

	if (material->texture) {
		const struct rgb texel = texture_at(material->texture, u, v);

		bsdf.colour = rgb_mul(bsdf.colour, texel);
		for (int c = 0; c < 3; c++)
			bsdf.specular.c[c] -= material->metal.c[c] * (1 - fminf(texel.c[c], 1));
	}
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
