/* SPDX-License-Identifier: MIT */
/* Transfer functions between code values and linear light. */
#ifndef INLAY_HAL_COLOUR_TRANSFER_H
#define INLAY_HAL_COLOUR_TRANSFER_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/base/fault.h"

/*
 * Transfer functions: from 8-bit code values to linear light and back.
 *
 * Linear 1.0 is the radiance of code 255. Fixed-point linear light is Q16 with 1.0 = 65535 ("U16
 * linear"); an unclipped intermediate value may exceed it.
 *
 * A camera's curve is that of a standard or a measured one. All code that decodes code values of a
 * camera uses struct transfer_curve.
 */

enum transfer {
	TRANSFER_SRGB,	 /* IEC 61966-2-1 */
	TRANSFER_BT709,	 /* ITU-R BT.709-6, table 3: item 1.2 (camera side) and its inverse */
	TRANSFER_LINEAR, /* code / 255 */
	TRANSFER_COUNT
};

extern const char *const transfer_names[]; /* "srgb", "bt709", "linear", NULL */

/* The standards' functions in double precision. encoded and linear are in 0..1; arguments outside
 * are clamped, NaN counts as 0. decode(encode(x)) = x to 1e-12. */
double transfer_decode(enum transfer t, double encoded);
double transfer_encode(enum transfer t, double linear);

#define TRANSFER_KNOTS 33

/*
 * The curve of a camera. Code c has the place
 *     e = max(0, (c - black) / (255 - black))
 * in the encoded range 0..1. Zeroed: sRGB, black level 0.
 */
struct transfer_curve {
	enum transfer named;
	double black;  /* code value of no light, 0..254 */
	bool measured; /* use knot instead of named */
	/*
	 * Linear light at evenly spaced places of the encoded range, strictly ascending: knot[0] =
	 * 0, the last 1. Between knots: Steffen's monotone cubic (Astron. Astrophys. 239 (1990)
	 * 443). At both ends the slope is at least a quarter of the slope of the first or last
	 * interval, so that the curve is nowhere flat and its inverse nowhere infinitely steep.
	 */
	double knot[TRANSFER_KNOTS];
};

/* code is a code value / 255. Arguments outside 0..1 are clamped, NaN counts as 0. Codes below the
 * black level decode to 0, and 0 encodes to the black level. */
double transfer_curve_decode(const struct transfer_curve *curve, double code);
double transfer_curve_encode(const struct transfer_curve *curve, double linear);

bool transfer_curve_same(const struct transfer_curve *a, const struct transfer_curve *b);

/* 0; -EINVAL: knots that do not ascend from 0 to 1, a name or a black level out of range. The
 * fault's text has no prefix; the caller adds the place. */
int transfer_curve_check(const struct transfer_curve *curve, struct fault *fault);

/*
 * The curve as tables:
 *     decode[c] = round(65535 * linear(c))
 *     encode[v] = round(255 * encoded(v / 65535))
 * encode[decode[c]] == c for every c from the black level on; for a measured curve, wherever
 * neighbouring codes differ by more than 1 / 65535.
 */
struct transfer_tables {
	uint16_t decode[256];
	uint8_t encode[65536];
};

void transfer_tables_fill(struct transfer_tables *tables, const struct transfer_curve *curve);

/*
 * Linear radiance in floats to 8-bit code values:
 *
 *     code = encode[floor(65535 * min(max(radiance, 0), 1) + 1/2)]
 *
 * with encode[] of struct transfer_tables (transfer.h).
 */

/* Encodes a row. rgb[3 * pixels]: R, G, B of each pixel, 1 is white; any float is allowed, NaN and
 * negative values become black. bgrx[4 * pixels]: B, G, R, 255; does not overlap rgb. */
void encode_row(const struct transfer_tables *tables, const float *rgb, int pixels, uint8_t *bgrx);

#endif
