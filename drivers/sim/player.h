/* SPDX-License-Identifier: MIT */
/*
 * Plays pictures from files:
 *
 *     img%03d.png    numbered pictures, from 0 or 1 on, until one is missing
 *     clip.y4m       Y4M video; a named pipe or /dev/stdin plays as its bytes arrive
 *     room.png       one picture for ever
 *
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
	int matrix, range; /* as in camera_settings; used for Y4M only */
};

/* The present picture. The player owns the memory; it is valid until player_next(). */
struct player_picture {
	int width, height;
	double rate_hz;	     /* 0: not known */
	int descriptor;	     /* of a pipe, for poll(); -1: pictures are always ready */
	const uint8_t *bgrx; /* rows of width * 4 bytes; NULL: the pictures are linear */
	const float *linear; /* RGB; NULL: the pictures are 8-bit */
};

/* Opens the files; the caller closes *player. 0 or -errno with a fault; -ETIMEDOUT: a pipe sent no
 * header. */
int player_open(struct player **player, const struct player_settings *settings,
		struct fault *fault);

/* Advances by `steps` >= 1 pictures and decodes the new one; the first call with 1 gives the first
 * picture. 0; -EAGAIN: a pipe has no whole picture yet; -ENODATA: the end, if not looped. */
int player_next(struct player *player, uint64_t steps, struct fault *fault);

struct player_picture player_picture(const struct player *player);

void player_close(struct player *player); /* NULL is harmless */

#endif
