/* SPDX-License-Identifier: MIT */
/*
 * Which lights of several places are one. Two rays to one lamp meet but for their deviations, which
 * is the epipolar constraint; of all ways to take the lights together, that one counts that
 * explains most of them, by the fewest lamps. If another way does as well, nobody can tell.
 */
#ifndef INLAY_BAKE_CALIBRATE_LAMPS_LAMP_MATCH_H
#define INLAY_BAKE_CALIBRATE_LAMPS_LAMP_MATCH_H

#include "bake/calibrate/estimate/verdict.h"
#include "bake/calibrate/lamps/lamp_sight.h"

/* One standard deviation each. */
struct lamp_deviations {
	double px;	/* of a direction, by lens and picture */
	double place_m; /* of each coordinate of a place */
	double turn;	/* rad: of how the fisheye is turned, about each axis */
};

/* One light, as several places see it. */
struct lamp_track {
	int spot[SIGHT_PLACES_MAX]; /* its number in that sight; -1: not seen */
	int seen;		    /* by how many places */
	bool far;		    /* its rays may be parallel */
	double at[3];		    /* its place; far: its direction */
	double least_m; /* far: it cannot be nearer, by three deviations; else its distance */
	double squares; /* of its residuals, in deviations */
};

/* Finds the tracks, those with most light first. Returns how many; -ENOMEM. Doubts lights that can
 * be taken together in more than one way, and strong ones that some place does not see. */
int lamp_match(const struct lamp_sight *sight, int sights, const struct lamp_deviations *deviation,
	       struct lamp_track track[SIGHT_SPOTS_MAX], struct verdict *verdict);

/* The sum of squares of so many normal deviates that is exceeded once in a thousand times. */
double lamp_most_squares(int freedom);

#endif
