/* SPDX-License-Identifier: MIT */
/*
 * What the camera sees through the object's glass, and where the picture shows that.
 *
 * A camera ray that meets glass goes on in two ways. What passes every surface of glass in its way
 * is followed for certain, so that what is seen through has no noise. Of what is mirrored, wherever
 * that is first, one surface's share is followed in the place of all.
 */
#ifndef INLAY_BAKE_TILES_SIGHT_H
#define INLAY_BAKE_TILES_SIGHT_H

#include "bake/scene/scene.h"

/* The end of a way through glass: nothing, a real surface, or what of the object is not glass. */
struct sight {
	struct rgb weight; /* of what arrives from there; 0: the way has ended */
	bool met;
	struct surface surface; /* where met */
	struct v3 direction;
};

/* surface: glass of the object. mirrored.surface may be glass again. */
void sight_through_glass(const struct world *world, struct random *random,
			 const struct surface *surface, struct v3 direction, struct sight *passed,
			 struct sight *mirrored);

/* Whether light may come from the background's picture: a real surface, or nothing. */
static inline bool sight_is_real(const struct sight *sight)
{
	return !sight->met || sight->surface.kind != SURFACE_OBJECT;
}

/* Where the picture, which is of the world without objects, shows that real surface, or what lies
 * far away in that direction. False: it does not. */
bool sight_place(const struct scene *scene, const struct sight *sight, double place[2]);

#endif
