/* SPDX-License-Identifier: MIT */
/* The thesis's own algorithm, and the plain numbers of a basis that it needs. */
#ifndef INLAY_HAL_MEASURE_THESIS_H
#define INLAY_HAL_MEASURE_THESIS_H

#include <stdbool.h>

#include "hal/base/fault.h"
#include "hal/base/pool.h"
#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/frame/frame.h"

/*
 * Decodes a layer of a basis, tile by tile, to plain numbers for each light.
 */

#define UNPACKED_PIXELS (BASIS_TILE * BASIS_TILE)

/* The values of one tile, per unit of L_i. Pixel p is y * BASIS_TILE + x. */
struct unpacked {
	int lights;
	float (*object)[UNPACKED_PIXELS]; /* [3 * lights]: t, premultiplied by coverage */
	float (*unlit)[UNPACKED_PIXELS];  /* [3 * lights]: u, the receiver without the object */
	float (*taken)[UNPACKED_PIXELS];  /* [3 * lights]: d = u - s */
	bool is_object[UNPACKED_PIXELS], is_receiver[UNPACKED_PIXELS];
};

int unpacked_create(struct unpacked *unpacked, const struct basis *basis); /* -ENOMEM */
void unpacked_free(struct unpacked *unpacked); /* idempotent; zeroed is fine */

/* Fills in a tile. Channel c of light i is row c * lights + i. */
void unpacked_fill(struct unpacked *unpacked, const struct basis *basis,
		   const struct basis_tile *tile);

/*
 * The algorithm of the thesis (its appendix, superimpose()), for comparison. A pixel is object,
 * shadow or neither. Each object pixel has its own allocated row of three bytes for each light,
 * each shadow pixel of six (ground without the object, ground with it). Sums are in double
 * precision over the lights that reach the threshold. Code values are used without a transfer
 * function.
 *
 * Rows are quantised as well as a byte allows: all object rows to the brightest value of any pixel
 * under any light, each shadow row to its own brightest value.
 */

struct thesis;

/* Role of a pixel. Its row has 3 * role bytes for each light. */
enum thesis_role { THESIS_PICTURE, THESIS_OBJECT, THESIS_SHADOW };

/* Converts a layer of pose 0, with the pool's threads. -ENOMEM: the fault says how much memory is
 * needed; where too little is free, before any is allocated. */
int thesis_create(struct thesis **thesis, const struct basis *basis,
		  const struct basis_layer *layer, struct pool *pool, struct fault *fault);

/* Returns the role of a pixel, and its row; NULL for THESIS_PICTURE. thesis_rate(): radiance of
 * byte 255 in an object row. */
enum thesis_role thesis_pixel(const struct thesis *thesis, int x, int y, const uint8_t **row);
double thesis_rate(const struct thesis *thesis);

uint64_t thesis_bytes(const struct thesis *thesis, int lights_used); /* that a frame reads */

/* Copies the lights of the selection. */
void thesis_light(struct thesis *thesis, const struct light_selection *lights);

/* Makes a frame in out, a row at a time in the pool's threads. out and background have the basis's
 * size. */
void thesis_run(const struct thesis *thesis, const struct canvas *background, struct canvas *out,
		struct pool *pool);

void thesis_destroy(struct thesis *thesis); /* NULL is harmless */

#endif
