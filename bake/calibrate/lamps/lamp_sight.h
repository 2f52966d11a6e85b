/* SPDX-License-Identifier: MIT */
/* The lights that the fisheye sees from one of the places where it is laid. */
#ifndef INLAY_BAKE_CALIBRATE_LAMPS_LAMP_SIGHT_H
#define INLAY_BAKE_CALIBRATE_LAMPS_LAMP_SIGHT_H

#include "hal/colour/transfer.h"
#include "hal/image/image.h"
#include "hal/lights/lamp/lamp_find.h"

enum { SIGHT_PLACES_MAX = 4, SIGHT_SPOTS_MAX = 16 };

struct lamp_sight {
	const char *name; /* of its picture; borrowed */
	double at[3];	  /* the lens, metres, world */
	int count;
	struct lamp_spot spot[SIGHT_SPOTS_MAX];
	double share[SIGHT_SPOTS_MAX]; /* of a level ground's light; of clipped light: at least */
};

/* Finds the lights in a picture, the strongest first, taken at sight->at. Those below the horizon and those too faint
 * to matter are left out, which is logged. 0 or -ENOMEM. */
int lamp_sight_look(struct lamp_sight *sight, const struct image *picture,
		    const struct transfer_curve *curve, const struct fisheye *lens);

/* "azimuth 134, elevation 45 degrees" */
#define SIGHT_TEXT_MAX 64
const char *lamp_sight_text(const double dir[3], char text[SIGHT_TEXT_MAX]);

#endif
