/* SPDX-License-Identifier: MIT */
/*
 * One push button on a line, from edges to presses; no device in it. A level counts when it has
 * lasted for the time of settling, so neither a bounce nor a spike is a press. A step goes on while
 * its button is held.
 *
 * The owner calls button_edge() for each edge in order of time, and button_settle() when there are
 * none left; both say whether that is a press (a repetition is one too).
 */
#ifndef INLAY_DRIVERS_GPIO_BUTTON_H
#define INLAY_DRIVERS_GPIO_BUTTON_H

#include <stdbool.h>
#include <stdint.h>

#define BUTTON_NEVER INT64_MAX

/* Nobody holds a button for so long: it is stuck, and repeats no more. */
#define BUTTON_STUCK_NS (10 * INT64_C(1000000000))

struct button_timing {
	int64_t settle_ns;	 /* 0: the first edge counts */
	int64_t repeat_after_ns; /* 0: no repetition */
	int64_t repeat_every_ns; /* above 0 */
};

struct button {
	bool repeats;	    /* its action does */
	bool level;	    /* of the line: pressed or not, as the last edge says */
	bool pressed;	    /* settled */
	int64_t edge_ns;    /* the level is so old */
	int64_t pressed_ns; /* since when it is held */
	int64_t repeat_ns;  /* the next repetition; BUTTON_NEVER: none */
};

/* A line that is pressed at the start is no press, nor is holding it. */
void button_start(struct button *button, bool level, bool repeats);

bool button_edge(struct button *button, const struct button_timing *timing, bool level,
		 int64_t at_ns);
bool button_settle(struct button *button, const struct button_timing *timing, int64_t now_ns);

/* When button_settle() has something to do next without another edge, or BUTTON_NEVER. */
int64_t button_deadline_ns(const struct button *button, const struct button_timing *timing);

#endif
