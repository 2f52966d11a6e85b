/* SPDX-License-Identifier: MIT */
/*
 * A veil tells the compositor where people are in the background's picture. In each pixel, with
 *
 *     f   share that somebody in front of the object covers, 0..1
 *     a   share that anybody covers, a >= f
 *     C   the background as the camera sees it
 *     F   the colour of the people alone, where 0 < f < 1; else C
 *
 * the picture becomes
 *
 *     O'        = (1 - f) O
 *     coverage' = (1 - f) coverage
 *     1 - ratio' = (1 - a) (1 - ratio)
 *     B         = C + coverage (F - C)      in code values
 *
 * in the formula of compositor.h; what the object shows of the background counts as O. f = 1 shows
 * the camera's own pixel, to the bit. a hides the ground that the object shadows, so a person who
 * stands in the shadow, or behind the object, is not darkened by it; that is so for every a,
 * whatever the order.
 */
#ifndef INLAY_HAL_COMPOSITOR_VEIL_H
#define INLAY_HAL_COMPOSITOR_VEIL_H

#include <stdint.h>

/* The planes have the basis's size, and contiguous rows. Everything is borrowed for the frame. */
struct veil {
	/* [tiles], row by row: 0 where f and a are 0 in the whole tile; the planes below are not
	 * read there. */
	const uint8_t *tile;
	const uint8_t *front;	 /* f: [height][width], 255 = 1 */
	const uint8_t *anybody;	 /* a: the same */
	const uint8_t *foremost; /* F: BGRX [height][width]; read where 0 < f < 255 only */
};

#endif
