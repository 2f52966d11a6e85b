/* SPDX-License-Identifier: MIT */
/* Glossy materials by themselves: what they reflect of light from everywhere, and how directions
 * are drawn from them. */
#include "bake/base/random.h"
#include "bake/mesh/material.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define COUNT(a) (int)(sizeof(a) / sizeof(*(a)))

static const struct v3 up = {0, 0, 1};
static const double cosines[] = {0.02, 0.05, 0.1, 0.2, 0.4, 0.6, 0.8, 1};

static struct bsdf glossy(float specular, float roughness)
{
	const struct material material = {.kind = MATERIAL_GLOSSY,
					  .colour = {{1, 1, 1}},
					  .specular = {{specular, specular, specular}},
					  .roughness = roughness};

	return material_at(&material, 0, 0);
}

static struct v3 from_cosine(double cosine)
{
	return v3_make((float)sqrt(1 - cosine * cosine), 0, (float)cosine);
}

/*
 * What the coat reflects of light 1 from everywhere towards wo, by a grid over its microfacets h:
 *     int f cos_i dwi = int f cos_i 4 (o . h) dh,  dh = du dphi / (2 pi D (n . h)),
 *     tan^2 theta_h = alpha^2 u / (1 - u),  u = v (2 - v), so that the long tail is not coarse
 */
static double coat_reflects(const struct bsdf *bsdf, struct v3 wo, double *density)
{
	const int steps = 300;
	const double a2 = (double)bsdf->alpha * (double)bsdf->alpha;
	double sum = 0;

	*density = 0;
	for (int i = 0; i < steps; i++)
		for (int j = 0; j < steps; j++) {
			const double v = (i + 0.5) / steps, u = v * (2 - v),
				     phi = M_PI * (j + 0.5) / steps;
			const double tan2 = a2 * u / (1 - u), nh = 1 / sqrt(1 + tan2);
			const double root = a2 * nh * nh + 1 - nh * nh, r = sqrt(1 - nh * nh);
			const double d = a2 / (M_PI * root * root);
			const struct v3 h = v3_make((float)(r * cos(phi)), (float)(r * sin(phi)),
						    (float)nh);
			const double oh = (double)v3_dot(wo, h);
			const double jacobian = 8 * (1 - v) * oh / (d * nh) / (steps * steps);
			float p;
			struct rgb f;

			if (oh <= 0)
				continue;
			f = bsdf_coat(bsdf, up, wo,
				      v3_unit(v3_sub(v3_scale(h, (float)(2 * oh)), wo)), &p);
			sum += (double)f.c[0] * jacobian;
			*density += (double)p * jacobian;
		}
	return sum;
}

/* The same of the base. */
static double base_reflects(const struct bsdf *bsdf, struct v3 wo)
{
	const int steps = 1000;
	double sum = 0;

	for (int i = 0; i < steps; i++) {
		const double z = (i + 0.5) / steps;

		sum += 2 * z * (double)bsdf_base(bsdf, wo.z, (float)z) / steps;
	}
	return sum;
}

/* A white metal reflects all light, seen from everywhere. */
TEST("a white metal stays white")
{
	double worst = 0;

	for (int r = 1; r <= 20; r++)
		for (int k = 0; k < COUNT(cosines); k++) {
			const struct bsdf bsdf = glossy(1, 0.05f * (float)r);
			double density;
			const double all = coat_reflects(&bsdf, from_cosine(cosines[k]), &density);

			expect_below(fabs(all - 1), 0.01, "roughness %.2f, cosine %g", 0.05 * r,
				     cosines[k]);
			expect_below(bsdf_base(&bsdf, 0.5f, 0.5f), 1e-6, "roughness %.2f",
				     0.05 * r);
			worst = fmax(worst, fabs(all - 1));
		}
	print_message("# white metals: off by %.4f at most\n", worst);
}

/* A white base under any coat gives all light back, and never more. */
TEST("a coat over white conserves")
{
	static const float specular[] = {0.02f, 0.04f, 0.08f, 0.3f, 0.6f, 0.95f};
	double least = 1, most = 1;

	for (int s = 0; s < COUNT(specular); s++)
		for (int r = 0; r <= 10; r++)
			for (int k = 0; k < COUNT(cosines); k++) {
				const struct bsdf bsdf = glossy(specular[s], 0.1f * (float)r);
				const struct v3 wo = from_cosine(cosines[k]);
				double density;
				const double base = base_reflects(&bsdf, wo);
				const double all = coat_reflects(&bsdf, wo, &density) + base;

				least = fmin(least, all);
				most = fmax(most, all);
				expect_below(fabs(base - (double)bsdf_base_mean(&bsdf, wo.z)), 1e-3,
					     "specular %g, roughness %.1f", (double)specular[s],
					     0.1 * r);
				expect_below(all, 1.004, "specular %g, roughness %.1f, cosine %g",
					     (double)specular[s], 0.1 * r, cosines[k]);
				expect_above(all, 0.995, "specular %g, roughness %.1f, cosine %g",
					     (double)specular[s], 0.1 * r, cosines[k]);
				expect_below(density, 1.002, "roughness %.1f", 0.1 * r);
			}
	print_message("# coats over white: %.4f to %.4f\n", least, most);
}

/* The base scatters alike both ways. */
TEST("a base is reciprocal")
{
	const struct bsdf bsdf = glossy(0.3f, 0.6f);

	for (int k = 0; k < COUNT(cosines); k++)
		for (int j = 0; j < k; j++) {
			const float a = (float)cosines[j], b = (float)cosines[k];

			expect_below(fabsf(bsdf_base(&bsdf, a, b) - bsdf_base(&bsdf, b, a)), 1e-6,
				     "%g and %g", (double)a, (double)b);
		}
}

/* Samples follow the density: the mean of f / density is the integral of f. */
TEST("samples follow the density")
{
	const struct bsdf bsdf = glossy(1, 0.55f);
	const struct v3 n = v3_unit(v3_make(0.3f, -0.5f, 0.7f));
	const struct v3 wo = v3_unit(v3_make(0.8f, -0.1f, 0.5f));
	struct random random = {7};
	const int count = 200000, steps = 800;
	double mean = 0, exact = 0;
	struct v3 s, t;

	v3_frame(n, &s, &t);
	for (int k = 0; k < count; k++) {
		struct v3 wi;
		float d;

		if (bsdf_coat_sample(&bsdf, n, wo, &random, &wi)) {
			const struct rgb f = bsdf_coat(&bsdf, n, wo, wi, &d);

			/* an uneven weight shows a lobe in the wrong place */
			mean += (double)(f.c[0] / d * (1 + wi.x)) / count;
		}
	}
	for (int j = 0; j < steps; j++)
		for (int i = 0; i < 2 * steps; i++) {
			const double z = (j + 0.5) / steps, phi = M_PI * (i + 0.5) / steps;
			const double r = sqrt(1 - z * z);
			const struct v3 wi = v3_from_frame(
				v3_make((float)(r * cos(phi)), (float)(r * sin(phi)), (float)z), s,
				t, n);
			float d;

			exact += (double)(bsdf_coat(&bsdf, n, wo, wi, &d).c[0] * (1 + wi.x)) *
				 M_PI / steps / steps;
		}
	expect_below(fabs(mean - exact), 0.005 * exact, "mean=%g", mean);
}
