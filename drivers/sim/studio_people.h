/* SPDX-License-Identifier: MIT */
/*
 * Walkers (walkers.h) in the studio as a camera sees it: bodies, and the shadows that they cast.
 *
 * A body is drawn by SIDE x SIDE rays a pixel; its light is that of all pieces of lamps
 * (studio_pieces()) and the ambient one, with its own normal. Approximations:
 *   - shadows fall on the room only, not on bodies; a body sends no light back to the room;
 *   - a shadow is the share of each piece that walker_hides() gives, so its edges are as soft as
 *     the lamp but not exact; it is computed for every fourth pixel and row, and between them
 *     interpolated; of the ambient light seven wide beams are tested;
 *   - a walker does not hide or darken the lanterns that shine behind.
 */
#ifndef INLAY_DRIVERS_SIM_STUDIO_PEOPLE_H
#define INLAY_DRIVERS_SIM_STUDIO_PEOPLE_H

#include "drivers/sim/studio_view.h"
#include "drivers/sim/walkers.h"

/* Takes from rgb[height][width][3], the empty studio, the light that walkers keep from it. */
void studio_people_shade(const struct studio_view *view, const struct studio_lamps *lamps,
			 const struct walker *walkers, int count, float *rgb);

/* A layer of bodies over the room. */
struct studio_layer {
	float rgb[3]; /* premultiplied by alpha */
	float alpha;  /* share of the pixel that bodies cover */
	float depth;  /* m along the ray through the middle of what is covered; 0: nothing is */
	int walker;   /* the one that covers most of it; -1: none */
};

/* Draws the bodies of some walkers: layer[height][width]. */
void studio_people_draw(const struct studio_view *view, const struct studio_lamps *lamps,
			const struct walker *walkers, int count, struct studio_layer *layer);

/* Puts a layer over rgb[height][width][3]. */
void studio_people_over(const struct studio_view *view, const struct studio_layer *layer,
			float *rgb);

/* Puts a layer over the depths of studio_view_depth(), where it covers half of a pixel. */
void studio_people_depth(const struct studio_view *view, const struct studio_layer *layer,
			 float *z);

#endif
