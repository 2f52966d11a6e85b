/* SPDX-License-Identifier: MIT */
/*
 * The light sampler: N linear colours from the fisheye's picture, every frame.
 *
 * Two estimators of L_i:
 *   node   the picture at the node's direction, bilinear in linear light (thesis 2.2.2);
 *   cell   the mean over the light, weighted by solid angle and, of tents, the light's weight:
 *          conserves energy, as the weights of a direction sum to 1, and cannot miss a lamp.
 * All geometry (lens, orientation, flips, squash, the cell of each pixel) is in a table made once;
 * a frame costs one pass over the pixels inside the image circle. Pixels that straddle cells are
 * shared between them by sub-pixel area, and all of them among three tents. A light that no pixel
 * reaches (fine domes, small pictures) falls back to its node. A cell outside the lens's field is
 * dark, and counted.
 *
 * A pixel whose centre lies outside the field or below the horizon shows less sky than what is
 * around it, and is left out by both: a sky of one colour gives that colour to every light, those
 * on the horizon included, exactly.
 */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_H
#define INLAY_HAL_LIGHTS_SAMPLER_H

#include "hal/base/fault.h"
#include "hal/base/pool.h"
#include "hal/frame/frame.h"
#include "hal/frame/frame_reader.h"
#include "hal/frame/view.h"
#include "hal/image/image.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"

enum light_estimator { ESTIMATOR_CELL, ESTIMATOR_NODE, ESTIMATOR_COUNT };

extern const char *const light_estimator_names[]; /* "cell", "node", NULL */

struct light_sampler_settings {
	enum light_estimator estimator;
	struct transfer_curve curve; /* of the camera's 8-bit code values; its black level is the
					thesis's DARKRGB */
	double gain; /* linear light is multiplied by it: fisheye units to background units; >= 0 */
	/* Then this camera's linear R, G, B become the background's, row by row: all 0 stands for
	 * the identity. Of each light's colour, not of each pixel. What comes out negative, a
	 * colour that the background camera cannot see, is 0. */
	double colours[9];
};

struct light_sampler;

/* For upright pictures of this size; the dome is not needed afterwards. -EINVAL: a setting or size
 * out of range; -ENOMEM. */
int light_sampler_create(struct light_sampler **sampler, const struct dome *dome,
			 const struct fisheye *lens, int width, int height,
			 const struct light_sampler_settings *settings, struct fault *fault);

/*
 * radiance[i] gets the colour of light i: R, G, B. The frame is read as it is, its pixels inside
 * the image circle once each, from top to bottom. Strips of it are shared among the pool's threads;
 * NULL: the calling thread does all. Nothing is allocated but once for each thread. -EINVAL:
 * another size; -ENOMEM.
 *
 * Returns the share of the sky's solid angle (0..1) that is clipped (any channel at 255) through
 * clipped, which may be NULL. Integer arithmetic but for the last scaling: the same on every
 * machine, with any number of threads.
 *
 * A colour is within 2^-14 of itself and gain * 2^-16 of what double precision makes of the same
 * pixels and their shares; with colours, each channel by as much of what its row adds up, whatever
 * the signs.
 */
int light_sampler_read_frame(struct light_sampler *sampler, const struct frame_reader *frame,
			     struct pool *pool, float (*radiance)[3], double *clipped);

/* The same from a picture in memory, by the calling thread. */
int light_sampler_read(struct light_sampler *sampler, const struct picture *picture,
		       float (*radiance)[3], double *clipped);

/* The same from a float picture of linear radiance (the curve does not apply; gain and
 * colours do). */
int light_sampler_read_linear(struct light_sampler *sampler, const struct image *picture,
			      float (*radiance)[3]);

/*
 * From the next frame on, what is brighter than `level` of white (0..1) is measured too, by itself:
 * the mean of max(x - level, 0) over each light, for exposures.h. 1, as it is at first: it is not.
 */
void light_sampler_above(struct light_sampler *sampler, double level);

/* That of the frame read last, radiance[lights]; 0 where nothing is so bright. Valid until the
 * next. */
const float (*light_sampler_excess(const struct light_sampler *sampler))[3];

/* [lights]: the share of each light that was clipped in the frame read last, 0..1; 0 exactly where
 * none of its pixels was. Valid until the next. */
const float *light_sampler_clipped(const struct light_sampler *sampler);

/* How many lights' cells the lens does not see: they are dark. */
int light_sampler_unseen(const struct light_sampler *sampler);

void light_sampler_destroy(struct light_sampler *sampler);

#endif
