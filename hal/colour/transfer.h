/* SPDX-License-Identifier: MIT */
/*
 * Transfer functions: between 8-bit code values and linear light.
 *
 * Linear 1.0 is the radiance that code 255 stands for. Fixed-point linear light is Q16 with
 * 1.0 = 65535 ("U16 linear"); an unclipped intermediate may exceed it.
 *
 * A camera's curve is one of the standards' or a measured one; whatever decodes code values of a
 * camera does it by struct transfer_curve.
 */
#ifndef INLAY_HAL_COLOUR_TRANSFER_H
#define INLAY_HAL_COLOUR_TRANSFER_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"

enum transfer {
	TRANSFER_SRGB,	 /* IEC 61966-2-1 */
	TRANSFER_BT709,	 /* ITU-R BT.709-6, table 3: item 1.2 (camera side) and its inverse */
	TRANSFER_LINEAR, /* code / 255 */
	TRANSFER_COUNT
};

extern const char *const transfer_names[]; /* "srgb", "bt709", "linear", NULL */

/* The functions themselves, in double precision: encoded and linear both in 0..1; outside that
 * range the argument is clamped. The inverse pair agrees to 1e-12. */
double transfer_decode(enum transfer t, double encoded);
double transfer_encode(enum transfer t, double linear);

#define TRANSFER_KNOTS 33

/*
 * What code values of a camera stand for: code c is (c - black) / (255 - black) of the encoded
 * range, at least 0. Zeroed it is sRGB without a pedestal.
 */
struct transfer_curve {
	enum transfer named;
	double black;  /* code value that is no light, 0..254: a pedestal under the signal */
	bool measured; /* knot counts in place of named */
	/*
	 * Linear light at evenly spaced places of the encoded range: knot[0] = 0, each above the
	 * one before it, the last 1. Between them Steffen's monotone cubic (Astron. Astrophys. 239
	 * (1990) 443); at both ends its slope is at least a quarter of the first and the last
	 * step's, so that no code is worth nothing and the inverse is nowhere infinitely steep.
	 */
	double knot[TRANSFER_KNOTS];
};

/* code is a code value over 255. Outside 0..1 the argument is clamped; NaN counts as 0. Codes below
 * the black level are black: decoding and encoding again makes them the black level. */
double transfer_curve_decode(const struct transfer_curve *curve, double code);
double transfer_curve_encode(const struct transfer_curve *curve, double linear);

bool transfer_curve_same(const struct transfer_curve *a, const struct transfer_curve *b);

/* 0; -EINVAL: knots that do not ascend from 0 to 1, a name or a black level out of range. The fault
 * says what is wrong, and begins with nothing. */
int transfer_curve_check(const struct transfer_curve *curve, struct fault *fault);

/*
 * decode[c] = round(65535 * linear(c));
 * encode[v] = round(255 * encoded(v / 65535)), so encode[decode[c]] == c for every c from the black
 * level on; of a measured curve wherever a code is worth more than 1 / 65535.
 */
struct transfer_tables {
	uint16_t decode[256];
	uint8_t encode[65536];
};

void transfer_tables_fill(struct transfer_tables *tables, const struct transfer_curve *curve);

#endif
