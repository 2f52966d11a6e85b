/* SPDX-License-Identifier: MIT */
/* The parts of buttons_gpio.c: lines of the kernel's GPIO chips (uAPI version 2, Linux 5.10), which
 * the kernel debounces; and what counts as a press of a line. */
#ifndef INLAY_DRIVERS_GPIO_GPIO_H
#define INLAY_DRIVERS_GPIO_GPIO_H

#include <linux/gpio.h>
#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"

#define GPIO_OFFSET_MAX 1023 /* the largest line number that a key accepts */

enum gpio_bias { GPIO_BIAS_AS_IS, GPIO_BIAS_PULL_UP, GPIO_BIAS_PULL_DOWN, GPIO_BIAS_DISABLED };

extern const char *const gpio_bias_names[]; /* "as-is", "pull-up", ... NULL */

/* Opens a chip by path, name or label and fills in *info. Returns a descriptor that the caller
 * closes, or -errno with a fault: -ENODEV: there is no such chip. */
int gpio_chip_open(const char *name, struct gpiochip_info *info, struct fault *fault);

/* Asks what the kernel knows of a line: its user and direction. 0 or -errno. */
int gpio_line_ask(int chip, unsigned offset, struct gpio_v2_line_info *info);

/* Requests lines of a chip for input. Returns a descriptor that gives struct gpio_v2_line_event at
 * each edge of a debounced level and keeps the lines; or -errno, -EBUSY: one of them is in use. */
int gpio_lines_open(int chip, const uint32_t *offsets, int count, bool active_low,
		    enum gpio_bias bias, int debounce_ms);

/* Sets bit i of *levels where line i of the request is active. 0, or -errno: -ENODEV: the chip is
 * gone. */
int gpio_lines_levels(int lines, int count, uint64_t *levels);

/* Calls found() with a line of text for each chip and each of its lines. 0, or -errno; -EACCES:
 * this user may not open some chip. */
int gpio_list_chips(void (*found)(void *context, const char *line), void *context);

/*
 * A line whose level the kernel has debounced. It is a press when it becomes active; while it is
 * held, the actions that repeat are presses again and again, for BUTTON_STUCK_NS at most: a line
 * that is held for longer is stuck.
 */
#define BUTTON_NEVER INT64_MAX
#define BUTTON_STUCK_NS (10 * 1000000000LL)

struct button_timing {
	int64_t repeat_after_ns; /* 0: never */
	int64_t repeat_every_ns; /* above 0 */
};

struct button {
	bool repeats; /* the action repeats while the button is held */
	bool pressed;
	int64_t pressed_ns; /* when it was pressed */
	int64_t repeat_ns;  /* time of the next repetition, or BUTTON_NEVER */
};

/* level: the line's at the start. A button that is held at the start is neither pressed nor
 * repeated until it has been released. */
void button_start(struct button *button, bool level, bool repeats);

/* Takes the level at a time. Returns whether it is a press. */
bool button_take(struct button *button, const struct button_timing *timing, bool level,
		 int64_t at_ns);

/* Returns whether a repetition is due; to be called at repeat_ns. */
bool button_repeat(struct button *button, const struct button_timing *timing, int64_t now_ns);

#endif
