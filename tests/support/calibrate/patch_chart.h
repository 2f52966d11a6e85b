/* SPDX-License-Identifier: MIT */
/*
 * Cameras of known response, and pictures of a chart of even patches that they take, for the tests
 * of the calibration of light. A code value is made from linear light in this order: noise,
 * response curve, pedestal, rounding.
 */
#ifndef INLAY_TESTS_SUPPORT_CALIBRATE_PATCH_CHART_H
#define INLAY_TESTS_SUPPORT_CALIBRATE_PATCH_CHART_H

#include <stdint.h>

#include "hal/image/image.h"
#include "tests/support/chance.h"

/* CHART_FILM has a toe and a shoulder on top of sRGB. */
enum chart_curve { CHART_SRGB, CHART_BT709, CHART_POWER, CHART_FILM, CHART_LINEAR, CHART_COUNT };

extern const char *const chart_curve_names[CHART_COUNT];

struct chart_camera {
	enum chart_curve curve;
	double black;	   /* pedestal, an 8-bit code value */
	double read_noise; /* standard deviation in linear light; white is 1 */
	double shot_noise; /* the same at white; proportional to the square root of the light */
};

/* Linear light of an encoded value; both 0..1. */
double chart_curve_decode(enum chart_curve curve, double u);

/* About normal, with standard deviation 1 and never beyond 6: the sum of twelve uniform numbers. */
double chart_noise(struct chance *chance);

/* Code value of a pixel that gets this linear light. */
uint8_t chart_code(const struct chart_camera *camera, double linear, struct chance *chance);

/*
 * Fills a picture of 8 bits and three channels: patches of 16 x 16 px whose light falls
 * geometrically from 1 to `range`, times the exposure time `time`. Each channel has another order
 * of patches.
 */
void chart_photograph(const struct chart_camera *camera, double time, double range,
		      struct chance *chance, struct image *picture);

#endif
