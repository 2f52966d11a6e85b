/* SPDX-License-Identifier: MIT */
/*
 * Lamps that are not where the configuration says, and one that it does not name: light that is
 * small and bright, as of a lamp at a place, and taken for light from afar. Whether it hangs near
 * nobody can tell from one picture; if it is 1.5 m away, the object's brightness is off by about
 *
 *     LAMPS_TOLD_OFF * share                    share: of the light of a level ground
 *
 * which make near measures (tests/accuracy): 25 % by a lamp with three quarters of the light, with
 * the fisheye 0.3 m beside the object.
 */
#ifndef INLAY_APP_PIPELINE_LAMPS_TOLD_H
#define INLAY_APP_PIPELINE_LAMPS_TOLD_H

#include "hal/frame/frame_reader.h"
#include "hal/image/image.h"
#include "hal/lights/lamps.h"
#include "hal/optics/dome_placed.h"
#include "hal/optics/fisheye.h"

#define LAMPS_TOLD_OFF (0.25 / 0.75)
/* From 2 % of the brightness on, a difference between two greys that eyes see; until 1.3 %. */
#define LAMPS_TOLD_FROM (0.02 / LAMPS_TOLD_OFF)
#define LAMPS_TOLD_UNTIL (0.013 / LAMPS_TOLD_OFF)

struct lamps_told {
	bool unnamed;			/* there is one */
	double azimuth_deg, height_deg; /* from the fisheye; the azimuth from +X towards +Y */
	double share;
	bool missing[LAMPS_MAX]; /* no light within 5 degrees of where it has to be seen */
};

struct lamps_search;

/* For a dome, which has to outlive it, as placed, which may be NULL. -ENOMEM. */
int lamps_search_create(struct lamps_search **search, const struct dome *dome,
			const struct dome_placed *placed);
void lamps_search_destroy(struct lamps_search *search); /* NULL is harmless */

/* The light that spots are looked for in. */
struct lamps_light {
	const struct fisheye *lens;	    /* of the picture */
	const struct frame_reader *frame;   /* the picture; or */
	const struct image *linear;	    /* linear light, upright; the other is NULL */
	const struct transfer_curve *curve; /* of the frame */
	const float (*radiance)[3];	    /* [lights]: all light */
	const float (*distant)[3];	    /* [lights]: without the named lamps, or the same */
	const struct lamps *lamps;	    /* the named ones */
};

/* Looks at a picture: for once a second. *lamps is what was found before, or zeroed. -ENOMEM. */
int lamps_search_look(struct lamps_search *search, const struct lamps_light *light,
		      struct lamps_told *lamps);

#endif
