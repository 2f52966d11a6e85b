/* SPDX-License-Identifier: MIT */
/* The fisheye's picture as mirrors show it. */
#ifndef INLAY_HAL_MIRROR_MIRROR_EYE_H
#define INLAY_HAL_MIRROR_MIRROR_EYE_H

#include "hal/base/pool.h"
#include "hal/frame/frame_reader.h"
#include "hal/image/image.h"
#include "hal/lights/exposures.h"
#include "hal/mirror/mirror_map.h"
#include "hal/optics/fisheye.h"

struct mirror_eye {
	int width, height; /* of the fisheye's picture; 0: none yet */
	int level;	   /* of the map, that is read from the picture */
	int taps;	   /* places in each texel at which the picture is read */
	uint32_t *tap;	   /* [texels][taps]: y * width + x */
	float *brighter;   /* [texels]: 1 / (the lens's falloff * taps) */
	/* [height][width] each: the last picture of each exposure, BGRX; NULL: none yet */
	uint32_t *code[EXPOSURES_MAX];
	float *linear;	/* [height][width][3]: a linear picture instead; NULL: none yet */
	bool is_linear; /* the last picture is in linear */
};

/* How code values become light. */
struct mirror_colours {
	double decode[256]; /* linear light of each code value */
	/* From the picture's colours to those of the background, gain included, row by row. */
	double matrix[9];
	const double *ratio; /* [EXPOSURES_MAX]: light of each exposure beside the first one's */
	/* [lights]: radiance to add to pixels of each light that clip in all exposures, in those
	 * colours. */
	const double (*clipped)[3];
};

/* Prepares for upright pictures of this size. -ENOMEM. */
int mirror_eye_prepare(struct mirror_eye *eye, const struct fisheye *lens, int width, int height);
void mirror_eye_free(struct mirror_eye *eye); /* idempotent; zeroed is fine */

/* Takes a picture of that size, of code values of an exposure or of linear radiance, which is then
 * not needed. -ENOMEM. */
int mirror_eye_take(struct mirror_eye *eye, const struct frame_reader *frame, int exposure);
int mirror_eye_take_linear(struct mirror_eye *eye, const struct image *picture);

/* Fills the map from the first exposure's last picture, and what clips in it from the shorter ones.
 * The pool may be NULL. */
void mirror_eye_fill(const struct mirror_eye *eye, const struct mirror_colours *colours,
		     struct pool *pool, struct mirror_map *map);

#endif
