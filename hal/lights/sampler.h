/*
 * The light sampler: N linear colours from the fisheye's picture, every frame.
 *
 * Two estimators of L_i:
 *   node   the picture at the node's direction, bilinear in linear light (thesis 2.2.2);
 *   cell   the mean over the cell, weighted by solid angle: conserves energy, cannot miss a lamp.
 * All geometry (lens, orientation, flips, squash, the cell of each pixel) is in a table made once;
 * a frame costs one pass over the pixels inside the image circle. Pixels that straddle cells are
 * shared between them by sub-pixel area. A cell that no pixel reaches (fine domes, small pictures)
 * falls back to its node. A cell outside the lens's field is dark, and counted.
 *
 * A pixel whose centre lies outside the field or below the horizon shows less sky than what is
 * around it, and is left out by both: a sky of one colour gives that colour to every light, those
 * on the horizon included, exactly.
 */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_H
#define INLAY_HAL_LIGHTS_SAMPLER_H

#include "hal/fault.h"
#include "hal/frame.h"
#include "hal/frame_reader.h"
#include "hal/image/image.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"
#include "hal/pool.h"
#include "hal/view.h"

enum light_estimator { ESTIMATOR_CELL, ESTIMATOR_NODE, ESTIMATOR_COUNT };

extern const char *const light_estimator_names[]; /* "cell", "node", NULL */

struct light_sampler_settings {
	enum light_estimator estimator;
	enum transfer transfer; /* of the camera's 8-bit code values */
	int black_level; /* code value that is no light, 0..254: the thesis's DARKRGB. A pedestal
			    under the encoded signal: code c stands for (c - black) / (255 - black)
			  */
	double gain; /* linear light is multiplied by it: fisheye units to background units; >= 0 */
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
 * pixels and their shares.
 */
int light_sampler_read_frame(struct light_sampler *sampler, const struct frame_reader *frame,
			     struct pool *pool, float (*radiance)[3], double *clipped);

/* The same from a picture in memory, by the calling thread. */
int light_sampler_read(struct light_sampler *sampler, const struct picture *picture,
		       float (*radiance)[3], double *clipped);

/* The same from a float picture of linear radiance (black level and transfer do not apply; gain
 * does). */
int light_sampler_read_linear(struct light_sampler *sampler, const struct image *picture,
			      float (*radiance)[3]);

/* How many lights' cells the lens does not see: they are dark. */
int light_sampler_unseen(const struct light_sampler *sampler);

void light_sampler_destroy(struct light_sampler *sampler);

#endif
