/* SPDX-License-Identifier: MIT */
/*
 * What a fisheye camera clips, found again on the ground: the background camera sees a patch of it,
 * and all light that the patch gives back came from the sky.
 *
 * In each channel, with u_i the ground's radiance under light i alone of radiance 1 (the basis's
 * ground term, or reflectance / pi times the light's projected solid angle), L_i the lights as they
 * were measured, q_i the share of each that is clipped and B the patch's radiance:
 *
 *     B - sum_i u_i L_i = D                  what is missing
 *     L_i += x s_i,   x = D' / sum_i u_i s_i
 *     s_i = q_i min(1, L_i / (q_i white))^8 (u_i / w_i) / (A_i + LIGHT_RECOVERY_SMALL_SR)
 *
 * One equation, and as many unknowns as there are clipped lights: s is what is expected of them.
 * A_i is the solid angle of all that is clipped in one piece with light i (recovery_pieces.h), w_i
 * the light's own. So
 *
 *   - pieces get like powers: if nothing is known of two things that clip but their sizes, either
 *     may be nearly all of what is missing, and a small one must be brighter for it. A piece of a
 *     few pixels, which noise alone may clip, gets less;
 *   - within a piece, radiance goes with the cosine to the ground's normal, u / w: the x of least
 *     sum w x^2 / q with that sum of u x. What clips just above the horizon is mostly lit, not a
 *     lamp, and taken for one it would light the object's side;
 *   - a channel that shows less of a light than its clipped pixels would give is clipped in few of
 *     them: of a blue sky, not the red. A light that is clipped in a corner keeps the rest as it
 *     was.
 *
 * How often that is better than nothing, and by how much, in random places:
 * tests/accuracy/README.md. Then
 *
 *   - D' = D^3 / (D^2 + (LIGHT_RECOVERY_UNSURE B)^2) in place of D: how right reflectance, gain and
 *     lens are is known to some percent, and what is missing by less may not be missing at all; a
 *     calibration that is off by a percent makes no lamp of the first pixel that clips. Of 30 %
 *     missing it takes 0.1 % less, of LIGHT_RECOVERY_UNSURE half; it has no step.
 *   - 1 <= factor <= LIGHT_RECOVERY_MAX, factor being how much brighter the brightest clipped pixel
 *     is made than white, the radiance at which it clips: nothing is taken away, and the sun has
 *     room (a sky that is exposed to half of white has a sun of some 10^5).
 *
 * A light outside of the lens's field is missing too, and would be found in what clips: the field
 * has to be the hemisphere.
 *
 * Where nothing clips nothing is done. All radiances are in the background's units.
 */
#ifndef INLAY_HAL_LIGHTS_RECOVERY_H
#define INLAY_HAL_LIGHTS_RECOVERY_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/colour/transfer.h"
#include "hal/frame/frame_reader.h"

#define LIGHT_RECOVERY_MAX 1e6
#define LIGHT_RECOVERY_UNSURE 0.02
#define LIGHT_RECOVERY_SMALL_SR 0.002 /* a disc 2.9 degrees wide */

/* A patch of ground as a camera sees it. */
struct light_ground {
	double radiance[3]; /* mean; white is 1 */
	double clipped;	    /* share of its pixels, 0..1: then there is more */
};

/* A rectangle of the upright picture, inside of it. decode: linear light of each code value; row:
 * room for width pixels. */
struct light_ground light_ground_see(const struct frame_reader *picture, int x, int y, int width,
				     int height, const float decode[256], uint32_t *row);

/* What a ground can see of the sky, and what of it is clipped. */
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
	bool at_bound;	  /* and more is missing, or may be: the patch is clipped itself */
	double factor[3]; /* 1 and more */
};

/* radiance[lights] is changed. */
struct light_recovery light_recover(const struct light_ground *ground,
				    const struct light_clipping *clipping, float (*radiance)[3]);

#endif
