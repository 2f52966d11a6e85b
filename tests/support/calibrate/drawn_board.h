/* SPDX-License-Identifier: MIT */
/*
 * Draws pictures of a calibration board through a known camera. board_ink() says where the ink is;
 * the paper is one square wider than the ink, and behind the board is a grey wall. Light is
 * averaged over each pixel before it is encoded in sRGB.
 */
#ifndef INLAY_TESTS_SUPPORT_CALIBRATE_DRAWN_BOARD_H
#define INLAY_TESTS_SUPPORT_CALIBRATE_DRAWN_BOARD_H

#include <stdint.h>

#include "bake/calibrate/observe/boards.h"
#include "hal/image/image.h"
#include "hal/optics/tsai.h"

struct drawn_board {
	const struct board *board;
	const struct tsai_camera *camera;
	double blur_px;	   /* standard deviation of a Gaussian; 0: no blur */
	double noise;	   /* standard deviation in 8-bit levels */
	uint64_t seed;	   /* of the noise */
	double ink, paper; /* linear light; both 0: 0.03 and 0.8 */
};

/* Creates the picture, of the camera's size; the caller frees it. 0, or what image_create_u8()
 * returns. */
int drawn_board_draw(const struct drawn_board *drawn, struct image *picture);

#endif
