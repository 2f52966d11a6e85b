/* SPDX-License-Identifier: MIT */
/*
 * The body of a walker at a moment: capsules (all points within a radius of a line), some of them
 * widened from side to side, so that rays meet them in closed form. The feet follow a walk: one
 * stands still on the ground while the other swings forward; knees and elbows bend as the distances
 * want.
 */
#ifndef INLAY_DRIVERS_SIM_WALKER_BODY_H
#define INLAY_DRIVERS_SIM_WALKER_BODY_H

#include "drivers/sim/walkers.h"

enum { WALKER_PARTS = 24 };

enum walker_cloth { CLOTH_SKIN, CLOTH_HAIR, CLOTH_TOP, CLOTH_LEGS, CLOTH_SHOES, CLOTH_BAG };

struct walker_part {
	enum walker_cloth cloth;
	double from[3], along[3]; /* the line: from, and from + along */
	double radius;
	double widen; /* in the direction of side: its half-width there is radius * widen */
};

struct walker_body {
	enum walker_style style;
	const double (*cloth)[3]; /* as the walker's */
	double side[3], ahead[3]; /* unit vectors: to the left, and where it walks */
	int count;
	struct walker_part part[WALKER_PARTS];
	double low[3], up[3], reach; /* an upright capsule that holds all: its line and radius */
};

void walker_pose(const struct walker *walker, struct walker_body *body);

struct walker_hit {
	int part;
	double distance; /* in units of dir's length */
	double normal[3];
	double albedo[3];
};

/* Finds the nearest of the parts whose bits are set. dir is a unit vector. False: none is hit. */
bool walker_hit(const struct walker_body *body, unsigned parts, const double origin[3],
		const double dir[3], struct walker_hit *hit);

/* The parts that a cone may touch: every ray from origin within an angle of dir. */
unsigned walker_in_cone(const struct walker_body *body, const double origin[3], const double dir[3],
			double angle_rad);

/*
 * The share of a round piece of a lamp, of this radius, that the body hides from a point: 0..1.
 * Each part hides of the beam's width what its own width covers. Parts overlap in part: the result
 * is the mean of the largest share and of 1 - product of (1 - share). Edges of the shadow are so as
 * soft as the lamp is wide, without samples; against dense rays it is off by 0.1 (RMS) in the
 * penumbra.
 */
double walker_hides(const struct walker_body *body, const double point[3], const double lamp[3],
		    double radius);

#endif
