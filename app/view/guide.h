/* SPDX-License-Identifier: MIT */
/*
 * What helps to set a kiosk up by eye: the calibrated ground drawn into the background's picture,
 * and the directions of the world into the fisheye's.
 */
#ifndef INLAY_APP_VIEW_GUIDE_H
#define INLAY_APP_VIEW_GUIDE_H

#include <stdbool.h>

#include "config/config.h"
#include "hal/frame/frame.h"
#include "hal/lights/lamps.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"
#include "hal/optics/tsai.h"

#define GUIDE_LIGHTS 3 /* brightest lights that are named */

/* Distance of the grid's lines, in the scene's units: 1, 2 or 5 times a power of ten, of which
 * about eight cross the middle of the picture. 0: the ground is not in the picture. */
double guide_spacing(const struct tsai_camera *camera);

/* The lamps at places, borrowed. */
struct guide_lamps {
	const struct lamps *lamps; /* NULL: there are none */
	const char (*name)[CONFIG_NAME_MAX];
	const bool *missing; /* those that show no light */
};

/*
 * Draws the ground's grid, the axes X, Y, Z from the origin, the horizon, the object's outline, and
 * from each lamp's foot on the ground a line up to the lamp, as far as that is in the picture.
 * The canvas has the camera's size. coverage[height][width], 65535 is 1; NULL: there is no outline.
 */
void guide_draw_ground(struct canvas *canvas, const struct tsai_camera *camera,
		       const uint16_t *coverage, const struct guide_lamps *lamps, double letter_px);

/* A light that stands out, by its number in the dome. */
struct guide_light {
	int light;
	double azimuth_deg; /* from +X towards +Y, 0..360 */
	double height_deg;
};

/* The brightest lights: at least three times as bright as the mean, and 20 degrees apart. Returns
 * their number, at most GUIDE_LIGHTS; 0 under an even sky. radiance[dome->count]. */
int guide_find_lights(const struct dome *dome, const float (*radiance)[3],
		      struct guide_light found[GUIDE_LIGHTS]);

/* Draws the edge of the lens's field, the horizon, the directions +X and +Y, the brightest lights
 * with azimuth and height, and a ring as large as each lamp where it has to be seen. lens is prepared for the canvas's size; radiance NULL: no
 * lights. */
void guide_draw_sky(struct canvas *canvas, const struct fisheye *lens, const struct dome *dome,
		    const float (*radiance)[3], const struct guide_lamps *lamps, double letter_px);

#endif
