/* SPDX-License-Identifier: MIT */
/*
 * A whole frame as in a kiosk: from YUYV pictures of two cameras, of the basis's size, to a
 * picture. For bench alone.
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

/* Makes the background camera's picture from a canvas. pool: threads that measure the light;
 * borrowed. -ENOTSUP: the basis's lights are no dome's, so no lens can look at them. */
int bench_frame_create(struct bench_frame **frame, const struct basis *basis,
		       const struct canvas *background, struct pool *pool, struct fault *fault);

/* Makes the fisheye camera's picture: each cell shows min(its light, 1). 0 or -ENOMEM. */
int bench_frame_light(struct bench_frame *frame, const float (*radiance)[3]);

/* Sets what may be left out (struct light_selection, budget); 0, as created: the threshold
 * decides. */
void bench_frame_budget(struct bench_frame *frame, double budget);

/* Goes on to the next buffer of each camera; they hold the same pictures. */
void bench_frame_next(struct bench_frame *frame);

/* Parts of a frame: measures the light of all cells and chooses those in use; converts the
 * background. */
int bench_frame_measure(struct bench_frame *frame, double threshold, struct fault *fault);
void bench_frame_convert(const struct bench_frame *frame, struct canvas *out);

/* Makes a frame: light, then conversion and composite in one. *bytes: read of the basis. */
int bench_frame_run(struct bench_frame *frame, struct compositor *compositor, double threshold,
		    struct canvas *out, uint64_t *bytes, struct fault *fault);

/* The background as the cameras saw it, and the lights in use: for the error of the frame. */
struct picture bench_frame_background(const struct bench_frame *frame);
const struct light_selection *bench_frame_lights(const struct bench_frame *frame);

void bench_frame_destroy(struct bench_frame *frame); /* NULL is harmless */

#endif
