/* SPDX-License-Identifier: MIT */
/* Noise of one pixel's code value, and of the linear light that it stands for; how far a pixel near
 * white is believed. */
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

/* Share of the range of codes, from black to 255, from which a pixel is believed less, and from
 * which it says nothing (code 247): cameras compress before 255, and clip the noise of single
 * pixels. */
#define PIXEL_NEAR 0.85
#define PIXEL_WHITE 0.97

/* Returns how far a code value is believed, 1..0; smooth. */
double pixel_believed(const struct transfer_curve *curve, double code);

/*
 * Soft white: linear light x of a code, and the part of it that is believed,
 *     soft(x) = integral of pixel_believed over linear light, from 0 to x
 * which is x up to PIXEL_NEAR and constant from PIXEL_WHITE on.
 */
struct pixel_white {
	double light[256], soft[256];
	int code; /* lowest code of which a part is not believed */
};

void pixel_white_fill(struct pixel_white *white, const struct transfer_curve *curve);

/* Returns soft(light), linear between codes; that of code 255 beyond. */
double pixel_white_soft(const struct pixel_white *white, double light);

#endif
