/* SPDX-License-Identifier: MIT */
/* First guesses of the lens and of which bright spot is which lamp. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_MATCH_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_MATCH_H

#include "bake/calibrate/fisheye/fisheye_optics.h"
#include "bake/calibrate/fisheye/lamps/lamps_file.h"
#include "bake/calibrate/fisheye/lamps/lamps_spots.h"

#define GUESSES_MAX 8

/* The input. */
struct lamp_scene {
	const struct lamps *lamps;
	const struct spots *spots;
	int width, height;
};

struct lamp_guess {
	struct optics optics;
	double rotation[9]; /* world to camera */
	bool mirrored;	    /* the picture is mirrored: x of spots counts from the right */
	double score;	    /* sum over lamps of how near a spot is, 0 to 1 each */
};

/* Place of a spot, x from the right if mirrored. */
void lamp_spot_px(const struct lamp_scene *scene, bool mirrored, int spot, double px[2]);

/* Projects a lamp; false: outside of the picture, or more than most_rad from the axis. */
bool lamp_expect(const struct lamp_scene *scene, const struct lamp_guess *guess, int lamp,
		 double most_rad, double px[2]);

/*
 * Tries lenses of this squash (focal y over x) with their axis in the middle of the picture, of
 * three models and several fields. Pairs of lamps that are as far apart as pairs of spots suggest a
 * rotation, and all lamps score it. Lamps with hints must be near them. Fills guess with the best
 * ones of different rotations, best first, and returns how many; -ENOMEM.
 */
int lamps_guess(const struct lamp_scene *scene, double squash,
		struct lamp_guess guess[GUESSES_MAX]);

#endif
