/* SPDX-License-Identifier: MIT */
/*
 * Filters lights over time: averages the camera's noise in constant light, and follows a lamp that
 * is switched within a set time. It runs between the sampler and the choice of lights, in linear
 * light, by the timestamps of the frames: neither the camera's rate nor a lost frame changes the
 * result at a given time.
 *
 * State of each light: y, three channels, and until when the light is fast. A frame x, dt after the
 * one before, makes
 *
 *     y += a (x - y)
 *     a = 1 - exp(-dt / tau)                                                  0 <= a <= 1
 *
 * with one of two time constants, the same for the three channels, so that no colour lags:
 *
 *     fast   tau = follow / ln 10: a tenth of a change is left after `follow`
 *     slow   tau = LIGHT_FILTER_SLOW * follow / ln 10
 *
 * A light is fast for `follow` from each frame on in which it changed beyond noise:
 *
 *     (x - y)^2 > 16 v                                       in any channel of the light, or
 *     |sum (x - y)| > 4 sqrt(sum v) + sum y / 100            over all channels of the lights of its
 *                                                            group or of the whole sky
 *
 * A group is LIGHT_FILTER_GROUP lights in succession, neighbours on the dome. The sums detect a
 * small change of the whole room that no light shows alone. A change of a hundredth stays slow
 * there: it may be flicker of the mains, and is one level at most.
 *
 * v is the variance of a light of radiance y: that of one pixel (pixel_noise.h) over the number of
 * independent pixels of the cell, a quarter of all:
 *
 *     v = floor + slope y
 *
 * v depends on y and on the camera, never on x, so that noise to either side is treated alike.
 *
 * Properties:
 *   - No overshoot: y stays between the y before and x (rounding is clamped to that), so in the
 *     range of all x since the beginning. Constant light is returned to the bit from the first
 *     frame on.
 *   - Energy: with one a for all frames, the weights of each x sum to 1 over the frames after it,
 *     for every light: no light is lost, it comes later. Where a changes it does so by the size of
 *     x - y, not by its sign: noise around constant light leaves its mean unchanged.
 *   - A change beyond noise is at 90 % within `follow` of the first frame that shows it: a counts
 *     the whole dt of that frame, and the last frame within `follow` is at most one dt early.
 *   - No dead band: a light that moves slowly lags by at most 4 sqrt(v), beyond which it becomes
 *     fast, or by its speed times the slow tau if that is less. Once x stays, y reaches x: within
 *     sqrt(v) / 64 of it, y = x.
 *   - Noise of constant light is reduced by the factor sqrt(a / (2 - a)): at 30 Hz and `follow` =
 *     100 ms to 0.15 by the slow constant; successive frames then differ by 0.05 of the camera's
 *     noise.
 */
#ifndef INLAY_HAL_LIGHTS_LIGHT_FILTER_H
#define INLAY_HAL_LIGHTS_LIGHT_FILTER_H

#include <stdint.h>

#include "hal/colour/transfer.h"

#define LIGHT_FILTER_SLOW 16	   /* slow tau over fast tau */
#define LIGHT_FILTER_GROUP 16	   /* lights */
#define LIGHT_FILTER_FOLLOW_MAX 10 /* seconds */

struct light_filter;

/* Creates a filter that takes its first frame unchanged and expects no noise. 0 or -ENOMEM. */
int light_filter_create(struct light_filter **filter, int lights);

/* Sets how lights are measured from now on, and begins again: the camera's curve, the gain of
 * linear light, and pixels[lights], the number of pixels that see each light, > 0. */
void light_filter_measured(struct light_filter *filter, const struct transfer_curve *curve,
			   double gain, const float *pixels);

/* Begins again: the next frame is taken unchanged. */
void light_filter_begin(struct light_filter *filter);

/*
 * Filters radiance[lights] of a frame captured at captured_ns, in place. Radiance is finite and not
 * negative. follow_ns 0: off, radiance is unchanged. A frame older than the one before, or newer by
 * more than a second and follow_ns, begins again: the camera was away. A frame of the same time
 * returns the last result. Allocates nothing.
 */
void light_filter_run(struct light_filter *filter, int64_t captured_ns, int64_t follow_ns,
		      float (*radiance)[3]);

void light_filter_destroy(struct light_filter *filter); /* NULL is harmless */

#endif
