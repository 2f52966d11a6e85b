/* SPDX-License-Identifier: MIT */
/*
 * A texture for a closed surface without a parametrisation of its own: pieces of it that face one
 * of the six axes are laid flat along that axis, side by side, and painted by a function of space.
 */
#ifndef INLAY_BAKE_DEMO_ATLAS_H
#define INLAY_BAKE_DEMO_ATLAS_H

#include "bake/demo/polygonise.h"
#include "hal/image/image.h"

struct atlas {
	int point_count;
	double (*point)[2];   /* texture coordinates 0..1, u to the right, v down */
	int (*corner)[3];     /* of each triangle: indices into point */
	double texel;	      /* size of a texel on a surface that faces its axis */
	struct image picture; /* u8, square */
};

/* Lays out and paints a surface. Every texel that a piece touches, and two around it, gets the
 * colour (code values 0..1) of its place in space, so that texture filters may cross the border.
 * -ENOMEM. */
int atlas_create(struct atlas *atlas, const struct trimesh *mesh, int side,
		 void (*colour)(const double p[3], double rgb[3]));

void atlas_free(struct atlas *atlas); /* idempotent; zeroed is fine */

#endif
