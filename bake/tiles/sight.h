/* SPDX-License-Identifier: MIT */
/*
 * Finds the surfaces that the camera sees through the object's glass, and their places in the
 * picture.
 *
 * A camera ray that meets glass splits. The part that passes all surfaces of glass is always
 * followed, so that what is seen through glass has no noise. Each surface on its way also mirrors a
 * part. One of these, drawn at random by its weight, is followed and carries the weight of all.
 */
#ifndef INLAY_BAKE_TILES_SIGHT_H
#define INLAY_BAKE_TILES_SIGHT_H

#include "bake/scene/scene.h"

/* The end of a path through glass: the sky, a real surface, or a part of the object that is not
 * glass. */
struct sight {
	struct rgb weight;	/* transmission of the path; 0: the path has ended */
	bool met;		/* it meets a surface */
	struct surface surface; /* if met */
	struct v3 direction;	/* unit direction of the path's last ray */
};

/* Follows a camera ray of this direction from `surface`, which is glass of the object.
 * mirrored->surface may be glass again. */
void sight_through_glass(const struct world *world, struct random *random,
			 const struct surface *surface, struct v3 direction, struct sight *passed,
			 struct sight *mirrored);

/* Tells whether the background's picture may show the end of the path: a real surface, or the
 * sky. */
static inline bool sight_is_real(const struct sight *sight)
{
	return !sight->met || sight->surface.kind != SURFACE_OBJECT;
}

/* Finds the place, in pixels, at which the picture of the world without objects shows the end of
 * the path: a real surface, or the sky far away in the path's direction. Returns false if it does
 * not. */
bool sight_place(const struct scene *scene, const struct sight *sight, double place[2]);

#endif
