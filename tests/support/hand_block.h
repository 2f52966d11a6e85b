/* SPDX-License-Identifier: MIT */
/* Blocks of a basis file from values that a test sets by hand: no patterns, and for each light a
 * column of 16 bits. */
#ifndef INLAY_TESTS_SUPPORT_HAND_BLOCK_H
#define INLAY_TESTS_SUPPORT_HAND_BLOCK_H

#include <stdint.h>

#include "hal/basis/basis_writer.h"

/*
 * A block of kind T. value[pixels][3][lights] is the radiance that a pixel gives off for a light of
 * radiance 1; pixel[pixels] are the pixels' numbers in the tile; light[lights] are the file's
 * lights. The caller frees the payload.
 */
struct basis_block_payload hand_block_of_object(uint32_t tile, int pixels, const uint16_t *pixel,
						int lights, const struct basis_light *light,
						const float *value);

#endif
