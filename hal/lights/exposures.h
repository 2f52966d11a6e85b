/* SPDX-License-Identifier: MIT */
/*
 * One sky in several exposures, taken in turn by one camera, made one light: what clips in a long
 * one is whole in a shorter one, what drowns in a short one's noise is clear in a longer one.
 *
 * Exposure k lets in ratio[k] of the light that exposure 0 does: 0 is the longest, the one that
 * the sampler's gain is for. x is what the sampler makes of a light in exposure k, so
 *
 *     e_k = x / ratio[k]
 *
 * is its radiance, in the sampler's units at exposure 0, and one part of its pixels is clipped in
 * that frame. Each light keeps the newest e of every exposure, so that light comes at the camera's
 * rate:
 *
 *   whole     no pixel of it is clipped;
 *   clipped   some are: e is less than there is.
 *
 * A light is the mean of what is whole, weighted by the inverse variance (Granados et al., Optimal
 * HDR reconstruction with linear digital cameras, CVPR 2010, with camera noise as in
 * hal/lights/pixel_noise.h), in each channel by itself:
 *
 *     L = e_l + sum_k w_k (e_k - e_l) / sum_k w_k        l: the longest that is whole
 *     w_k = ratio[k]^2 / (64 floor + slope e_l ratio[k])    1 / variance of e_k, times pixels
 *
 * Weights follow from e_l, not from each e_k: noise does not choose its own weight. What is wrong
 * in the dark (a black level, noise that is cut off below it) is alike in all pixels and no number
 * of them takes it away: it counts as that of a light of 64. Noise in the light does average, and
 * the number of pixels, the same for all k, cancels. If all e_k are the same, L is that, bit by
 * bit; and lights that are alike stay so.
 *
 * Of a light that is clipped in the exposure before, l - 1, the dark part is clearer there, and
 * what is above its white is all that is missing: where both are known
 *
 *     L = e_(l-1) + x_l / ratio[l],   x_l the mean over its pixels of max(pixel - white_l, 0)
 *
 * in place of the mean (and never less than a longer one has), white_l = ratio[l] / ratio[l-1]
 * being where exposure l - 1 clips, as exposure l sees it. Of a lamp in a dim cell no pixel is then
 * taken from the noise of a short exposure.
 *
 * A light that is whole in none is taken from the shortest there is, in the same way: too dark, and
 * said to be clipped by as much as it is there.
 *
 * What is kept may have been overtaken by what has changed since. When a frame shows a light as
 * e_k, an e_j is forgotten that cannot be of the same light,
 *
 *     |e_k - e_j| > 4 sqrt(v_k + v_j) + max(e_k, e_j) / 8      in any channel,
 *     v_k = floor / ratio[k]^2 + slope min(e_k, e_j) / ratio[k] / n
 *
 * n: its pixels that count by themselves (PIXEL_NOISE_ALIKE). An eighth is what exposures may be
 * off from what they are said to be; a smaller change is there when all have been taken once. Of a
 * clipped one only being too dark counts, so that it does not outlive a lamp that went out, nor a
 * whole one a lamp that went on; and a longer one that is whole ends a shorter one that is not.
 */
#ifndef INLAY_HAL_LIGHTS_EXPOSURES_H
#define INLAY_HAL_LIGHTS_EXPOSURES_H

#include <stdbool.h>

#include "hal/colour/transfer.h"

#define EXPOSURES_MAX 5

struct light_exposures;

/* 0 or -ENOMEM. One exposure until it is told of others. */
int light_exposures_create(struct light_exposures **exposures, int lights);

/* What is measured from now on, which begins anew: count exposures of 1..EXPOSURES_MAX,
 * ratio[0] = 1 and each below the one before it, above 0; the camera's curve; what linear light is
 * multiplied by; how many pixels see each light: pixels[lights], > 0. */
void light_exposures_measured(struct light_exposures *exposures, const double *ratio, int count,
			      const struct transfer_curve *curve, double gain, const float *pixels);

/* Other ratios of as many exposures from the next frame on; what is kept of frames before stays. */
void light_exposures_ratios(struct light_exposures *exposures, const double *ratio);

/* Nothing is kept any longer. */
void light_exposures_begin(struct light_exposures *exposures);

/*
 * Whether a frame can be of exposure which: sampled[lights] and clipped[lights] as below. The
 * lights that are whole in it, or clipped all over, are as bright together as this exposure makes
 * the light that is known, or no other explains them better by a tenth. Of a light that has been
 * clipped in every exposure so far it is not known how bright a shorter one will show it. Exposures
 * are told apart while light changes by less than the square root of their ratio from frame to
 * frame; a greater change costs some frames, no more than a turn of them, as brighter than the
 * longest would show or darker than the shortest is always theirs. True as long as no light is
 * known.
 */
bool light_exposures_fit(const struct light_exposures *exposures, int which,
			 const float (*sampled)[3], const float *clipped);

/* white_l of above: what of exposure which, 1 and more, light_sampler_above() is to be told; 1 of
 * exposure 0, where nothing is. */
double light_exposures_above(const struct light_exposures *exposures, int which);

/*
 * Takes a frame of exposure which in: sampled[lights], excess[lights], the mean of what is above
 * that (not looked at of exposure 0), and clipped[lights], the share of each
 * light's pixels that is at its limit, 0..1. radiance[lights] gets the light, left[lights] the
 * share that is clipped in every exposure, at white[] below. May be the same arrays. Nothing is
 * allocated.
 */
void light_exposures_take(struct light_exposures *exposures, int which, const float (*sampled)[3],
			  const float (*excess)[3], const float *clipped, float (*radiance)[3],
			  float *left);

/* The radiance from which on the shortest exposure clips: the gain over its ratio. */
double light_exposures_white(const struct light_exposures *exposures);

void light_exposures_destroy(struct light_exposures *exposures); /* NULL is harmless */

#endif
