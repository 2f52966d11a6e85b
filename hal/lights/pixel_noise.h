/* SPDX-License-Identifier: MIT */
/* What one pixel's code value may be wrong by, and so its light. */
#ifndef INLAY_HAL_LIGHTS_PIXEL_NOISE_H
#define INLAY_HAL_LIGHTS_PIXEL_NOISE_H

#include "hal/colour/transfer.h"

/* Standard deviation of a pixel, 8-bit code values: read noise, photons, quantisation. About the
 * same at all codes, as a camera's curve is near the root that evens out photons. */
#define PIXEL_NOISE_CODES 1.5

/* How many pixels of a camera count as one by themselves: colour filters, compression. */
#define PIXEL_NOISE_ALIKE 4

/* Variance of a pixel's linear light x: floor + slope x. */
struct pixel_noise {
	double floor, slope;
};

/* PIXEL_NOISE_CODES times the curve's slope, squared, as a line over linear light that lies below
 * it at no code. */
struct pixel_noise pixel_noise_of(const struct transfer_curve *curve);

#endif
