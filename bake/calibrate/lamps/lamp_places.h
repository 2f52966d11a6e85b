/* SPDX-License-Identifier: MIT */
/*
 * inlay-calibrate lamps: from lights in pictures to lamps at places.
 *
 * All lamps, and how far each picture's place and turn are from what was said, are found together:
 *
 *     minimise  sum (angle(d, T (p - c)) / s_d)^2  +  sum (c - c_said)^2 / s_c^2  +  sum |t|^2 / s_t^2
 *
 * d: a light's measured direction; p: its lamp's place; c: the lens's place; T: a small turn t. The
 * deviations s are given, so that the covariance is (J^T J)^-1.
 */
#ifndef INLAY_BAKE_CALIBRATE_LAMPS_LAMP_PLACES_H
#define INLAY_BAKE_CALIBRATE_LAMPS_LAMP_PLACES_H

#include "bake/calibrate/estimate/finding.h"
#include "bake/calibrate/lamps/lamp_match.h"
#include "hal/lights/lamps.h"

/* Must not be moved in memory: the finding points into it. */
struct lamp_places {
	struct lamp_sight sight[SIGHT_PLACES_MAX]; /* the caller fills these three, and deviation */
	int sights;
	struct fisheye lens;
	struct lamp_deviations deviation;
	double tolerance;   /* most deviation of a lamp's place, as a share of its distance */
	struct lamps lamps; /* the result, the one with most light first */
	double deviation_m[LAMPS_MAX], radius_deviation_m[LAMPS_MAX]; /* one deviation */
	bool radius_known[LAMPS_MAX];				      /* else it is at most that */
	struct finding finding;
	double moved[SIGHT_PLACES_MAX][3]; /* the place that was found less the one that was said */
};

/* Fills the result, whose finding has a verdict, and the points of seen, a view for each sight, which has to outlive
 * it. A doubted result may hold no lamp. -ENOMEM. */
int lamp_places_find(struct lamp_places *places, struct observations *seen, struct fault *fault);
void lamp_places_free(struct lamp_places *places); /* idempotent; zeroed is fine */

/* Writes an INI file of sections [lamp lamp1] and so on, with the results as comments. -errno. */
int lamp_places_write(const struct lamp_places *places, const char *path, struct fault *fault);

#endif
