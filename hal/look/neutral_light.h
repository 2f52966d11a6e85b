/* SPDX-License-Identifier: MIT */
/* Mixes grey into the light, so that colours that must be recognised (a brand's) stay
 * themselves. */
#ifndef INLAY_HAL_LOOK_NEUTRAL_LIGHT_H
#define INLAY_HAL_LOOK_NEUTRAL_LIGHT_H

/*
 * Mixes each light with grey of its luminance (ITU-R BT.709):
 *
 *     L' = (1 - share) L + share Y (1, 1, 1)    Y = 0.2126 R + 0.7152 G + 0.0722 B
 *
 * radiance[count] holds R, G, B in linear light; share is 0..1. The luminance does not change.
 */
void neutral_light(double (*radiance)[3], int count, double share);

#endif
