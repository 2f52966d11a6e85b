/* SPDX-License-Identifier: MIT */
/*
 * Whether a kiosk rests: outside of [screen] hours. Each look decides anew, by the clock on the
 * wall, and remembers nothing of the look before: a clock that is set, summer time and nights in
 * which the machine was off cannot confuse it. Pure: asks no clock.
 */
#ifndef INLAY_APP_KIOSK_REST_H
#define INLAY_APP_KIOSK_REST_H

#include <stdbool.h>
#include <stdint.h>
#include <time.h>

#include "config/config_hours.h"

#define REST_WAKE_MINUTES 10 /* for which a press wakes it */

struct rest {
	struct config_hours hours;
	time_t built; /* when the program was: a clock that shows less has not been set */
	int64_t awake_until_ns;
	bool resting; /* what the kiosk does at present */
	bool due;     /* it is to look whether that is still right */
};

/* Takes hours that have been checked. Whoever woke it is forgotten. */
void rest_take_hours(struct rest *rest, const char *hours);

/* A button or a command: it does not rest for the next REST_WAKE_MINUTES. Returns whether it
 * rested. A button then does nothing else, because nobody could see what it does. */
bool rest_press(struct rest *rest, int64_t now_ns);

/* Whether it has to rest now. Never while the clock shows a time before the program was built. */
bool rest_is_due(const struct rest *rest, time_t wall, int64_t now_ns);

/* Writes when hours begin or end next: "mon 09:00". Empty: never, or the clock has not been set. */
void rest_next(const struct rest *rest, time_t wall, char text[HOURS_MOMENT_MAX]);

#endif
