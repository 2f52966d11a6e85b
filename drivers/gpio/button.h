/* SPDX-License-Identifier: MIT */
/*
 * Turns the edges of one push button's line into presses: debouncing and repetition. Pure: touches
 * no device. A level counts once it has lasted for the settling time, so neither a bounce nor a
 * spike is a press. Actions that step, like threshold-up, repeat while their button is held.
 *
 * The owner calls button_edge() for each edge in order of time, and button_settle() when none is
 * left. Both return whether there is a press; a repetition is a press too.
 */
#ifndef INLAY_DRIVERS_GPIO_BUTTON_H
#define INLAY_DRIVERS_GPIO_BUTTON_H

#include <stdbool.h>
#include <stdint.h>

#define BUTTON_NEVER INT64_MAX

/* A button that is held longer is stuck, and stops repeating. */
#define BUTTON_STUCK_NS (10 * INT64_C(1000000000))

struct button_timing {
	int64_t settle_ns;	 /* debounce time; 0: the first edge counts */
	int64_t repeat_after_ns; /* 0: never */
	int64_t repeat_every_ns; /* above 0 */
};

struct button {
	bool repeats;	    /* the action repeats while the button is held */
	bool level;	    /* of the line after the last edge; true: pressed */
	bool pressed;	    /* the settled level */
	int64_t edge_ns;    /* time of the last edge */
	int64_t pressed_ns; /* time when the settled level began */
	int64_t repeat_ns;  /* time of the next repetition, or BUTTON_NEVER */
};

/* level: the line's at the start. A button that is held at the start is neither pressed nor
 * repeated until it has been released. */
void button_start(struct button *button, bool level, bool repeats);

bool button_edge(struct button *button, const struct button_timing *timing, bool level,
		 int64_t at_ns);
bool button_settle(struct button *button, const struct button_timing *timing, int64_t now_ns);

/* Returns when button_settle() must be called next if no edge comes, or BUTTON_NEVER. */
int64_t button_deadline_ns(const struct button *button, const struct button_timing *timing);

#endif
