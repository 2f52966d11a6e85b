/* SPDX-License-Identifier: MIT */
/*
 * GPIO lines as inputs whose edges are watched: the few calls that libgpiod 1.6 and 2.x have in
 * common, each by its own name. GPIOD_MAJOR, from the Makefile, says which one it is.
 */
#ifndef INLAY_DRIVERS_GPIO_LINES_H
#define INLAY_DRIVERS_GPIO_LINES_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"

/* From version 2 on the kernel lets a level settle, in hardware where the chip can. */
#define GPIO_KERNEL_SETTLES (GPIOD_MAJOR >= 2)

#define GPIO_OFFSET_MAX 1023 /* the largest line number that a key accepts */

enum gpio_bias { GPIO_BIAS_AS_IS, GPIO_BIAS_PULL_UP, GPIO_BIAS_PULL_DOWN, GPIO_BIAS_DISABLED };

extern const char *const gpio_bias_names[]; /* "as-is", "pull-up", ... NULL */

struct gpiod_chip;

struct gpio_line_settings {
	bool active_low;
	enum gpio_bias bias;
	int64_t settle_ns; /* used where GPIO_KERNEL_SETTLES */
};

struct gpio_line {
	void *request; /* libgpiod's; NULL: closed */
	void *edge;    /* libgpiod 2's room for one */
	unsigned offset;
};

/* Opens a chip by path, name or label. user begins the fault's text. 0; -ENODEV: there is no such
 * chip; other -errno. */
int gpio_chip_open(struct gpiod_chip **chip, const char *name, const char *user,
		   struct fault *fault);
void gpio_chip_close(struct gpiod_chip *chip); /* after its lines; NULL is harmless */

/* -ENXIO: the chip has no such line; -EBUSY: somebody holds it; other -errno. */
int gpio_line_open(struct gpio_line *line, struct gpiod_chip *chip, unsigned offset,
		   const struct gpio_line_settings *settings);
int gpio_line_descriptor(const struct gpio_line *line); /* readable when there is an edge */

/* Active or not: 0, 1 or -errno (-ENODEV: the chip is gone). */
int gpio_line_level(const struct gpio_line *line);

/* The oldest edge: to which level, and when (CLOCK_MONOTONIC). Waits when there is none. */
int gpio_line_edge(const struct gpio_line *line, bool *level, int64_t *at_ns);
void gpio_line_close(struct gpio_line *line); /* idempotent */

/* One line of text for each chip and each line of it. 0 or -errno. */
int gpio_lines_list(void (*found)(void *context, const char *line), void *context);

#endif
