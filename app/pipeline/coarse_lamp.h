/* SPDX-License-Identifier: MIT */
/*
 * Finds a lamp that shines where the dome is coarse, so that its shadow is softer than it is. A
 * cell i of radiance L holds a lamp if it gives the ground much more light than its neighbours
 * would:
 *
 *     share = (L_i - mean L of the neighbours) * projected solid angle_i / E
 *
 * with the irradiance E of a level ground. A lamp is there from a share of COARSE_LAMP_FROM on,
 * until less than COARSE_LAMP_UNTIL is left. Only where finer lights help: nodes farther apart than
 * COARSE_LAMP_APART_RAD, between those of the frequencies 18 and 36.
 */
#ifndef INLAY_APP_PIPELINE_COARSE_LAMP_H
#define INLAY_APP_PIPELINE_COARSE_LAMP_H

#include <stdbool.h>

#include "hal/optics/dome.h"

#define COARSE_LAMP_FROM 0.2
#define COARSE_LAMP_UNTIL 0.12
#define COARSE_LAMP_APART_RAD 0.044

struct coarse_lamp {
	bool there;
	double share;			/* 0: not there */
	double azimuth_deg, height_deg; /* of its cell; the azimuth from +X towards +Y */
};

/* Looks for the lamp with the largest share; *lamp is what was found before, or zeroed. Takes 20 ns
 * a light or so: for once a second. */
void coarse_lamp_find(struct coarse_lamp *lamp, const struct dome *dome,
		      const float (*radiance)[3]);

#endif
