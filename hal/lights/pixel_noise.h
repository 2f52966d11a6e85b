/* SPDX-License-Identifier: MIT */
/* Noise of one pixel's code value, and of the linear light that it stands for. */
#ifndef INLAY_HAL_LIGHTS_PIXEL_NOISE_H
#define INLAY_HAL_LIGHTS_PIXEL_NOISE_H

#include "hal/colour/transfer.h"

/* Standard deviation of a pixel in 8-bit code values: read noise, photon noise, quantisation. It is
 * about the same at all codes, because a camera's curve is close to a square root, which makes
 * photon noise even. */
#define PIXEL_NOISE_CODES 1.5

/* So many neighbouring pixels count as one independent pixel, because of colour filters and
 * compression. */
#define PIXEL_NOISE_ALIKE 4

/* Variance of a pixel's linear light x: floor + slope x. */
struct pixel_noise {
	double floor, slope;
};

/* The variance at code c is (PIXEL_NOISE_CODES * slope of the curve at c)^2. Returns a line over
 * linear light that is at no code below it. */
struct pixel_noise pixel_noise_of(const struct transfer_curve *curve);

#endif
