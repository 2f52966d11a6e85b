/* SPDX-License-Identifier: MIT */
/*
 * What looks at the background's picture besides the compositor: people, the camera's exposure and noise. For
 * bench alone.
 */
#ifndef INLAY_APP_BENCH_BENCH_LOOK_H
#define INLAY_APP_BENCH_BENCH_LOOK_H

#include "hal/base/fault.h"
#include "hal/basis/basis.h"
#include "hal/compositor/live/grain.h"
#include "hal/frame/view.h"

struct bench_look;

/* Learns the place from the background, around the object of pose 0. 0 or -ENOMEM. Nobody is looked
 * for where the basis's lights are no dome's. */
int bench_look_create(struct bench_look **look, const struct basis *basis,
		      const struct picture *background, struct fault *fault);
void bench_look_destroy(struct bench_look *look); /* NULL is harmless */

/* Noise of an ordinary camera: 2 levels at mid-grey. */
const struct grain *bench_look_grain(const struct bench_look *look);

/* Looks for people in the picture, a third of which is not the learned place. */
void bench_look_people(struct bench_look *look);

/* Follows the exposure of the same picture. */
void bench_look_exposure(struct bench_look *look);

/* Looks for lamps that flicker in the rows of the same picture. */
void bench_look_flicker(struct bench_look *look);

/* Makes light of every cell neutral. */
void bench_look_neutral(struct bench_look *look);

#endif
