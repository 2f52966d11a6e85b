/* SPDX-License-Identifier: MIT */
/*
 * The studio: a room that is its own ground truth. Radiance along any ray, at any time, in closed
 * form.
 *
 * World units are metres. The room is the box |x| <= 3, |y| <= 2.5, 0 <= z <= 3; its floor is the
 * ground Z = 0 and the object's place is the origin. Two ceiling panels and a window shine
 * steadily; two paper lanterns, one warm and one cool, drift on smooth paths. Emitters have
 * constant radiance. A surface's radiance is albedo / pi times its irradiance: a lantern    pi L (r
 * / d)^2 cos(theta)                                (a sphere of radius r) a rectangle  Lambert's
 * formula, L / 2 * sum of edge angle * cos(edge plane's normal) all the rest a constant Nothing in
 * the room casts a shadow on it. Radiance 1 is what a camera of exposure 1 clips at: the floor is
 * mid-grey, lanterns are about 4.
 */
#ifndef INLAY_DRIVERS_SIM_STUDIO_H
#define INLAY_DRIVERS_SIM_STUDIO_H

#include <stdbool.h>

#include "hal/optics/dome.h"

enum { STUDIO_LANTERNS = 2 };

enum studio_surface {
	STUDIO_FLOOR,
	STUDIO_CEILING,
	STUDIO_WALL_EAST,  /* x = 3 */
	STUDIO_WALL_WEST,  /* the one with the window */
	STUDIO_WALL_NORTH, /* y = 2.5 */
	STUDIO_WALL_SOUTH,
	STUDIO_SURFACE_COUNT
};

struct studio_lantern {
	double centre[3], radius, radiance[3];
};

/* Where a ray leaves the room, lanterns aside. */
struct studio_hit {
	enum studio_surface surface;
	double distance; /* along a unit direction */
	double point[3];
	double emitted[3]; /* radiance of a panel or the window; then albedo is 0 */
	double albedo[3];
};

extern const double studio_normals[STUDIO_SURFACE_COUNT][3]; /* into the room */

void studio_lanterns(double time_s, struct studio_lantern lanterns[STUDIO_LANTERNS]);

/* dir is a unit vector. Seen from outside, the walls towards the viewer are left out; false when
 * the ray misses the room. */
bool studio_hit(const double origin[3], const double dir[3], struct studio_hit *hit);

/* Irradiance at a point of a surface by everything that does not move. */
void studio_steady_irradiance(const double point[3], enum studio_surface surface, double rgb[3]);

/* Irradiance by one lantern of radiance 1. */
double studio_lantern_irradiance(const struct studio_lantern *lantern, const double point[3],
				 const double normal[3]);

/* Radiance that arrives at origin from dir (unit); 0 where there is no room. */
void studio_radiance(const double origin[3], const double dir[3], double time_s, double rgb[3]);

/* The true light of each cell or tent: its mean radiance, integrated to about 1e-3 of the
 * brightest. radiance[dome->count]. 0 or -ENOMEM. */
int studio_lights(const struct dome *dome, const double origin[3], double time_s,
		  double (*radiance)[3]);

#endif
