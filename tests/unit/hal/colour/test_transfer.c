/* SPDX-License-Identifier: MIT */
/* Transfer curves against the printed standards, and as exact inverses. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "hal/colour/transfer.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* As printed in IEC 61966-2-1 and BT.709-6, with rounded constants at the knee. */
static double printed_decode(enum transfer t, double e)
{
	switch (t) {
	case TRANSFER_SRGB:
		return e <= 0.04045 ? e / 12.92 : pow((e + 0.055) / 1.055, 2.4);
	case TRANSFER_BT709:
		return e < 0.081 ? e / 4.5 : pow((e + 0.099) / 1.099, 1 / 0.45);
	default:
		return e;
	}
}

static double printed_encode(enum transfer t, double l)
{
	switch (t) {
	case TRANSFER_SRGB:
		return l <= 0.0031308 ? 12.92 * l : 1.055 * pow(l, 1 / 2.4) - 0.055;
	case TRANSFER_BT709:
		return l < 0.018 ? 4.5 * l : 1.099 * pow(l, 0.45) - 0.099;
	default:
		return l;
	}
}

static const double printed_step[] = {1e-7, 3e-4, 0}; /* jump at the rounded knee */

TEST("agrees with the standards")
{
	for (int t = 0; t < TRANSFER_COUNT; t++)
		for (int i = 0; i <= 100000; i++) {
			const double x = i / 1e5;

			expect_at_most(fabs(transfer_decode(t, x) - printed_decode(t, x)),
				       printed_step[t] + 1e-15, "t=%d, i=%d", t, i);
			expect_at_most(fabs(transfer_encode(t, x) - printed_encode(t, x)),
				       printed_step[t] + 1e-15, "t=%d, i=%d", t, i);
		}
}

static void check_inverse(enum transfer t, double x)
{
	assert_true(fabs(transfer_encode(t, transfer_decode(t, x)) - x) <= 1e-12);
	assert_true(fabs(transfer_decode(t, transfer_encode(t, x)) - x) <= 1e-12);
}

TEST("inverse pair")
{
	const double knees[] = {0.0031308, 0.0031306684425006, 0.04045, 0.0404482362771082,
				0.018,	   0.0180539685108078, 0.081,	0.0812428582986351};

	for (int t = 0; t < TRANSFER_COUNT; t++) {
		for (int i = 0; i <= 1000000; i++)
			check_inverse(t, i / 1e6);
		for (unsigned k = 0; k < sizeof(knees) / sizeof(*knees); k++)
			for (int i = -5000; i <= 5000; i++) {
				check_inverse(t, knees[k] * (1 + i * 1e-15));
				check_inverse(t, knees[k] * (1 + i * 1e-8));
			}
	}
}

TEST("clamped and monotonic")
{
	for (int t = 0; t < TRANSFER_COUNT; t++) {
		double decoded = -1, encoded = -1;

		expect_that(transfer_decode(t, 0) == 0 && transfer_encode(t, 0) == 0, "t=%d", t);
		expect_that(transfer_decode(t, 1) == 1 && transfer_encode(t, 1) == 1, "t=%d", t);
		expect_that(transfer_decode(t, -3) == 0 && transfer_encode(t, -INFINITY) == 0,
			    "t=%d", t);
		expect_that(transfer_decode(t, 7) == 1 && transfer_encode(t, INFINITY) == 1, "t=%d",
			    t);
		expect_that(transfer_decode(t, NAN) == 0 && transfer_encode(t, NAN) == 0, "t=%d",
			    t);
		for (int i = 0; i <= 1000000; i++) {
			expect_above(transfer_decode(t, i / 1e6), decoded, "t=%d, i=%d", t, i);
			expect_above(transfer_encode(t, i / 1e6), encoded, "t=%d, i=%d", t, i);
			decoded = transfer_decode(t, i / 1e6);
			encoded = transfer_encode(t, i / 1e6);
		}
	}
}

TEST("tables")
{
	static struct transfer_tables tables;

	for (int t = 0; t < TRANSFER_COUNT; t++) {
		const struct transfer_curve curve = {.named = (enum transfer)t};

		transfer_tables_fill(&tables, &curve);
		expect_equal(tables.decode[0], 0, "t=%d", t);
		expect_equal(tables.decode[255], 65535, "t=%d", t);
		for (int c = 0; c < 256; c++) {
			expect_equal(tables.encode[tables.decode[c]], c, "t=%d, c=%d", t, c);
			expect_at_most(
				fabs(tables.decode[c] - 65535 * printed_decode(t, c / 255.0)),
				0.5 + 65535 * printed_step[t], "t=%d, c=%d", t, c);
		}
		for (int v = 0; v < 65536; v++) {
			expect_at_most(
				fabs(tables.encode[v] - 255 * printed_encode(t, v / 65535.0)),
				0.5 + 255 * printed_step[t] + 1e-9, "t=%d, v=%d", t, v);
			expect_that(v == 0 || tables.encode[v] >= tables.encode[v - 1],
				    "t=%d, v=%d", t, v);
		}
	}
}

