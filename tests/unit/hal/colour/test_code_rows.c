/* SPDX-License-Identifier: MIT */
/* Rows of code values: linear light to codes, and two pictures mixed in linear light, by brute
 * force. */
#include <math.h>

#include "hal/colour/crossfade.h"
#include "hal/colour/transfer.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

TEST("linear light becomes codes")
{
	static struct transfer_tables tables;
	const struct transfer_curve curve = {.named = TRANSFER_SRGB};
	const float odd[] = {-1, NAN, -0.0F, 2, INFINITY, 1e-9F};
	const int codes[] = {0, 0, 0, 255, 255, 0};

	transfer_tables_fill(&tables, &curve);
	for (int i = 0; i <= 4000; i++) {
		const float linear = (float)i / 4000;
		const float rgb[3] = {linear, 1 - linear, 0};
		uint8_t bgrx[4] = {1, 2, 3, 4};
		const double red = 255 * transfer_encode(TRANSFER_SRGB, (double)rgb[0]);
		const double green = 255 * transfer_encode(TRANSFER_SRGB, (double)rgb[1]);

		encode_row(&tables, rgb, 1, bgrx);
		expect_at_most(fabs(bgrx[2] - red), 0.53, "linear %g", (double)linear);
		expect_at_most(fabs(bgrx[1] - green), 0.53, "linear %g", 1 - (double)linear);
		expect_equal(bgrx[0], 0, "linear %g", (double)linear);
		expect_equal(bgrx[3], 255, "linear %g", (double)linear);
	}
	for (size_t k = 0; k < sizeof(odd) / sizeof(*odd); k++) {
		const float rgb[3] = {odd[k], odd[k], odd[k]};
		uint8_t bgrx[4];

		encode_row(&tables, rgb, 1, bgrx);
		expect_equal(bgrx[0], codes[k], "value %zu", k);
	}
}

/* The nearest code by trying all, the larger of two that are equally near. */
static int nearest_code(const struct transfer_curve *curve, double wanted)
{
	double least = INFINITY;
	int best = 0;

	for (int code = 0; code < 256; code++) {
		const double off = fabs(transfer_curve_decode(curve, code / 255.0) - wanted);

		if (off <= least) {
			least = off;
			best = code;
		}
	}
	return best;
}

TEST("pictures are mixed in linear light")
{
	static const double shares[] = {0, 0.25, 0.5, 0.9, 1};
	static const enum transfer curves[] = {TRANSFER_SRGB, TRANSFER_BT709, TRANSFER_LINEAR};
	static struct crossfade fade;

	crossfade_init(&fade);
	for (size_t n = 0; n < sizeof(curves) / sizeof(*curves); n++)
		for (size_t k = 0; k < sizeof(shares) / sizeof(*shares); k++) {
			const struct transfer_curve curve = {.named = curves[n]};

			crossfade_set(&fade, &curve, shares[k]);
			for (int i = 0; i < 65536; i += 37) {
				const uint8_t a = (uint8_t)(i >> 8), b = (uint8_t)i;
				const double wanted =
					(1 - shares[k]) * transfer_curve_decode(&curve, a / 255.0) +
					shares[k] * transfer_curve_decode(&curve, b / 255.0);
				uint8_t mixed;

				crossfade_row(&fade, &a, &b, 1, &mixed);
				expect_equal(mixed, a == b ? a : nearest_code(&curve, wanted),
					     "curve %zu, share %g, codes %d and %d", n, shares[k],
					     a, b);
			}
		}
}
