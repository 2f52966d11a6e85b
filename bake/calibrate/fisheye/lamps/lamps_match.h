/* SPDX-License-Identifier: MIT */
/* Which bright spot is which lamp, and about what lens shows them so. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_MATCH_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_LAMPS_LAMPS_MATCH_H

#include "bake/calibrate/fisheye/fisheye_optics.h"
#include "bake/calibrate/fisheye/lamps/lamps_file.h"
#include "bake/calibrate/fisheye/lamps/lamps_spots.h"

#define GUESSES_MAX 8

/* What is looked at. */
struct lamp_scene {
	const struct lamps *lamps;
	const struct spots *spots;
	int width, height;
};

struct lamp_guess {
	struct optics optics;
	double rotation[9]; /* world to camera */
	bool mirrored;	    /* of spots whose x counts from the right */
	double score;	    /* lamps that are near a spot, nearer ones counting more */
};

/* A spot's place, x from the right if the guess is mirrored. */
void lamp_spot_px(const struct lamp_scene *scene, bool mirrored, int spot, double px[2]);

/* Where a lens shows a lamp; false: nowhere in the picture, or beyond most_rad from the axis. */
bool lamp_expect(const struct lamp_scene *scene, const struct lamp_guess *guess, int lamp,
		 double most_rad, double px[2]);

/*
 * Lenses of this squash (focal y over x) with their axis in the picture's middle, and of three
 * models and several fields are tried; pairs of lamps that are as far apart as pairs of spots say
 * how such a lens may be turned, and every lamp whether it is. Lamps that are hinted at have to be
 * near that place. Fills guess with those that differ in how they are turned, best first, and
 * returns how many; -ENOMEM.
 */
int lamps_guess(const struct lamp_scene *scene, double squash,
		struct lamp_guess guess[GUESSES_MAX]);

#endif
