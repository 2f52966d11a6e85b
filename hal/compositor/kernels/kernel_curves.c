/* SPDX-License-Identifier: MIT */
#include <math.h>

#include "hal/compositor/kernels/kernels_isa.h"

#define STEPS 2048 /* in a piece: the low 11 bits of the key */

/* Exact encoding of step `at` of a piece, in 1/256 of a level. */
static double piece_level(const struct transfer_curve *to, int piece, double at)
{
	const double octave = ldexp(KERNEL_BLACK, piece >> 2);
	const double v = octave * (1 + ((piece & 3) + at / STEPS) / 4);

	return 256 * 255 * transfer_curve_encode(to, (v - KERNEL_BLACK) / KERNEL_WHITE);
}

/* Keeps |b| + |c| / 2 in range; no curve of hal/colour/transfer.h comes near the limit. */
static int16_t coefficient_limited(double x, int limit)
{
	return (int16_t)lround(fmin(fmax(x, -limit), limit));
}

/* Fits one piece: the parabola through the curve at the three Chebyshev nodes, which nearly
 * minimises the largest error. A step stands for the middle of the values that have its key. */
static void piece_fit(struct kernel_curves *curves, const struct transfer_curve *to, int piece)
{
	double t[3], y[3], slope, bend;

	for (int i = 0; i < 3; i++) {
		const double at = STEPS / 2.0 * (1 + cos((2 * i + 1) * M_PI / 6));

		t[i] = (at - 0.5) * 16 / 65536;
		y[i] = piece_level(to, piece, at);
	}
	slope = (y[1] - y[0]) / (t[1] - t[0]);
	bend = ((y[2] - y[1]) / (t[2] - t[1]) - slope) / (t[2] - t[0]);
	slope -= bend * (t[0] + t[1]);
	curves->b[piece] = coefficient_limited(slope, 24575);
	curves->c[piece] = coefficient_limited(bend, 16383);
	/* Plus half a level for the rounding, and the mean loss of the two floors. */
	curves->a[piece] = (uint16_t)lround(y[1] - (slope + bend * t[1]) * t[1] + 128 + 0.5);
}

/* The cubic through codes 0, 85, 170 and 255, by Newton's differences. */
static void fit_light(struct kernel_curves *curves)
{
	const double third = 85, *y = (const double[]){curves->linear[0] / 65535.0,
						       curves->linear[85] / 65535.0,
						       curves->linear[170] / 65535.0,
						       curves->linear[255] / 65535.0};
	const double once = (y[1] - y[0]) / third;
	const double twice = (y[2] - 2 * y[1] + y[0]) / (2 * third * third);
	const double thrice = (y[3] - 3 * y[2] + 3 * y[1] - y[0]) / (6 * third * third * third);

	/* y0 + v (once + (v - third) (twice + (v - 2 third) thrice)) */
	curves->light[0] = (float)y[0];
	curves->light[1] = (float)(once - third * twice + 2 * third * third * thrice);
	curves->light[2] = (float)(twice - 3 * third * thrice);
	curves->light[3] = (float)thrice;
}

void kernel_curves_fill(struct kernel_curves *curves, const struct transfer_curve *background,
			const struct transfer_curve *output)
{
	for (int i = 0; i < 256; i++) {
		curves->decode[i] =
			(uint16_t)lround(65535 * transfer_curve_decode(background, i / 255.0));
		curves->linear[i] = curves->decode[i];
	}
	fit_light(curves);
	for (int piece = 0; piece < KERNEL_PIECES; piece++)
		piece_fit(curves, output, piece);
	for (int piece = 0; piece < KERNEL_PIECES; piece++) {
		const uint16_t word[3] = {curves->a[piece], (uint16_t)curves->b[piece],
					  (uint16_t)curves->c[piece]};

		for (int i = 0; i < 6; i++)
			curves->bytes[i][piece] = (uint8_t)(word[i / 2] >> (i % 2 * 8));
	}
	kernel_c_find_steady(curves);
}
