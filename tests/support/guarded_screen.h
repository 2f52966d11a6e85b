/* SPDX-License-Identifier: MIT */
/*
 * A screen buffer that catches writes outside of it. Each row is longer than the screen is wide,
 * and its excess bytes are checked; the buffer ends at a page that may not be touched, and before
 * the page with its first byte lies another.
 */
#ifndef INLAY_TESTS_SUPPORT_GUARDED_SCREEN_H
#define INLAY_TESTS_SUPPORT_GUARDED_SCREEN_H

#include <stddef.h>
#include <stdint.h>

#include "hal/device/display.h"

#define GUARD_PADDING 12  /* bytes behind the pixels of each row */
#define GUARD_CANARY 0xa5 /* their value */

struct guarded_screen {
	struct display_buffer buffer;
	uint8_t *map; /* private */
	size_t bytes; /* of the map */
};

/* Every byte of every pixel is `fill`. */
struct guarded_screen guarded_screen_create(int width, int height, int fill);

/* Pixel (x, y): four bytes. */
const uint8_t *guarded_screen_pixel(const struct guarded_screen *s, int x, int y);

/* Fails the test where bytes outside the pixels have changed. */
void guarded_screen_free(struct guarded_screen *s);

#endif
