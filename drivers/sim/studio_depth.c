/* SPDX-License-Identifier: MIT */
#include "drivers/sim/studio_depth.h"

#include <math.h>

#include "drivers/sim/sensor.h"

#define EDGE 0.1f

/* How much farther along the axis it is for each metre along the ray of a pixel. */
static double along_axis(const struct sim_eye *eye, int x, int y, double origin[3], double dir[3])
{
	const double *axis = &eye->camera.rotation[6];

	if (!eye_ray(eye, (double[2]){x + 0.5, y + 0.5}, origin, dir))
		return 0;
	return axis[0] * dir[0] + axis[1] * dir[1] + axis[2] * dir[2];
}

void studio_depth_room(const struct studio_view *view, const struct studio_lamps *lamps, float *z)
{
	const struct sim_eye *eye = studio_view_eye(view);

	for (int y = 0; y < eye->height; y++)
		for (int x = 0; x < eye->width; x++) {
			double origin[3], dir[3];
			const double along = along_axis(eye, x, y, origin, dir);
			struct studio_hit hit;
			float *to = &z[y * eye->width + x];

			*to = 0;
			if (along > 0 && studio_hit(origin, dir, &hit) &&
			    studio_lantern_hit(lamps, origin, dir, hit.distance) < 0)
				*to = (float)(along * hit.distance);
		}
}

void studio_depth_people(const struct studio_view *view, const struct studio_layer *layer, float *z)
{
	const struct sim_eye *eye = studio_view_eye(view);

	for (int y = 0; y < eye->height; y++)
		for (int x = 0; x < eye->width; x++) {
			const int k = y * eye->width + x;
			double origin[3], dir[3];

			if (layer[k].alpha >= 0.5f)
				z[k] = (float)(along_axis(eye, x, y, origin, dir) *
					       (double)layer[k].depth);
		}
}

static bool is_edge(const float *z, int width, int height, int x, int y)
{
	const float here = z[y * width + x];

	for (int n = 0; n < 4; n++) {
		const int u = x + (n == 0) - (n == 1), v = y + (n == 2) - (n == 3);

		if (u >= 0 && v >= 0 && u < width && v < height &&
		    fabsf(z[v * width + u] - here) > EDGE * here)
			return true;
	}
	return false;
}

void studio_depth_measure(const struct studio_depth_sensor *sensor, uint64_t frame, const float *z,
			  int width, int height, uint8_t *words)
{
	const uint64_t key = sensor_chance((uint64_t)(int64_t)sensor->seed ^ frame << 32);

	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			const int k = y * width + x;
			const double m = (double)z[k];
			const double mm = 1000 * m +
					  sensor->noise_mm * m * m *
						  (double)sensor_gauss(key + (uint64_t)k);
			const bool known = m > 0 && mm >= 1 && mm < 65535 &&
					   !is_edge(z, width, height, x, y);
			const int word = known ? (int)(mm + 0.5) : 0;

			words[2 * k] = (uint8_t)word;
			words[2 * k + 1] = (uint8_t)(word >> 8);
		}
}
