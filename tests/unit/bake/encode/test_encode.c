/* SPDX-License-Identifier: MIT */
/* The encoder keeps and declares its errors: checked on blocks decoded in double precision. */
#include <math.h>

#include "tests/support/bake/encode_promises.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

TEST("over scenes")
{
	struct chance chance = chance_begin("scenes");

	for (int k = 0; k < 8; k++) {
		struct encode_rig e = encode_rig_dome(k & 1 ? 8 : 5, k & 2 ? 4 : 9);
		const enum basis_kind kind = k & 4 ? BASIS_KIND_T : BASIS_KIND_V;
		struct encode_rig_part *part;

		if (!(k & 2))
			e.settings.coarse = e.settings.lights;
		part = encode_rig_part_new(&e, kind, k & 1 ? 256 : 57, kind == BASIS_KIND_T ? 3 : 1,
					   k != 4);
		encode_rig_start(&e);
		encode_rig_fill(&e, part);
		if (kind == BASIS_KIND_T)
			for (int p = 0; p < part->samples.pixels; p++)
				e.coverage[part->pixel[p]] = 65535;
		encode_promises_hold(&e, part, &chance);
		encode_rig_part_free(part);
		encode_rig_end(&e);
	}
}

/* The error that is asked for is kept; a smaller one costs more bytes. */
TEST("over targets")
{
	uint64_t before = UINT64_MAX;

	for (double cell = 0.25; cell < 20; cell *= 3) {
		struct encode_rig e = encode_rig_dome(6, 6);
		struct encode_rig_part *part = encode_rig_part_new(&e, BASIS_KIND_V, 256, 1, true);
		struct encode_result result;
		uint64_t bytes = 0;

		/* The strongest suns of the ensemble are nearly one cell alone. */
		e.settings.target.cell = cell;
		e.settings.target.max = fmax(e.settings.target.max, cell);
		e.settings.target.rms = fmax(e.settings.target.rms, cell / 4);
		encode_rig_start(&e);
		encode_rig_fill(&e, part);
		result = encode_promises_hold(&e, part, NULL);
		for (int k = 0; k < result.shown_count; k++)
			bytes += result.shown[k].entry.bytes;
		expect_at_most(bytes, before, "cell=%g", cell);
		before = bytes;
		encode_rig_part_free(part);
		encode_rig_end(&e);
	}
	assert_true(before < 256 * 3 * 186 / 5); /* less than one byte a value */
}

/* An error in T and V at once, in a half-covered pixel, is measured as it is seen. */
TEST("together")
{
	struct encode_rig e = encode_rig_dome(5, 5);
	struct encode_rig_part *part[2];
	struct encode_result both;

	encode_rig_start(&e);
	part[0] = encode_rig_part_new(&e, BASIS_KIND_T, 64, 3, true);
	part[1] = encode_rig_part_new(&e, BASIS_KIND_V, 64, 1, true);
	for (int k = 0; k < 2; k++)
		encode_rig_fill(&e, part[k]);
	for (int p = 0; p < ENCODE_RIG_PIXELS_MAX; p++)
		e.coverage[p] = 32768;
	both = encode_rig_run(&e, part, 2, false);
	encode_promises_format(&e, &both);
	assert_true(both.error.sky_count == 3 * 64);
	assert_true(both.error.cell_count == 3 * 64 * e.settings.lights);
	assert_true(both.error.cell_max <= e.settings.target.cell);
	assert_true(both.error.sky_max <= e.settings.target.max);
	for (int k = 0; k < 2; k++)
		expect_at_most(encode_promises_difference(&e, part[k]),
			       (k ? both.ratio_error : both.object_error), "k=%d", k);
	for (int k = 0; k < 2; k++)
		encode_rig_part_free(part[k]);
	encode_rig_end(&e);
}

/* ---- receivers with a u of their own ---- */