/* ---- measured curves ---- */

static double power(double x)
{
	return pow(x, 2.2);
}

static double srgb(double x)
{
	return transfer_decode(TRANSFER_SRGB, x);
}

static double linear(double x)
{
	return x;
}

static struct transfer_curve measured_of(double (*decode)(double), double black)
{
	struct transfer_curve curve = {.measured = true, .black = black};

	for (int k = 0; k < TRANSFER_KNOTS; k++)
		curve.knot[k] = decode((double)k / (TRANSFER_KNOTS - 1));
	return curve;
}

/* Between its knots a smooth curve is right to a thousandth, and decoding inverts encoding. */
TEST("measured curves keep their shape")
{
	double (*const shapes[])(double) = {power, srgb, linear};

	for (int k = 0; k < 3; k++) {
		const struct transfer_curve curve = measured_of(shapes[k], 0);
		double before = -1;

		assert_int_equal(transfer_curve_check(&curve, NULL), 0);
		for (int i = 0; i <= 20000; i++) {
			const double x = i / 20000.0, y = transfer_curve_decode(&curve, x);

			expect_above(y, before, "k=%d, i=%d", k, i);
			expect_that(x < 0.1 || fabs(y / shapes[k](x) - 1) < 1.5e-3, "k=%d, i=%d", k,
				    i);
			expect_below(fabs(transfer_curve_encode(&curve, y) - x), 1e-9, "k=%d, i=%d",
				     k, i);
			before = y;
		}
		expect_equal(transfer_curve_decode(&curve, 1), 1, "k=%d", k);
		expect_equal(transfer_curve_encode(&curve, 1), 1, "k=%d", k);
		expect_equal(transfer_curve_decode(&curve, NAN), 0, "k=%d", k);
		expect_equal(transfer_curve_encode(&curve, -1), 0, "k=%d", k);
	}
}

/* Any ascending knots, with steps of every size. */
TEST("measured curves ascend")
{
	struct chance chance = chance_begin("transfer");

	for (int run = 0; run < 300; run++) {
		struct transfer_curve curve = {.measured = true};
		double before = -1;

		for (int k = 1; k < TRANSFER_KNOTS; k++)
			curve.knot[k] = curve.knot[k - 1] + pow(10, chance_real(&chance, -6, 0));
		for (int k = 1; k < TRANSFER_KNOTS; k++)
			curve.knot[k] /= curve.knot[TRANSFER_KNOTS - 1];
		curve.knot[TRANSFER_KNOTS - 1] = 1;
		for (int i = 0; i <= 3200; i++) {
			const double y = transfer_curve_decode(&curve, i / 3200.0);

			expect_that(y > before || (y == before && y > 1 - 1e-9), "run=%d, i=%d",
				    run, i);
			expect_below(fabs(transfer_curve_decode(&curve,
								transfer_curve_encode(&curve, y)) -
					  y),
				     1e-9, "run=%d, i=%d", run, i);
			before = y;
		}
	}
}

TEST("tables go round")
{
	const struct transfer_curve curves[] = {
		{.named = TRANSFER_BT709, .black = 16},
		measured_of(srgb, 0),
		measured_of(srgb, 16.5),
		measured_of(power, 12),
	};
	static struct transfer_tables t;

	for (size_t k = 0; k < sizeof(curves) / sizeof(*curves); k++) {
		const int black = (int)ceil(curves[k].black);
		int off = 0;

		transfer_tables_fill(&t, &curves[k]);
		expect_equal(t.decode[0], 0, "k=%zu", k);
		expect_equal(t.decode[255], 65535, "k=%zu", k);
		for (int c = black; c < 256; c++) {
			const bool worth = c == black || t.decode[c] > t.decode[c - 1] + 1;

			expect_that(!worth || t.encode[t.decode[c]] == c, "k=%zu, c=%d", k, c);
			off += t.encode[t.decode[c]] != c;
		}
		print_message("# curve %zu: %d codes do not come back\n", k, off);
		expect_at_most(off, (k == 3 ? 6 : 0), "k=%zu", k);
	}
}

TEST("wrong curves are told")
{
	struct transfer_curve curve = measured_of(srgb, 0);
	struct fault fault;

	curve.knot[7] = curve.knot[6];
	assert_int_equal(transfer_curve_check(&curve, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "from number 7"));
	curve = measured_of(srgb, 0);
	curve.knot[TRANSFER_KNOTS - 1] = 1.5;
	assert_int_equal(transfer_curve_check(&curve, &fault), -EINVAL);
	curve.knot[TRANSFER_KNOTS - 1] = NAN;
	assert_int_equal(transfer_curve_check(&curve, &fault), -EINVAL);
	curve = measured_of(srgb, 255);
	assert_int_equal(transfer_curve_check(&curve, &fault), -EINVAL);
	curve = (struct transfer_curve){.named = TRANSFER_COUNT};
	assert_int_equal(transfer_curve_check(&curve, &fault), -EINVAL);
}
