/* SPDX-License-Identifier: MIT */
/*
 * Follows the background camera's exposure and white balance: three gains against those at the
 * start. A change that both cameras see is light; one that the background's camera sees alone is
 * exposure. In each channel
 *
 *     y = median over some 2,000 pixels of ln(B / B_start) - ln(E / E_start)
 *
 * B is the linear light of a pixel, E the irradiance of the ground by the measured lights, and
 * _start marks means over the first frames. A lamp near by lights the picture not quite as it
 * lights the fisheye; by how much depends on where its light comes from. So a Kalman filter
 * separates the gain from the light's direction, which f describes by its moments over the sky:
 *
 *     y = ln gain + b . (f - f_start) + noise
 *
 * The filter hardly forgets b, so that the gain does not drift. Where y jumps further than b
 * explains, the camera has changed, and the gain follows within the frame. People may hide up to a
 * third of the picture.
 */
#ifndef INLAY_HAL_LOOK_EXPOSURE_H
#define INLAY_HAL_LOOK_EXPOSURE_H

#include "hal/colour/transfer.h"
#include "hal/frame/view.h"
#include "hal/optics/dome.h"

struct exposure;

/* width and height are the pictures' size; dome is borrowed and describes the lights. -ENOMEM. */
int exposure_create(struct exposure **exposure, int width, int height,
		    const struct transfer_curve *curve, const struct dome *dome);
void exposure_destroy(struct exposure *exposure); /* NULL is harmless */

/* Looks at the next frame, the upright background, with the light measured at about the same time.
 * The first 25 frames define B_start, E_start and f_start. */
void exposure_look(struct exposure *exposure, const struct picture *background,
		   const float (*radiance)[3]);

/* Returns the factors R, G, B by which the camera now multiplies light; they are 1 at the start. */
void exposure_gain(const struct exposure *exposure, double gain[3]);

/* Returns, for R, G, B, the median of B / B_start that the last frame's light and gain predict. It
 * is rounded to 20 binary digits, so that all machines agree. */
void exposure_expected(const struct exposure *exposure, float ratio[3]);

#endif