TEST("over pairs")
{
	for (int k = 0; k < 4; k++) {
		struct encode_rig e = encode_rig_dome(k & 1 ? 6 : 3, k & 1 ? 4 : 3);
		struct encode_rig_part *part[2];
		struct encode_result result;
		const int n = e.settings.lights;

		encode_rig_start(&e);
		for (int q = 0; q < 2; q++) {
			part[q] = encode_rig_part_new(&e, q ? BASIS_KIND_U : BASIS_KIND_D, 120, 3,
						      k & 2);
			encode_rig_fill(&e, part[q]);
		}
		result = encode_rig_run(&e, part, 2, false);
		encode_promises_format(&e, &result);
		expect_at_least(result.shown_count, 2, "k=%d", k);
		expect_at_most(ensemble_sky_rms(&result.error), e.settings.target.rms, "k=%d", k);
		expect_at_most(result.error.cell_max, e.settings.target.cell, "k=%d", k);
		expect_at_most(result.error.sky_max, e.settings.target.max, "k=%d", k);
		for (int r = 0; r < 360; r++)
			for (int i = 0; i < n; i++) {
				/* Only rounding: 1 is white. */
				expect_at_least(part[1]->decoded[r * n + i],
						-2e-3 * e.light[i].solid_angle_sr,
						"k=%d, r=%d, i=%d", k, r, i);
			}
		for (int q = 0; q < 2; q++)
			encode_rig_part_free(part[q]);
		encode_rig_end(&e);
	}
}

/* ---- the exact layer, and sameness ---- */

TEST("exact")
{
	for (int kind = BASIS_KIND_T; kind <= BASIS_KIND_V; kind++) {
		struct encode_rig e = encode_rig_dome(5, 3);
		struct encode_rig_part *part = encode_rig_part_new(&e, (enum basis_kind)kind, 97,
								   kind == BASIS_KIND_T ? 3 : 1,
								   kind == BASIS_KIND_T);
		const int n = e.settings.lights;
		struct encode_result result;

		e.settings.exact = true;
		encode_rig_start(&e);
		encode_rig_fill(&e, part);
		result = encode_rig_run(&e, &part, 1, true);
		expect_equal(result.exact_count, 1, "kind=%d", kind);
		expect_equal(result.exact->entry.columns, n, "kind=%d", kind);
		expect_equal(result.exact->entry.bits, 16, "kind=%d", kind);
		expect_equal(result.exact->entry.patterns, 0, "kind=%d", kind);
		expect_equal(result.exact->entry.channels, kind == BASIS_KIND_T ? 3 : 1, "kind=%d",
			     kind);
		for (int i = 0; i < n; i++) {
			double most = 0;

			for (int r = 0; r < 97 * 3; r++)
				most = fmax(most, fabs(part->is[r * n + i]));
			for (int r = 0; r < 97 * 3; r++)
				expect_at_most(fabs(part->is[r * n + i] - part->decoded[r * n + i]),
					       most * (0.5 / 32767 + 1e-6), "kind=%d, i=%d, r=%d",
					       kind, i, r);
		}
		encode_rig_part_free(part);
		encode_rig_end(&e);
	}
}

/* Earlier tiles leave no trace in the encoder. */
TEST("repeats")
{
	struct encode_rig e = encode_rig_dome(6, 4), other = encode_rig_dome(6, 4);
	struct encode_rig_part *part = encode_rig_part_new(&e, BASIS_KIND_T, 200, 3, true);
	struct encode_rig_part *before = encode_rig_part_new(&e, BASIS_KIND_V, 256, 1, false);
	struct encode_result first, second;

	encode_rig_start(&e);
	encode_rig_start(&other);
	encode_rig_fill(&e, part);
	encode_rig_fill(&e, before);
	encode_rig_run(&other, &before, 1, false);
	first = encode_rig_run(&e, &part, 1, false);
	second = encode_rig_run(&other, &part, 1, false);
	assert_int_equal(first.shown_count, second.shown_count);
	for (int k = 0; k < first.shown_count; k++) {
		assert_memory_equal(&first.shown[k].entry, &second.shown[k].entry,
				    sizeof(first.shown->entry));
		assert_memory_equal(first.shown[k].payload, second.shown[k].payload,
				    first.shown[k].entry.bytes);
	}
	assert_memory_equal(&first.error, &second.error, sizeof(first.error));
	encode_rig_part_free(part);
	encode_rig_part_free(before);
	encode_rig_end(&e);
	encode_rig_end(&other);
}
