/* SPDX-License-Identifier: MIT */
/*
 * GPIO lines as inputs whose edges are watched, on top of libgpiod 1.6 or 2.x. GPIOD_MAJOR, from
 * the Makefile, says which version it is.
 */
#ifndef INLAY_DRIVERS_GPIO_LINES_H
#define INLAY_DRIVERS_GPIO_LINES_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"

/* From version 2 on the kernel debounces lines, in hardware if the chip can. */
#define GPIO_KERNEL_SETTLES (GPIOD_MAJOR >= 2)

#define GPIO_OFFSET_MAX 1023 /* the largest line number that a key accepts */

enum gpio_bias { GPIO_BIAS_AS_IS, GPIO_BIAS_PULL_UP, GPIO_BIAS_PULL_DOWN, GPIO_BIAS_DISABLED };

extern const char *const gpio_bias_names[]; /* "as-is", "pull-up", ... NULL */

struct gpiod_chip;

struct gpio_line_settings {
	bool active_low;
	enum gpio_bias bias;
	int64_t settle_ns; /* debounce time; used if GPIO_KERNEL_SETTLES */
};

struct gpio_line {
	void *request; /* of libgpiod; NULL: closed */
	void *edge;    /* libgpiod 2: buffer for one edge */
	unsigned offset;
};

/* Opens a chip by path, name or label. user begins the fault's text. 0; -ENODEV: there is no such
 * chip; other -errno. */
int gpio_chip_open(struct gpiod_chip **chip, const char *name, const char *user,
		   struct fault *fault);
void gpio_chip_close(struct gpiod_chip *chip); /* after its lines; accepts NULL */

/* Opens a line for input and watches its edges. 0; -ENXIO: the chip has no such line; -EBUSY: it is
 * in use; other -errno. */
int gpio_line_open(struct gpio_line *line, struct gpiod_chip *chip, unsigned offset,
		   const struct gpio_line_settings *settings);
int gpio_line_descriptor(const struct gpio_line *line); /* readable if there is an edge */

/* Returns 1 if the line is active, else 0; or -errno (-ENODEV: the chip is gone). */
int gpio_line_level(const struct gpio_line *line);

/* Reads the oldest edge: the new level and its time (CLOCK_MONOTONIC). Waits if there is none. 0 or
 * -errno. */
int gpio_line_edge(const struct gpio_line *line, bool *level, int64_t *at_ns);
void gpio_line_close(struct gpio_line *line); /* idempotent */

/* Calls found() with a line of text for each chip and each of its lines. 0 or -errno. */
int gpio_lines_list(void (*found)(void *context, const char *line), void *context);

#endif
