/* SPDX-License-Identifier: MIT */
/*
 * The light sampler: N linear colours from the fisheye's picture, every frame.
 *
 * L_i, the radiance of light i, is the mean over its cell by solid angle. It conserves energy, and
 * misses no lamp, which the picture at the node's direction (thesis 2.2.2) does.
 * A table made once holds all geometry (lens, orientation, flips, squash, the cell of each pixel).
 * A frame costs one pass over the pixels inside the image circle. Pixels that straddle cells are
 * shared between the cells by sub-pixel area.
 * A light that no pixel reaches (fine domes, small pictures) gets the value of its node. A cell
 * outside the lens's field is dark, and counted.
 *
 * Pixels whose centre lies outside the field or below the horizon are left out, because such a
 * pixel shows less sky than its neighbours. So a sky of one colour gives exactly
 * that colour to every light, also at the horizon.
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

struct light_sampler_settings {
	/* Light in a cell is shared with its neighbours so that it keeps its place (dome_placed.h):
	 * each light is measured in parts. */
	bool placed;
	struct transfer_curve curve; /* of the camera's 8-bit code values; its black level is the
					thesis's DARKRGB */
	double gain; /* factor of linear light, fisheye units to background units; >= 0 */
	/* 3 x 3 matrix, row by row, from this camera's linear R, G, B to the background camera's;
	 * all 0: the identity. Applied to the colour of each light, after gain. Negative results,
	 * colours that the background camera cannot see, become 0. */
	double colours[9];
};

struct light_sampler;

/* Creates a sampler of upright pictures of this size; the dome is not needed afterwards. 0;
 * -EINVAL: a setting or size out of range; -ENOMEM. */
int light_sampler_create(struct light_sampler **sampler, const struct dome *dome,
			 const struct fisheye *lens, int width, int height,
			 const struct light_sampler_settings *settings, struct fault *fault);

/*
 * Writes the colour R, G, B of light i to radiance[i], and to *clipped the share of the sky's solid
 * angle, 0..1, that is clipped (any channel at 255); either may be NULL. Reads the frame in the
 * camera's format, each pixel inside the image circle once, from top to bottom. The pool's threads
 * share strips of the frame; NULL: the calling thread reads all. Allocates only once per thread. 0;
 * -EINVAL: another size; -ENOMEM.
 *
 * The arithmetic is integer except for the last scaling: results are the same on every machine,
 * with any number of threads. Against double precision over the same pixels and shares, the error
 * of a colour L is at most
 *     2^-14 L + 2^-16 gain
 * and with a matrix, for channel c and the colour L before the matrix,
 *     sum_k |colours[c][k]| (2^-14 L_k + 2^-16 gain)
 */
int light_sampler_read_frame(struct light_sampler *sampler, const struct frame_reader *frame,
			     struct pool *pool, float (*radiance)[3], double *clipped);

/* Reads a picture in memory, on the calling thread; otherwise as light_sampler_read_frame(). */
int light_sampler_read(struct light_sampler *sampler, const struct picture *picture,
		       float (*radiance)[3], double *clipped);

/* Reads a float picture of linear radiance: the curve does not apply, gain and colours do.
 * radiance may be NULL. 0; -EINVAL: another size, or no float picture. */
int light_sampler_read_linear(struct light_sampler *sampler, const struct image *picture,
			      float (*radiance)[3]);

/*
 * What other exposures a frame of one exposure is merged with (exposures.h), from the next frame
 * on. With soft() of pixel_noise.h:
 *     shorter   there is one that is shorter: a pixel x counts as soft(x), and as clipped where
 *               that is less than x
 *     longer    light that this exposure gathers as a share of the next longer one's, which is
 *               believed up to soft(x / longer) only; the mean of
 *                   x - longer soft(x / longer)
 *               over each light is measured as well. 1: there is none.
 * A new sampler has neither.
 */
void light_sampler_exposure(struct light_sampler *sampler, double longer, bool shorter);

/* Number of values that each light is measured in: DOME_PLACED_THIRDS where light is placed, else
 * 1. The arrays of the last frame below have [lights * parts] values, are valid until the next one,
 * and can be merged before they become lights. */
int light_sampler_parts(const struct light_sampler *sampler);

/* The colours. */
const float (*light_sampler_measured(const struct light_sampler *sampler))[3];

/* Makes lights[lights] of such colours, and of such shares. */
void light_sampler_place(struct light_sampler *sampler, const float (*measured)[3],
			 float (*lights)[3]);
void light_sampler_place_shares(struct light_sampler *sampler, const float *share, float *lights);

/* The light that the longer exposure does not believe. */
const float (*light_sampler_excess(const struct light_sampler *sampler))[3];

/* The clipped shares, 0..1; exactly 0 in a light none of whose pixels was clipped. */
const float *light_sampler_clipped(const struct light_sampler *sampler);

void light_sampler_destroy(struct light_sampler *sampler);

#endif
