/* SPDX-License-Identifier: MIT */
/* Draws the photographs of a board that a fisheye's calibration takes. */
#ifndef INLAY_TESTS_SUPPORT_CALIBRATE_FISHEYE_PHOTOGRAPHS_H
#define INLAY_TESTS_SUPPORT_CALIBRATE_FISHEYE_PHOTOGRAPHS_H

#include "bake/calibrate/observe/boards.h"
#include "hal/image/image.h"
#include "hal/optics/fisheye.h"
#include "tests/support/chance.h"

#define FISHEYE_PHOTOGRAPHS 9
#define FISHEYE_PHOTOGRAPH_WIDTH 960
#define FISHEYE_PHOTOGRAPH_HEIGHT 720

/* Photograph k of FISHEYE_PHOTOGRAPHS: the board lies on the axis in the first and around it in the
 * others, tilted at random. The caller frees the image. 0 or -ENOMEM. */
int fisheye_photograph_board(struct image *image, const struct board *board,
			     const struct fisheye *lens, int k, struct chance *chance);

#endif
