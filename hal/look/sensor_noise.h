/* SPDX-License-Identifier: MIT */
/*
 * Measures a camera's noise from differences of successive frames, in small blocks spread over the
 * picture. The mean difference of a block is subtracted, as a change of light makes it. The median
 * of the blocks' variances is taken at each level of brightness, so that blocks in which something
 * moves do not matter. Rounding to code values adds 1/12, which is subtracted; the slope of the
 * transfer function converts code values to linear light L, of which white is 1. The model is
 *
 *     sigma^2(L) = floor + slope L
 *
 * with the correlations of neighbouring pixels and of channels.
 */
#ifndef INLAY_HAL_LOOK_SENSOR_NOISE_H
#define INLAY_HAL_LOOK_SENSOR_NOISE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/colour/transfer.h"
#include "hal/frame/view.h"

struct sensor_noise;

/* width and height are the pictures' size, at least 8. -ENOMEM, -EINVAL. */
int sensor_noise_create(struct sensor_noise **noise, int width, int height,
			const struct transfer_curve *curve);
void sensor_noise_destroy(struct sensor_noise *noise); /* NULL is harmless */

/* Adds the next frame to the measurement. */
void sensor_noise_watch(struct sensor_noise *noise, const struct picture *picture);

struct sensor_noise_model {
	double floor[3], slope[3]; /* R, G, B; >= 0 */
	double across, down;	   /* correlation of neighbouring pixels, 0..1 */
	double channels;	   /* correlation of two channels, 0..1 */
};

/* Fits the model. Returns false and leaves *model if there were too few frames yet. */
bool sensor_noise_fit(const struct sensor_noise *noise, struct sensor_noise_model *model);

#endif
