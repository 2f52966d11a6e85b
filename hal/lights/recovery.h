/* SPDX-License-Identifier: MIT */
/*
 * Recovers light that the fisheye camera clips, from the ground: the background camera sees a patch
 * of ground, and all light that the patch reflects came from the sky.
 *
 * In each channel let u_i be the ground's radiance under light i alone at radiance 1 (the basis's
 * ground term, or reflectance / pi times the light's projected solid angle), L_i the measured
 * lights, q_i the share of each that is clipped, w_i its solid angle, and B the patch's radiance:
 *
 *     D = B - sum_i u_i L_i                                               missing radiance
 *     D' = D^3 / (D^2 + (LIGHT_RECOVERY_UNSURE B)^2)                      if D > 0, else 0
 *     s_i = q_i min(1, L_i / (q_i white))^8 (u_i / w_i) / (A_i + LIGHT_RECOVERY_SMALL_SR)
 *     x = D' / sum_i u_i s_i
 *     L_i += x s_i
 *
 * One equation has as many unknowns as there are clipped lights; s is the assumption about how the
 * missing light is distributed. A_i is the solid angle of all that is clipped in one piece of sky
 * with light i (recovery_pieces.h).
 *
 *   - Pieces get like powers. If only the sizes of two clipped things are known, either may hold
 *     nearly all of the missing light, so the smaller one must be brighter. A piece of a few
 *     pixels, which noise alone may clip, gets less.
 *   - Within a piece, added radiance is proportional to u / w, the cosine to the ground's normal.
 *     That is the solution of least sum w x^2 / q for a given sum of u x. What clips just above the
 *     horizon is mostly lit, not a lamp; as a lamp it would light the object's side.
 *   - The eighth power: a channel in which a light is darker than its clipped pixels would make it
 *     is clipped in few of them. In a blue sky, blue clips, not red.
 *   - D' instead of D: reflectance, gain and lens are known to some percent, and less than that may
 *     not be missing at all. A calibration error of a percent must not make a lamp of the first
 *     pixel that clips. Where 30 % of B are missing, D' is less than D by 0.1 % of B; where
 *     LIGHT_RECOVERY_UNSURE are, D' = D / 2. D' has no step.
 * - 1 <= factor <= LIGHT_RECOVERY_MAX, where factor is the radiance of the brightest clipped pixel
 *     over white, the radiance at which pixels clip. No light is taken away, and the sun has room
 *     (a sky exposed to half of white has a sun of some 10^5).
 *
 * tests/accuracy/README.md says how often, and by how much, this improves the result in random
 * places. A light outside the lens's field is missing too, and would be attributed to what clips:
 * the field must be the hemisphere. Without clipped lights nothing changes. All radiances are in
 * the background camera's units.
 */
#ifndef INLAY_HAL_LIGHTS_RECOVERY_H
#define INLAY_HAL_LIGHTS_RECOVERY_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/colour/transfer.h"
#include "hal/frame/frame_reader.h"
#include "hal/optics/dome.h"

#define LIGHT_RECOVERY_MAX 1e6
#define LIGHT_RECOVERY_UNSURE 0.02
#define LIGHT_RECOVERY_SMALL_SR 0.002 /* a disc 2.9 degrees wide */

/* A patch of ground in the picture of a camera. */
struct light_ground {
	double radiance[3]; /* mean; white is 1 */
	double clipped;	    /* share of clipped pixels, 0..1; > 0: radiance is a lower bound */
};

/* Measures a rectangle inside the upright picture. decode: linear light of each code value; row:
 * scratch for width pixels. */
struct light_ground light_ground_see(const struct frame_reader *picture, int x, int y, int width,
				     int height, const float decode[256], uint32_t *row);

/* The lights as the ground sees them, and how much of each is clipped. */
struct light_clipping {
	int lights;
	const double *term[3];	      /* [lights] each: u, >= 0 */
	const double *solid_angle_sr; /* [lights]: w, > 0 */
	const float *clipped;	      /* [lights]: q, 0..1 */
	const double *piece_sr;	      /* [lights]: A, as clipped_pieces_find() returns it */
	double white;		      /* > 0 */
};

struct light_recovery {
	bool recovered;	  /* light was added */
	bool at_bound;	  /* more is missing (factor is at its limit) or may be (patch clipped) */
	double factor[3]; /* of each channel, as above */
};

/* Adds the recovered light to radiance[lights]. */
struct light_recovery light_recover(const struct light_ground *ground,
				    const struct light_clipping *clipping, float (*radiance)[3]);

/*
 * Groups clipped lights into connected pieces of sky: two clipped lights whose cells share an edge
 * are in one piece. A lamp is a piece, and so is a window, whatever number of lights it covers.
 */

struct clipped_pieces;

/* The dome is not needed afterwards. 0 or -ENOMEM. */
int clipped_pieces_create(struct clipped_pieces **pieces, const struct dome *dome);

/* clipped[lights]: share of each light's pixels that is clipped, 0..1. Returns [lights]: the
 * clipped solid angle of the light's piece in sr, 0 for lights that are not clipped; valid until
 * the next call. Allocates nothing; takes linear time. */
const double *clipped_pieces_find(struct clipped_pieces *pieces, const float *clipped);

void clipped_pieces_destroy(struct clipped_pieces *pieces); /* NULL is harmless */

#endif
