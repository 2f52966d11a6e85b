/* SPDX-License-Identifier: MIT */
#include "tests/support/calibrate/fisheye_views.h"

#include <math.h>
#include <stdio.h>

#include "hal/optics/vec.h"

const struct fisheye_settings fisheye_views_lenses[FISHEYE_MODEL_COUNT] = {
	{.focal_px = {148, 139},
	 .centre_px = {322.4, 236.7},
	 .rotation_deg = {3, -4, 31},
	 .field_deg = 90,
	 .model = FISHEYE_EQUIDISTANT},
	{.focal_px = {163, 151},
	 .centre_px = {316.1, 243.2},
	 .rotation_deg = {-2, 5, -110},
	 .field_deg = 90,
	 .model = FISHEYE_EQUISOLID},
	{.focal_px = {117, 112},
	 .centre_px = {325.3, 238.9},
	 .rotation_deg = {1, 2, 3},
	 .field_deg = 90,
	 .model = FISHEYE_STEREOGRAPHIC},
	{.focal_px = {226, 219},
	 .centre_px = {318.8, 241.5},
	 .rotation_deg = {-6, 1, 75},
	 .field_deg = 88,
	 .model = FISHEYE_ORTHOGRAPHIC},
	{.focal_px = {150, 143},
	 .centre_px = {321.7, 239.2},
	 .rotation_deg = {2, 2, 160},
	 .field_deg = 90,
	 .model = FISHEYE_POLYNOMIAL,
	 .polynomial = {-0.04, 0.012, -0.006, 0.0008}},
};

static void fisheye_blur_px(struct chance *c, double sigma, double px[2])
{
	px[0] += sigma * chance_normal(c);
	px[1] += sigma * chance_normal(c);
}

void fisheye_views_begin(struct observations *all)
{
	*all = (struct observations){.width = 640, .height = 480};
}

void fisheye_see_board(struct observations *all, const struct fisheye *lens, double theta,
		       double phi, double bend, double sigma, struct chance *c)
{
	const double distance = chance_real(c, 0.2, 0.3), step = 0.05;
	double z[3] = {-sin(theta) * cos(phi), -sin(theta) * sin(phi), -cos(theta)};
	double x[3], y[3], middle[3], spin = chance_real(c, 0, 6.28);
	double by[3];
	char name[32];

	for (int i = 0; i < 3; i++)
		by[i] = bend > 0 ? bend * chance_normal(c) : 0;
	for (int i = 0; i < 3; i++) {
		middle[i] = -distance * z[i];
		z[i] += chance_real(c, -0.5, 0.5);
	}
	vec_normalize(z);
	vec_cross(z, (double[]){cos(spin), sin(spin), 0.3}, x);
	vec_normalize(x);
	vec_cross(z, x, y);
	snprintf(name, sizeof(name), "board %d", all->views + 1);
	observations_begin_view(all, name);
	for (int n = 0; n < 30; n++) {
		const double world[3] = {step * (n % 6), -step * (n / 6), 0};
		const double u = world[0] - 2.5 * step, v = world[1] + 2 * step;
		const double out = by[0] * u * u + by[1] * u * v + by[2] * v * v;
		double c3[3], dir[3], px[2];

		for (int i = 0; i < 3; i++)
			c3[i] = middle[i] + x[i] * u + y[i] * v + z[i] * out;
		mat_apply_transposed(lens->rotation, c3, dir);
		if (!fisheye_project(lens, dir, px))
			continue;
		fisheye_blur_px(c, sigma, px);
		observations_add(all, world, px, "%s corner %d,%d", name, n % 6, n / 6);
	}
}

void fisheye_see_boards(struct observations *all, const struct fisheye *lens, int count,
			double theta, double sigma, struct chance *c)
{
	fisheye_see_board(all, lens, 0.1, 0.4, 0, sigma, c);
	for (int k = 1; k < count; k++)
		fisheye_see_board(all, lens, theta * (k % 2 ? 1 : 0.6), 2 * M_PI * k / (count - 1),
				  0, sigma, c);
}
