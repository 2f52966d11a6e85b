/* SPDX-License-Identifier: MIT */
/*
 * Solids as functions of space: negative inside, positive outside, near the surface about the
 * distance to it; each with its exact gradient, so that points can be moved onto the surface and
 * normals need no mesh.
 *
 * The joins are C2 (the cubic smooth minimum), so highlights run over them without a break.
 */
#ifndef INLAY_BAKE_DEMO_IMPLICIT_H
#define INLAY_BAKE_DEMO_IMPLICIT_H

struct implicit {
	double value;
	double gradient[3];
};

struct ellipsoid {
	double centre[3];
	double radius[3];
	double turn_deg[3]; /* about its own x, then y, then z */
};

/* The union of all balls on the way from one end to the other, with a radius that is linear in
 * between. The distance of the ends is larger than |r1 - r0|. */
struct round_cone {
	double end[2][3];
	double radius[2];
};

/* A closed tube around an ellipse that lies in the ring's own x-z plane. */
struct ring {
	double centre[3];
	double radius[2]; /* of the ellipse, along x and z */
	double tube[2];	  /* half the thickness across the tube and along the ring's axis */
	double tilt_deg;  /* about x */
};

struct implicit implicit_ellipsoid(const struct ellipsoid *shape, const double p[3]);
struct implicit implicit_round_cone(const struct round_cone *shape, const double p[3]);
struct implicit implicit_ring(const struct ring *shape, const double p[3]);
/* The half-space above y = height. */
struct implicit implicit_above(double height, const double p[3]);

/* Joins are rounded over about `width`; 0 is not allowed. */
struct implicit implicit_union(struct implicit a, struct implicit b, double width);
struct implicit implicit_intersection(struct implicit a, struct implicit b, double width);
struct implicit implicit_difference(struct implicit a, struct implicit b, double width);

#endif
