/* SPDX-License-Identifier: MIT */
/*
 * Lights over time: what a camera's noise makes of constant light is averaged away, a lamp that is
 * switched is followed within a set time. Between the sampler and the choice of lights, in linear
 * light, by the frames' own timestamps: neither the camera's rate nor a lost frame changes what
 * is shown at a time.
 *
 * State, for each light: y, three channels; and until when it is followed fast. A frame x, dt after
 * the one before, makes
 *
 *     y += a (x - y),   a = 1 - exp(-dt / tau)                               (0 <= a <= 1)
 *
 * with one of two time constants, the same for the three channels, so that no colour lags:
 *
 *     fast   tau = follow / ln 10: after `follow` a tenth of a change is left
 *     slow   tau = LIGHT_FILTER_SLOW times that
 *
 * A light is fast for `follow` from each frame in which it has changed beyond noise:
 *
 *     (x - y)^2 > 16 v   in any channel: four standard deviations of the light, or
 *     |sum of (x - y)| > 4 sqrt(sum of v) + sum of y / 100
 *                        over its channels and neighbours: the LIGHT_FILTER_GROUP lights of its
 *                        stretch of the dome's ring, or the whole sky
 *
 * so that what no light shows by itself, a small change of the whole room, is seen in the sum. A
 * hundredth stays slow there: flicker of the mains is no change, and a hundredth is a level at
 * most.
 *
 * v is the variance that noise gives a light of radiance y: of one pixel (pixel_noise.h), over the
 * pixels of the cell, a quarter of which count as independent: floor + slope y. v depends on y and
 * on what is known of the camera, never on x: noise to either side is treated alike.
 *
 * What follows:
 *   - Nothing overshoots: each y lies between the y before and x (it is also held there, floats
 *     being rounded), so in the hull of all x since the beginning. Constant light is returned as it
 *     is, bit by bit, from the first frame on.
 *   - Energy: with one a for all frames the weights of each x add up to 1 over the frames after it,
 *     and every light's to the same; what goes in comes out, later. Where a changes from frame to
 *     frame it does so by the size of x - y, not by its sign: noise around constant light leaves
 * its mean as it is.
 *   - A change beyond noise is at 90 % within `follow` of the first frame that shows it: a counts
 *     that frame's whole dt as lit, and the last frame within `follow` is at most one dt early.
 *   - Nothing sticks: there is no dead band. A light that moves slowly is behind by at most
 *     4 sqrt(v), as beyond that it is fast, or by what the slow tau makes of its speed if that is
 *     less; and arrives when it rests. Within sqrt(v) / 64 it is taken as it is.
 *   - Noise of constant light is lessened to sqrt(a / (2 - a)): at 30 Hz and 100 ms to 0.15 for the
 *     slow lane, whose frames differ by 0.05 of the camera's noise.
 */
#ifndef INLAY_HAL_LIGHTS_LIGHT_FILTER_H
#define INLAY_HAL_LIGHTS_LIGHT_FILTER_H

#include <stdint.h>

#include "hal/colour/transfer.h"

#define LIGHT_FILTER_SLOW 16
#define LIGHT_FILTER_GROUP 16
#define LIGHT_FILTER_FOLLOW_MAX 10 /* seconds */

struct light_filter;

/* 0 or -ENOMEM. It begins anew with the first frame, and knows of no noise. */
int light_filter_create(struct light_filter **filter, int lights);

/* How the lights are measured from now on, which begins anew: the camera's curve, what linear light
 * is multiplied by, and how many of its pixels see each light: pixels[lights], > 0. */
void light_filter_measured(struct light_filter *filter, const struct transfer_curve *curve,
			   double gain, const float *pixels);

/* The next frame is taken as it is. */
void light_filter_begin(struct light_filter *filter);

/*
 * radiance[lights] of a frame captured at captured_ns becomes what is to be shown. follow_ns 0:
 * off, it stays as it is. A frame that is older than the one before, or more than a second and
 * follow_ns newer, begins anew: the camera was away. Of the same moment: what it was. Radiance is
 * finite and not negative. Nothing is allocated.
 */
void light_filter_run(struct light_filter *filter, int64_t captured_ns, int64_t follow_ns,
		      float (*radiance)[3]);

void light_filter_destroy(struct light_filter *filter); /* NULL is harmless */

#endif
