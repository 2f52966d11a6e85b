/* SPDX-License-Identifier: MIT */
/* Blocks of a basis file from values that a test sets by hand: no patterns, and for each light a
 * column of 16 bits. */
#ifndef INLAY_TESTS_SUPPORT_BASIS_HAND_BLOCK_H
#define INLAY_TESTS_SUPPORT_BASIS_HAND_BLOCK_H

#include <stdint.h>

#include "hal/basis/basis_writer.h"

/* Fills light[lights] with the cells of a dome whose nodes are divided by angles. It must have that
 * many. */
void hand_block_lights(int frequency, int lights, struct basis_light *light);

/*
 * A block of kind T. value[pixels][3][lights] is the radiance that a pixel gives off for a light of
 * radiance 1; pixel[pixels] are the pixels' numbers in the tile; light[lights] are the file's
 * lights. The caller frees the payload.
 */
struct basis_block_payload hand_block_of_object(uint32_t tile, int pixels, const uint16_t *pixel,
						int lights, const struct basis_light *light,
						const float *value);

/* Writes a basis file of one pose with one block, and frees the block's payload. The lights are
 * their own coarse lights. Shapes are those of basis_writer_open() and basis_writer_pose_end(). */
void hand_block_file(const char *path, const struct basis_info_chunk *info,
		     const struct basis_light *light, const struct basis_block_payload *block,
		     const uint16_t *coverage, const float (*peak)[3]);

#endif
