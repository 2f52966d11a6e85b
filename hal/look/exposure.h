/* SPDX-License-Identifier: MIT */
/*
 * Follows the background camera's exposure and white balance: three gains against those at the
 * start. A change that both cameras see is light; one that the background's camera sees alone is
 * exposure. In each channel
 *
 *     y = median over some 2,000 pixels of ln(B / B_start) - ln(E / E_start)
 *
 * E is the irradiance of the ground by the measured lights. Lamps near by light the picture not
 * quite as they light the fisheye, which depends on where the light comes from: f are moments of the
 * light over the sky, and a Kalman filter tells both apart,
 *
 *     y = ln gain + b . (f - f_start) + noise
 *
 * with b learned for good, so that the gain does not drift. A jump of y that b cannot explain is
 * the camera's, and followed within the frame. People may hide up to a third of the picture.
 */
#ifndef INLAY_HAL_LOOK_EXPOSURE_H
#define INLAY_HAL_LOOK_EXPOSURE_H

#include "hal/colour/transfer.h"
#include "hal/frame/view.h"
#include "hal/optics/dome.h"

struct exposure;

/* width, height: of the pictures; dome: borrowed, of the lights. -ENOMEM. */
int exposure_create(struct exposure **exposure, int width, int height,
		    const struct transfer_curve *curve, const struct dome *dome);
void exposure_destroy(struct exposure *exposure); /* NULL is harmless */

/* Looks at the next frame: the upright background, and the light of about its time. The first 25
 * frames are the start. */
void exposure_look(struct exposure *exposure, const struct picture *background,
		   const float (*radiance)[3]);

/* R, G, B: what the camera's light is multiplied by, 1 at the start. */
void exposure_gain(const struct exposure *exposure, double gain[3]);

/* R, G, B: what the median of B / B_start should be in the last frame, by its light and by the gain;
 * rounded, so that all machines agree. */
void exposure_expected(const struct exposure *exposure, float ratio[3]);

#endif
