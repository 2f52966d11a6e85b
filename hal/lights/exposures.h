/* SPDX-License-Identifier: MIT */
/*
 * Merges several exposures of one sky, which one camera takes in turn, into one radiance per light.
 * A light that clips in a long exposure is whole in a shorter one; a light that drowns in the noise
 * of a short exposure is clear in a longer one.
 *
 * Exposure k gathers ratio[k] of the light of exposure 0, which is the longest and the one that the
 * sampler's gain is for. With x the sampler's value of a light in exposure k, its estimate is
 *
 *     e_k = x / ratio[k]
 *
 * in the sampler's units at exposure 0. In one frame a light is
 *
 *   whole     no pixel of it is clipped;
 *   clipped   some are: e_k is a lower bound. In all exposures but the shortest this begins before
 *             255, where a camera's pixels are no longer believed (soft() of pixel_noise.h).
 *
 * Each light keeps the newest e_k of every exposure, so that results come at the camera's rate.
 *
 * Whole lights. The result is the mean of the whole estimates, weighted by inverse variance
 * (Granados et al., Optimal HDR reconstruction with linear digital cameras, CVPR 2010, with the
 * noise of hal/lights/pixel_noise.h), for each channel:
 *
 *     L = e_l + sum_k w_k (e_k - e_l) / sum_k w_k           l: the longest whole exposure
 *     w_k = ratio[k]^2 / (64 floor + slope e_l ratio[k])    1 / (variance of e_k * pixels)
 *
 * The weights depend on e_l, not on e_k, so that noise does not choose its own weight. Errors in
 * the dark (a wrong black level, noise cut off below it) are the same in all pixels and do not
 * average out: they count as in a light of 64 pixels. Noise of light does average, and the number
 * of pixels, the same for all k, cancels. If all e_k are equal, L is equal to them to the bit.
 *
 * Lights clipped in exposure l - 1. The dark pixels of such a light are clearer in exposure l - 1,
 * and only the light that is not believed is missing there. If both are known, the result is
 *
 *     L = e_(l-1) + x_l / ratio[l]
 *     x_l = mean over the light's pixels of x - r soft(x / r),   r = ratio[l] / ratio[l-1]
 *
 * instead of the mean. Without noise e_(l-1), the mean of soft(x), and x_l add up to the light,
 * whatever soft() is; as it is smooth, noise near white averages out.
 * Thus the dim pixels around a lamp never come from the noise of a short exposure. In the other
 * cases the result is at least every estimate of a longer, clipped exposure.
 *
 * Lights clipped in all exposures. The result comes from the shortest one in the same way. It is
 * too dark, and reported as clipped by the share that is clipped there.
 *
 * Parts. A light whose place inside its cell is known is measured in parts (the thirds of
 * dome_placed.h). What is chosen, w, and what follows below come from the mean of the parts; each
 * part is then merged with the same weights. So the place of a lamp is that in the exposures its
 * light comes from, and not that of the pixels that clip.
 *
 * Changing light. When a frame shows a light as e_k, each older e_j that cannot be of the same
 * light is forgotten:
 *
 *     e_k whole, e_j whole        one exceeds the other
 *     e_k clipped, e_j whole      e_k exceeds e_j, or exposure k is the shorter one
 *     e_k whole, e_j clipped      e_j exceeds e_k, or exposure k is the longer one
 *
 * "a exceeds b" means, in any channel,
 *
 *     a - b > 4 sqrt(v_k + v_j) + a / 8
 *     v_k = floor / ratio[k]^2 + slope b / (ratio[k] n)
 *
 * n: number of independent pixels of the light (PIXEL_NOISE_ALIKE). The eighth is the tolerance of
 * the camera's exposures; the result follows a smaller change after one turn of all exposures. So a
 * clipped estimate does not outlive a lamp that went out, nor a whole one a lamp that went on.
 */
#ifndef INLAY_HAL_LIGHTS_EXPOSURES_H
#define INLAY_HAL_LIGHTS_EXPOSURES_H

#include <stdbool.h>

#include "hal/colour/transfer.h"

#define EXPOSURES_MAX 5
#define EXPOSURES_PARTS 3 /* at most */

struct light_exposures;

/* Starts with one exposure, and lights of one part. 0 or -ENOMEM. */
int light_exposures_create(struct light_exposures **exposures, int lights);

/* Sets the parts of each light, 1..EXPOSURES_PARTS, and forgets all estimates. */
void light_exposures_parts(struct light_exposures *exposures, int parts);

/* Sets what is measured from the next frame on, and forgets all estimates. count: 1..EXPOSURES_MAX
 * exposures; ratio[0] = 1, the others > 0 and descending; curve: the camera's; gain: the factor of
 * linear light; pixels[lights]: number of pixels that see each light, > 0. */
void light_exposures_measured(struct light_exposures *exposures, const double *ratio, int count,
			      const struct transfer_curve *curve, double gain, const float *pixels);

/* Sets other ratios of the same number of exposures from the next frame on; keeps all estimates. */
void light_exposures_ratios(struct light_exposures *exposures, const double *ratio);

/* Forgets all estimates. */
void light_exposures_begin(struct light_exposures *exposures);

/*
 * Whether a frame can be of exposure which; sampled and clipped as in
 * light_exposures_take(). Compares the frame's total brightness with what each exposure would show
 * of the known light. False if another exposure explains it better by more than a tenth. Leaves out
 * lights that are clipped in part, and those clipped in every exposure so far, whose brightness is
 * unknown. The test is right while light changes from frame to frame by less than the square root
 * of the exposures' ratio. A greater change costs some frames, at most one turn: a frame brighter
 * than the longest exposure would show, or darker than the shortest, always fits that exposure.
 * True as long as no light is known.
 */
bool light_exposures_fit(const struct light_exposures *exposures, int which,
			 const float (*sampled)[3], const float *clipped);

/* The arguments of light_sampler_exposure() for exposure which: its ratio to the next longer one (1
 * for exposure 0), and whether there is a shorter one. */
double light_exposures_longer(const struct light_exposures *exposures, int which);
bool light_exposures_shorter(const struct light_exposures *exposures, int which);

/*
 * Merges a frame of exposure which; all arrays are [lights * parts]. sampled: the sampler's values;
 * excess: their part x_l that the longer exposure does not believe (ignored for exposure 0);
 * clipped: share of the pixels that is clipped, 0..1. Writes the result to radiance, and to left
 * the share that is clipped in every exposure. Outputs may be the input arrays. Allocates nothing.
 */
void light_exposures_take(struct light_exposures *exposures, int which, const float (*sampled)[3],
			  const float (*excess)[3], const float *clipped, float (*radiance)[3],
			  float *left);

/* The radiance at which the shortest exposure clips: gain / ratio[count - 1]. */
double light_exposures_white(const struct light_exposures *exposures);

void light_exposures_destroy(struct light_exposures *exposures); /* NULL is harmless */

#endif
