/* SPDX-License-Identifier: MIT */
/*
 * Pictures from files, one after the other:
 *     img%03d.png    numbered pictures, from 0 or 1 on, until one is missing
 *     clip.y4m       Y4M video; a named pipe or /dev/stdin plays as it comes
 *     room.png       one picture for ever
 * All pictures have one size and kind: 8-bit code values, or linear light (.hdr, .pfm, .exr).
 */
#ifndef INLAY_DRIVERS_SIM_PLAYER_H
#define INLAY_DRIVERS_SIM_PLAYER_H

#include <stdbool.h>

#include "hal/device/camera.h"

struct player;

struct player_settings {
	const char *path;
	bool loop;
	int matrix, range; /* as camera_settings; for Y4M */
};

/* What plays. */
struct player_picture {
	int width, height;
	double rate_hz;	     /* 0: not said */
	int descriptor;	     /* of a pipe, for poll; -1: pictures are there whenever asked for */
	const uint8_t *bgrx; /* rows of width * 4 bytes; NULL when the pictures are linear */
	const float *linear; /* RGB; NULL when they are 8-bit */
};

int player_open(struct player **player, const struct player_settings *settings,
		struct fault *fault);

/* Moves on by `steps` >= 1 pictures and decodes that one; the first call with 1 gives the first.
 * 0; -EAGAIN: a pipe has none yet; -ENODATA: the end, not looped. */
int player_next(struct player *player, uint64_t steps, struct fault *fault);

struct player_picture player_picture(const struct player *player);

void player_close(struct player *player); /* NULL is harmless */

#endif
