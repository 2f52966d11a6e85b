/* Transfer curves against the printed standards, and as exact inverses. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "hal/transfer.h"

/* As printed in IEC 61966-2-1 and BT.709-6, knees rounded. */
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

static const double printed_step[] = {1e-7, 3e-4, 0}; /* of the rounded knees */

static void agrees_with_the_standards(void **state)
{
	(void)state;
	for (int t = 0; t < TRANSFER_COUNT; t++)
		for (int i = 0; i <= 100000; i++) {
			const double x = i / 1e5;

			assert_true(fabs(transfer_decode(t, x) - printed_decode(t, x)) <=
				    printed_step[t] + 1e-15);
			assert_true(fabs(transfer_encode(t, x) - printed_encode(t, x)) <=
				    printed_step[t] + 1e-15);
		}
}

static void check_inverse(enum transfer t, double x)
{
	assert_true(fabs(transfer_encode(t, transfer_decode(t, x)) - x) <= 1e-12);
	assert_true(fabs(transfer_decode(t, transfer_encode(t, x)) - x) <= 1e-12);
}

static void inverse_pair(void **state)
{
	const double knees[] = {0.0031308, 0.0031306684425006, 0.04045, 0.0404482362771082,
				0.018,	   0.0180539685108078, 0.081,	0.0812428582986351};

	(void)state;
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

static void clamped_and_monotonic(void **state)
{
	(void)state;
	for (int t = 0; t < TRANSFER_COUNT; t++) {
		double decoded = -1, encoded = -1;

		assert_true(transfer_decode(t, 0) == 0 && transfer_encode(t, 0) == 0);
		assert_true(transfer_decode(t, 1) == 1 && transfer_encode(t, 1) == 1);
		assert_true(transfer_decode(t, -3) == 0 && transfer_encode(t, -INFINITY) == 0);
		assert_true(transfer_decode(t, 7) == 1 && transfer_encode(t, INFINITY) == 1);
		assert_true(transfer_decode(t, NAN) == 0 && transfer_encode(t, NAN) == 0);
		for (int i = 0; i <= 1000000; i++) {
			assert_true(transfer_decode(t, i / 1e6) > decoded);
			assert_true(transfer_encode(t, i / 1e6) > encoded);
			decoded = transfer_decode(t, i / 1e6);
			encoded = transfer_encode(t, i / 1e6);
		}
	}
}

static void tables(void **state)
{
	static struct transfer_tables tables;

	(void)state;
	for (int t = 0; t < TRANSFER_COUNT; t++) {
		transfer_tables_fill(&tables, t);
		assert_int_equal(tables.decode[0], 0);
		assert_int_equal(tables.decode[255], 65535);
		for (int c = 0; c < 256; c++) {
			assert_int_equal(tables.encode[tables.decode[c]], c);
			assert_true(fabs(tables.decode[c] - 65535 * printed_decode(t, c / 255.0)) <=
				    0.5 + 65535 * printed_step[t]);
		}
		for (int v = 0; v < 65536; v++) {
			assert_true(fabs(tables.encode[v] - 255 * printed_encode(t, v / 65535.0)) <=
				    0.5 + 255 * printed_step[t] + 1e-9);
			assert_true(v == 0 || tables.encode[v] >= tables.encode[v - 1]);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(agrees_with_the_standards),
		cmocka_unit_test(inverse_pair),
		cmocka_unit_test(clamped_and_monotonic),
		cmocka_unit_test(tables),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
