/* SPDX-License-Identifier: MIT */
/*
 * Private to exposures*.c: how much better, or worse, a place looks for what the ground tells, over
 * places drawn at random: a room or a sky that is brighter or darker above, in which are
 *
 *   lamps    0 to 6, discs of 1.1 to 11 degrees at any height, in half of the places alike, in the
 *            others up to 1000 times brighter than each other, each with a glow around it;
 *   windows  0 to 3, rectangles, 3 to 100 times as bright as the room;
 *   walls    0 to 4, lit patches without an edge, up to 50 degrees high, 1 to 30 times as bright.
 *
 * All lamps together give 10 to 98 % of the light, and a white ground has a radiance of 0.4 to 0.8.
 */
#ifndef INLAY_TESTS_ACCURACY_EXPOSURES_RANDOM_H
#define INLAY_TESTS_ACCURACY_EXPOSURES_RANDOM_H

#include "tests/accuracy/exposures_truth.h"

/* Prints a table of random places, the same ones in each run. Returns whether at least 95 % of them
 * are not worse. */
bool random_places(const struct table *table);

#endif
