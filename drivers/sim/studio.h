/* SPDX-License-Identifier: MIT */
/*
 * The studio: a simulated room whose radiance along any ray, at any time, has a closed form. It
 * serves as ground truth for tests.
 *
 * World units are metres. The room is the box |x| <= 3, |y| <= 2.5, 0 <= z <= 3. Its floor is the
 * ground z = 0; the object stands at the origin. Two ceiling panels, which can be switched, and a
 * window are steady light sources; two paper lanterns, one warm and one cool, move on smooth paths.
 * Emitters have constant radiance L. A diffuse surface has the radiance
 *
 *     L_out = albedo / pi * (sum of E over all emitters + constant)
 *
 * with the irradiance E of
 *
 *     a lantern (sphere of radius r)   E = pi * L * (r / d)^2 * cos(theta)
 *     a rectangle (Lambert)            E = L / 2 * |sum over edges of angle * dot(edge normal, n)|
 *
 * d is the distance and theta the angle of incidence. The edge normal is the unit normal of the
 * plane through the point and an edge, n that of the surface. The constant stands for light from
 * all other surfaces. Nothing in the room casts shadows; walkers.h adds what does. Radiance 1 is
 * white at exposure 1: the floor is mid-grey, lanterns are about 4.
 */
#ifndef INLAY_DRIVERS_SIM_STUDIO_H
#define INLAY_DRIVERS_SIM_STUDIO_H

#include <stdbool.h>
#include <stdint.h>

#include "drivers/sim/mains.h"
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

/* The lamps at a moment. */
struct studio_lamps {
	struct studio_lantern lantern[STUDIO_LANTERNS];
	double panels; /* factor of the ceiling panels' radiance: 1 on, 0 off */
	/* The panels flicker in a view of the studio (studio_view.h); all else has their mean. */
	struct mains mains;
	double time_s;
};

/* The point where a ray leaves the room, without regard to lanterns. */
struct studio_hit {
	enum studio_surface surface;
	double distance; /* along a unit direction */
	double point[3];
	double emitted[3]; /* radiance of a panel that is on or of the window; albedo is 0 */
	double albedo[3];
};

extern const double studio_normals[STUDIO_SURFACE_COUNT][3]; /* they point into the room */

/* Returns the lamps at a time. switch_s: the panels go off, and on again, every so many seconds; 0:
 * they stay on. */
struct studio_lamps studio_lamps(double time_s, double switch_s);

/* Finds where a ray leaves the room. dir is a unit vector. For an origin outside, the walls that
 * face the viewer are transparent. False: the ray misses the room. */
bool studio_hit(const double origin[3], const double dir[3], struct studio_hit *hit);

/* Computes the irradiance at a point of a surface by everything but the lanterns. panels: see
 * struct studio_lamps. */
void studio_steady_irradiance(const double point[3], enum studio_surface surface, double panels,
			      double rgb[3]);

/* Returns the irradiance by a lantern for a radiance of 1. */
double studio_lantern_irradiance(const struct studio_lantern *lantern, const double point[3],
				 const double normal[3]);

/* A small piece of a lamp, for what its light does off the room's surfaces: the irradiance is
 *
 *     E = power cos(theta) cos(theta') / d^2
 *
 * with theta' the angle at the lamp, whose cosine counts as 1 for a lantern (facing is 0). */
struct studio_piece {
	double place[3], facing[3], power[3];
	double radius; /* of the piece, m */
};

enum { STUDIO_PIECES = 3 + 3 + 4 + STUDIO_LANTERNS };

/* Divides the lamps: panels into three, the window into four, lanterns are one each. */
void studio_pieces(const struct studio_lamps *lamps, struct studio_piece piece[STUDIO_PIECES]);

/* Light from all other surfaces, which is the same everywhere. */
extern const double studio_ambient_irradiance[3];

/* Returns the nearest lantern that a ray hits within a distance of `limit`; -1: none. dir is a unit
 * vector. */
int studio_lantern_hit(const struct studio_lamps *lamps, const double origin[3],
		       const double dir[3], double limit);

/* Hashes a pair of integers to a number in 0..1. */
double studio_chance(uint32_t a, uint32_t b);

/* Computes the radiance that arrives at origin from the unit vector dir; 0 if the ray misses the
 * room. */
void studio_radiance(const double origin[3], const double dir[3], const struct studio_lamps *lamps,
		     double rgb[3]);

/* Computes the true radiance[dome->count] of each light: the mean over its Voronoi cell,
 * integrated to about 1e-3 of the brightest. 0 or -ENOMEM. */
int studio_lights(const struct dome *dome, const double origin[3], const struct studio_lamps *lamps,
		  double (*radiance)[3]);

#endif
