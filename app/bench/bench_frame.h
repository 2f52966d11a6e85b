/* SPDX-License-Identifier: MIT */
/*
 * A whole frame, as a kiosk has it: two cameras' YUYV pictures of the basis's size to a picture.
 * For bench alone.
 */
#ifndef INLAY_APP_BENCH_BENCH_FRAME_H
#define INLAY_APP_BENCH_BENCH_FRAME_H

#include "hal/base/fault.h"
#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/frame/frame.h"

#define BENCH_CAMERA_BUFFERS 4
#define BENCH_SCREEN_BUFFERS 3

struct bench_frame;

/* The background camera's picture is made from a canvas; pool is what measures the light. -ENOTSUP:
 * the basis's lights are no dome's, so that no lens can look at them. */
int bench_frame_create(struct bench_frame **frame, const struct basis *basis,
		       const struct canvas *background, struct pool *pool, struct fault *fault);

/* Makes the fisheye camera's picture: each cell as bright as its light, at its limit where that is
 * beyond 1. -ENOMEM. */
int bench_frame_light(struct bench_frame *frame, const float (*radiance)[3]);

/* What may be left out from now on (compositor.h); 0, as created: by the threshold. */
void bench_frame_budget(struct bench_frame *frame, double budget);

/* Both cameras' next frames: the same pictures in the next of their buffers. */
void bench_frame_next(struct bench_frame *frame);

/* Parts of it: the light of all cells, and which are used; the background, converted alone. */
int bench_frame_measure(struct bench_frame *frame, double threshold, struct fault *fault);
void bench_frame_convert(const struct bench_frame *frame, struct canvas *out);

/* Conversion, light, composite; bytes: of the basis, read. */
int bench_frame_run(struct bench_frame *frame, struct compositor *compositor, double threshold,
		    struct canvas *out, uint64_t *bytes, struct fault *fault);

/* The background as the frame saw it, and the lights that it found: for measuring its error. */
struct picture bench_frame_background(const struct bench_frame *frame);
const struct light_selection *bench_frame_lights(const struct bench_frame *frame);

void bench_frame_destroy(struct bench_frame *frame); /* NULL is harmless */

#endif
