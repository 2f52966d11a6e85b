/* SPDX-License-Identifier: MIT */
/*
 * The studio as a depth camera measures it, in mm along the camera's axis:
 *
 *     measured = z + noise * z^2 * gauss    rounded; z in m, noise: the standard deviation in mm at 1 m
 *
 * as cameras do that find depth by triangulation. 0, not known: where a neighbour is nearer or farther by
 * a tenth, because at edges one of the two eyes sees something else; on a lantern, which blinds it; beyond
 * 65.535 m.
 */
#ifndef INLAY_DRIVERS_SIM_STUDIO_DEPTH_H
#define INLAY_DRIVERS_SIM_STUDIO_DEPTH_H

#include "drivers/sim/studio_people.h"

/* Computes the depth of the empty room, z[height][width] in m; 0: a lantern. The view is a perspective
 * one. */
void studio_depth_room(const struct studio_view *view, const struct studio_lamps *lamps, float *z);

/* Puts bodies over it, where they cover half of a pixel. */
void studio_depth_people(const struct studio_view *view, const struct studio_layer *layer,
			 float *z);

struct studio_depth_sensor {
	double noise_mm;
	int seed;
};

/* Measures a frame, whose number selects the noise: words[height][width], little-endian. */
void studio_depth_measure(const struct studio_depth_sensor *sensor, uint64_t frame, const float *z,
			  int width, int height, uint8_t *words);

#endif
