/* SPDX-License-Identifier: MIT */
/*
 * Lamps that are not where the configuration says, and one that it does not name: light that is
 * small and bright, as of a lamp at a place, and taken for light from afar. Whether it hangs near
 * nobody can tell from one picture; if it is 1.5 m away, the object's brightness is off by about
 *
 *     NEAR_LAMPS_OFF * share                    share: of the light of a level ground
 *
 * which make near measures (tests/accuracy): 25 % by a lamp with three quarters of the light, with
 * the fisheye 0.3 m beside the object.
 */
#ifndef INLAY_APP_PIPELINE_NEAR_LAMPS_H
#define INLAY_APP_PIPELINE_NEAR_LAMPS_H

#include "hal/frame/frame_reader.h"
#include "hal/image/image.h"
#include "hal/lights/lamps.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"

#define NEAR_LAMPS_OFF (0.25 / 0.75)
/* From 2 % of the brightness on, a difference between two greys that eyes see; until 1.3 %. */
#define NEAR_LAMPS_FROM (0.02 / NEAR_LAMPS_OFF)
#define NEAR_LAMPS_UNTIL (0.013 / NEAR_LAMPS_OFF)

struct near_lamps {
	bool unnamed;			/* there is one */
	double azimuth_deg, height_deg; /* from the fisheye; the azimuth from +X towards +Y */
	double share;
	bool missing[LAMPS_MAX]; /* no light within 5 degrees of where it has to be seen */
};

struct near_search;

/* For a dome, which has to outlive it. -ENOMEM. */
int near_search_create(struct near_search **search, const struct dome *dome);
void near_search_destroy(struct near_search *search); /* NULL is harmless */

/* The light that spots are looked for in. */
struct near_light {
	const struct fisheye *lens;	    /* of the picture */
	const struct frame_reader *frame;   /* the picture; or */
	const struct image *linear;	    /* linear light, upright; the other is NULL */
	const struct transfer_curve *curve; /* of the frame */
	const float (*radiance)[3];	    /* [lights]: all light */
	const float (*distant)[3];	    /* [lights]: without the named lamps, or the same */
	const struct lamps *lamps;	    /* the named ones */
};

/* Looks at a picture: for once a second. *lamps is what was found before, or zeroed. -ENOMEM. */
int near_search_look(struct near_search *search, const struct near_light *light,
		     struct near_lamps *lamps);

#endif
