/* SPDX-License-Identifier: MIT */
/*
 * What looks at the background's picture besides the compositor: people, the camera's exposure and
 * noise. For bench alone.
 */
#ifndef INLAY_APP_BENCH_BENCH_LOOK_H
#define INLAY_APP_BENCH_BENCH_LOOK_H

#include "app/bench/bench_frame.h"
#include "hal/base/fault.h"
#include "hal/basis/basis.h"
#include "hal/compositor/live/grain.h"
#include "hal/compositor/live/veil.h"
#include "hal/frame/view.h"

struct bench_look;

/* Learns the place, around the object of pose 0, from 100 pictures of the visitors' camera, and
 * then lets visitors in. cameras NULL: the basis's lights are no dome's, and nobody is looked for.
 * 0 or -ENOMEM. */
int bench_look_create(struct bench_look **look, const struct basis *basis,
		      struct bench_frame *cameras, const struct canvas *background,
		      struct fault *fault);
void bench_look_destroy(struct bench_look *look); /* NULL is harmless */

/* Noise of an ordinary camera: 2 levels at mid-grey. */
const struct grain *bench_look_grain(const struct bench_look *look);

/* Looks for people in a picture; NULL: there are none. Not without cameras. */
const struct veil *bench_look_people(struct bench_look *look, const struct picture *picture);

/* Follows the exposure of a picture. Not without cameras. */
void bench_look_exposure(struct bench_look *look, const struct picture *picture);

/* Looks for lamps that flicker in the rows of a picture. Not without cameras. */
void bench_look_flicker(struct bench_look *look, const struct picture *picture);

/* Makes light of every cell neutral. Not without cameras. */
void bench_look_neutral(struct bench_look *look);

#endif
