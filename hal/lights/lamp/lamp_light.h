/* SPDX-License-Identifier: MIT */
/*
 * Takes the light of lamps at places out of the lights of a dome. A lamp of power P in a direction
 * from the fisheye gives the cells i around it P b_i of what they have above the surroundings, with
 * b_i of dome_placed_share() over the lamp's disc. P is fitted, with how far the lamp is from where
 * it is said to be, so that what else is bright there is not its:
 *
 *     x_i = w_i max(L_i - s, 0)      x ~ P b + g1 db/du + g2 db/dv      least squares
 *     taken_i = x_i, but at least 0 and at most 1.1 of the fit                P = sum of taken_i
 *
 * in each channel, where s is the median of the cells around these. So no light counts twice, and
 * none is lost. All of it works after exposures, recovery and filter, which know nothing of lamps.
 */
#ifndef INLAY_HAL_LIGHTS_LAMP_LAMP_LIGHT_H
#define INLAY_HAL_LIGHTS_LAMP_LAMP_LIGHT_H

#include <stdbool.h>

#include "hal/lights/lamps.h"
#include "hal/optics/dome_placed.h"

/* Where a lamp is seen from the fisheye, and its angular radius. False: below its horizon. */
bool lamp_light_seen(const struct lamps *lamps, int lamp, double direction[3], double *radius_rad);

struct lamp_light;

/* placed NULL: a light is all that is in its cell. Both outlive it. -ENOMEM. */
int lamp_light_create(struct lamp_light **light, const struct dome *dome,
		      const struct dome_placed *placed, const struct lamps *lamps);

/* Goes on with as many other lamps. Needs no memory. */
void lamp_light_aim(struct lamp_light *light, const struct lamps *lamps);

void lamp_light_destroy(struct lamp_light *light); /* NULL is harmless */

/* radiance[lights]: changed as above. power[lamps]: P; 0 of a lamp below the fisheye's horizon. */
void lamp_light_take(struct lamp_light *light, float (*radiance)[3], double (*power)[3]);

#endif
