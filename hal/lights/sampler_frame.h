/* SPDX-License-Identifier: MIT */
/* Private to hal/lights: the sums over a frame's pixels, strip by strip on all threads. */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_FRAME_H
#define INLAY_HAL_LIGHTS_SAMPLER_FRAME_H

#include "hal/lights/sampler_parts.h"

/* Makes the scratch memory of so many threads, which stays: a second frame allocates nothing.
 * -ENOMEM. */
int sampler_scratch_grow(struct light_sampler *sampler, int threads);

/*
 * Reads a frame of the sampler's size and fills of_all, and above_all when something above a level
 * is wanted. pool may be NULL: the calling thread does all. -ENOMEM.
 */
int sampler_frame_sum(struct light_sampler *sampler, const struct frame_reader *reader,
		      struct pool *pool);

#endif
