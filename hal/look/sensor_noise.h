/* SPDX-License-Identifier: MIT */
/*
 * Measures a camera's noise from differences of successive frames, in small blocks spread over the
 * picture. In each block the mean difference, which a change of light makes, is taken away; a block
 * in which something moves is an outlier, and what counts is the median over blocks of one level.
 * From code values to linear light by the slope of the transfer function; rounding to code values
 * adds 1/12 and is taken away. Fitted is
 *
 *     sigma^2(L) = floor + slope L        L: linear light, white is 1
 *
 * and how far neighbouring pixels, and channels, have their noise in common.
 */
#ifndef INLAY_HAL_LOOK_SENSOR_NOISE_H
#define INLAY_HAL_LOOK_SENSOR_NOISE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/colour/transfer.h"
#include "hal/frame/view.h"

struct sensor_noise;

/* width, height: of the pictures, at least 8. -ENOMEM, -EINVAL. */
int sensor_noise_create(struct sensor_noise **noise, int width, int height,
			const struct transfer_curve *curve);
void sensor_noise_destroy(struct sensor_noise *noise); /* NULL is harmless */

/* Looks at the next frame. */
void sensor_noise_watch(struct sensor_noise *noise, const struct picture *picture);

struct sensor_noise_model {
	double floor[3], slope[3]; /* R, G, B; >= 0 */
	double across, down;	   /* correlation of neighbouring pixels, 0..1 */
	double channels;	   /* correlation of two channels, 0..1 */
};

/* Fits the model. False: too few frames were seen yet, and *model is unchanged. */
bool sensor_noise_fit(const struct sensor_noise *noise, struct sensor_noise_model *model);

#endif
