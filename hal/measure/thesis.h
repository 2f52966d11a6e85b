/* SPDX-License-Identifier: MIT */
/*
 * The thesis's own way to composite (its appendix, superimpose()), to hold ours against: a pixel is
 * object, shadow or neither; each has a row of memory of its own with three bytes a light, six in
 * shadow (the ground without the object, and with it); sums are in double precision, lights are
 * those that reach its threshold, and code values are taken as they are, without a transfer
 * function.
 *
 * Rows are quantised as kindly as a byte allows: those of the object to the brightest value that
 * any pixel has under any light, those in shadow each to its own.
 */
#ifndef INLAY_HAL_MEASURE_THESIS_H
#define INLAY_HAL_MEASURE_THESIS_H

#include "hal/base/fault.h"
#include "hal/base/pool.h"
#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/frame/frame.h"

struct thesis;

/* What a pixel is; a row has three bytes a light times this. */
enum thesis_role { THESIS_PICTURE, THESIS_OBJECT, THESIS_SHADOW };

/* Made from a layer of pose 0, by the pool's threads. -ENOMEM, with how much is needed and how much
 * there is, before any of it is taken. */
int thesis_create(struct thesis **thesis, const struct basis *basis,
		  const struct basis_layer *layer, struct pool *pool, struct fault *fault);

/* The threads that frames are made by; before the first. -ENOMEM. */
int thesis_share(struct thesis *thesis, struct pool *pool);

/* What it is made of. A byte of an object's row is light of rate / 255; rows are NULL in PICTURE.
 */
enum thesis_role thesis_pixel(const struct thesis *thesis, int x, int y, const uint8_t **row);
double thesis_rate(const struct thesis *thesis);

uint64_t thesis_bytes(const struct thesis *thesis, int lights_used); /* read by a frame */

/* Its lights are the selection's, at the moment. */
void thesis_light(struct thesis *thesis, const struct light_selection *lights);

/* One frame into out, which has the basis's size as the background has. */
void thesis_run(struct thesis *thesis, const struct canvas *background, struct canvas *out);

void thesis_destroy(struct thesis *thesis); /* NULL is harmless */

#endif
