/* SPDX-License-Identifier: MIT */
#include "drivers/sim/sim.h"

#include <string.h>

#include "hal/optics/vec.h"

bool eye_ray(const struct sim_eye *eye, const double px[2], double origin[3], double dir[3])
{
	if (!eye->fisheye)
		return tsai_ray(&eye->camera, px, origin, dir) == 0;
	memcpy(origin, eye->position, sizeof(eye->position));
	return fisheye_ray(&eye->lens, px, dir);
}

/* Angle between the rays of two points, per pixel of their distance: rad/px. The chord stands for
 * the angle. */
static double eye_ray_spread(const struct sim_eye *eye, const double a[2], const double b[2])
{
	double origin[3], from[3], to[3], chord[3];

	if (!eye_ray(eye, a, origin, from) || !eye_ray(eye, b, origin, to))
		return 0;
	for (int i = 0; i < 3; i++)
		chord[i] = to[i] - from[i];
	return vec_length(chord) / hypot(b[0] - a[0], b[1] - a[1]);
}

double eye_pixel_rad(const struct sim_eye *eye, const double px[2])
{
	const double left[2] = {px[0] - 0.25, px[1]}, right[2] = {px[0] + 0.25, px[1]};
	const double above[2] = {px[0], px[1] - 0.25}, below[2] = {px[0], px[1] + 0.25};

	return (eye_ray_spread(eye, left, right) + eye_ray_spread(eye, above, below)) / 2;
}

bool eye_on_rim(const struct sim_eye *eye, int x, int y)
{
	int seen = 0;

	for (int k = 0; eye->fisheye && k < 4; k++) {
		const double corner[2] = {x + k % 2, y + k / 2};
		double origin[3], dir[3];

		seen += eye_ray(eye, corner, origin, dir);
	}
	return seen % 4 != 0;
}

double eye_along_axis(const struct sim_eye *eye, int x, int y, double origin[3], double dir[3])
{
	const double *axis = &eye->camera.rotation[6];

	if (!eye_ray(eye, (double[2]){x + 0.5, y + 0.5}, origin, dir))
		return 0;
	return vec_dot(axis, dir);
}
