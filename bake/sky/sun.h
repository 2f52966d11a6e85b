/* SPDX-License-Identifier: MIT */
/*
 * Where the sun stands, by the date and the true solar time.
 *
 * The declination is that of the Astronomical Almanac's low-precision formulas (Michalsky, The
 * Astronomical Almanac's algorithm for approximate solar position, Solar Energy 40, 1988): with n
 * days since noon of 1 January 2000,
 *
 *     L = 280.460 + 0.9856474 n     g = 357.528 + 0.9856003 n
 *     lambda = L + 1.915 sin g + 0.020 sin 2 g
 *     sin declination = sin 23.44 sin lambda                          degrees
 *
 * A date has no year here: leap years shift it by up to 0.3 degrees. Refraction, up to 0.5 degrees
 * at the horizon, is left out. True solar time is the hour angle / 15 degrees + 12; it differs from
 * a clock's by the longitude and the equation of time.
 */
#ifndef INLAY_BAKE_SKY_SUN_H
#define INLAY_BAKE_SKY_SUN_H

#include "bake/sky/sky_need.h"

struct sun_date {
	int month, day; /* from 1 */
};

struct sun_path {
	double latitude_deg;	  /* north positive */
	double north_deg;	  /* azimuth of north in the scene: from +X towards +Y */
	struct sun_date from, to; /* both count; from may be later: over the turn of the year */
	double hours[2];	  /* true solar time, 0..24 */
};

/* The day of a year that is no leap year, from 0; 29 February is 28 February. -1: no such date. */
int sun_day(struct sun_date date);

double sun_declination_rad(int day);

/* Unit direction towards the sun; x east, y north, z up. */
void sun_direction(double latitude_rad, double declination_rad, double hour,
		   double east_north_up[3]);

/* Adds every place of the sun on its path as a moment of a clear sky. Returns how many pieces of
 * the sky it passes. */
int sky_need_add_sun(struct sky_need *need, const struct sun_path *path);

#endif
