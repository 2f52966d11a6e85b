/* SPDX-License-Identifier: MIT */
/* A share of neutral light, for objects whose colours must be recognised: of a brand, say. */
#ifndef INLAY_HAL_LOOK_NEUTRAL_LIGHT_H
#define INLAY_HAL_LOOK_NEUTRAL_LIGHT_H

/*
 * Mixes each light with grey of its luminance (ITU-R BT.709):
 *
 *     L' = (1 - share) L + share Y (1, 1, 1)    Y = 0.2126 R + 0.7152 G + 0.0722 B
 *
 * radiance[count]: R, G, B in linear light; share: 0..1. The luminance stays.
 */
void neutral_light(double (*radiance)[3], int count, double share);

#endif
