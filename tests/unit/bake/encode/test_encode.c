/* SPDX-License-Identifier: MIT */
/* The encoder: errors held and declared, against blocks decoded in double precision. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/support/holding.h"

static void over_scenes(void **state)
{
	struct chance chance = chance_begin("scenes");

	(void)state;
	for (int k = 0; k < 8; k++) {
		struct encoding e = encoding_dome(k & 1 ? 8 : 5, k & 2 ? 4 : 9);
		const enum basis_kind kind = k & 4 ? BASIS_KIND_T : BASIS_KIND_V;
		struct encoding_part *part;

		if (!(k & 2))
			e.settings.coarse = e.settings.lights;
		part = encoding_part_new(&e, kind, k & 1 ? 256 : 57, kind == BASIS_KIND_T ? 3 : 1,
					 k != 4);
		encoding_start(&e);
		encoding_fill(&e, part);
		if (kind == BASIS_KIND_T)
			for (int p = 0; p < part->samples.pixels; p++)
				e.coverage[part->pixel[p]] = 65535;
		holding_all(&e, part, &chance);
		encoding_part_free(part);
		encoding_end(&e);
	}
}

/* Errors asked for are errors got: a tighter one costs more and is held. */
static void over_targets(void **state)
{
	uint64_t before = UINT64_MAX;

	(void)state;
	for (double cell = 0.25; cell < 20; cell *= 3) {
		struct encoding e = encoding_dome(6, 6);
		struct encoding_part *part = encoding_part_new(&e, BASIS_KIND_V, 256, 1, true);
		struct encode_result result;
		uint64_t bytes = 0;

		/* The strongest of the ensemble's suns are nearly a cell alone. */
		e.settings.target.cell = cell;
		e.settings.target.max = fmax(e.settings.target.max, cell);
		e.settings.target.rms = fmax(e.settings.target.rms, cell / 4);
		encoding_start(&e);
		encoding_fill(&e, part);
		result = holding_all(&e, part, NULL);
		for (int k = 0; k < result.shown_count; k++)
			bytes += result.shown[k].entry.bytes;
		assert_true(bytes <= before);
		before = bytes;
		encoding_part_free(part);
		encoding_end(&e);
	}
	assert_true(before < 256 * 3 * 186 / 5); /* against a byte a value */
}

/* An error in T and V at once, at a pixel half covered, is measured as it is seen. */
static void together(void **state)
{
	struct encoding e = encoding_dome(5, 5);
	struct encoding_part *part[2];
	struct encode_result both;

	(void)state;
	encoding_start(&e);
	part[0] = encoding_part_new(&e, BASIS_KIND_T, 64, 3, true);
	part[1] = encoding_part_new(&e, BASIS_KIND_V, 64, 1, true);
	for (int k = 0; k < 2; k++)
		encoding_fill(&e, part[k]);
	for (int p = 0; p < PIXELS_MOST; p++)
		e.coverage[p] = 32768;
	both = encoding_run(&e, part, 2, false);
	holding_format(&e, &both);
	assert_true(both.error.sky_count == 3 * 64);
	assert_true(both.error.cell_count == 3 * 64 * e.settings.lights);
	assert_true(both.error.cell_max <= e.settings.target.cell);
	assert_true(both.error.sky_max <= e.settings.target.max);
	for (int k = 0; k < 2; k++)
		assert_true(holding_difference(&e, part[k]) <=
			    (k ? both.ratio_error : both.object_error));
	for (int k = 0; k < 2; k++)
		encoding_part_free(part[k]);
	encoding_end(&e);
}

/* ---- receivers with a u of their own ---- */

static void over_pairs(void **state)
{
	(void)state;
	for (int k = 0; k < 4; k++) {
		struct encoding e = encoding_dome(k & 1 ? 6 : 3, k & 1 ? 4 : 3);
		struct encoding_part *part[2];
		struct encode_result result;
		const int n = e.settings.lights;

		encoding_start(&e);
		for (int q = 0; q < 2; q++) {
			part[q] = encoding_part_new(&e, q ? BASIS_KIND_U : BASIS_KIND_D, 120, 3,
						    k & 2);
			encoding_fill(&e, part[q]);
		}
		result = encoding_run(&e, part, 2, false);
		holding_format(&e, &result);
		assert_true(result.shown_count >= 2);
		assert_true(ensemble_sky_rms(&result.error) <= e.settings.target.rms);
		assert_true(result.error.cell_max <= e.settings.target.cell);
		assert_true(result.error.sky_max <= e.settings.target.max);
		for (int r = 0; r < 360; r++)
			for (int i = 0; i < n; i++) {
				/* Nothing but what rounding makes: 1 is white. */
				assert_true(part[1]->decoded[r * n + i] >=
					    -2e-3 * e.light[i].solid_angle_sr);
			}
		for (int q = 0; q < 2; q++)
			encoding_part_free(part[q]);
		encoding_end(&e);
	}
}

/* ---- the exact layer, and sameness ---- */

static void exact(void **state)
{
	(void)state;
	for (int kind = BASIS_KIND_T; kind <= BASIS_KIND_V; kind++) {
		struct encoding e = encoding_dome(5, 3);
		struct encoding_part *part = encoding_part_new(&e, (enum basis_kind)kind, 97,
							       kind == BASIS_KIND_T ? 3 : 1,
							       kind == BASIS_KIND_T);
		const int n = e.settings.lights;
		struct encode_result result;

		e.settings.exact = true;
		encoding_start(&e);
		encoding_fill(&e, part);
		result = encoding_run(&e, &part, 1, true);
		assert_int_equal(result.exact_count, 1);
		assert_int_equal(result.exact->entry.columns, n);
		assert_int_equal(result.exact->entry.bits, 16);
		assert_int_equal(result.exact->entry.patterns, 0);
		assert_int_equal(result.exact->entry.channels, kind == BASIS_KIND_T ? 3 : 1);
		for (int i = 0; i < n; i++) {
			double most = 0;

			for (int r = 0; r < 97 * 3; r++)
				most = fmax(most, fabs(part->is[r * n + i]));
			for (int r = 0; r < 97 * 3; r++)
				assert_true(fabs(part->is[r * n + i] - part->decoded[r * n + i]) <=
					    most * (0.5 / 32767 + 1e-6));
		}
		encoding_part_free(part);
		encoding_end(&e);
	}
}

/* What was encoded before leaves no trace. */
static void repeats(void **state)
{
	struct encoding e = encoding_dome(6, 4), other = encoding_dome(6, 4);
	struct encoding_part *part = encoding_part_new(&e, BASIS_KIND_T, 200, 3, true);
	struct encoding_part *before = encoding_part_new(&e, BASIS_KIND_V, 256, 1, false);
	struct encode_result first, second;

	(void)state;
	encoding_start(&e);
	encoding_start(&other);
	encoding_fill(&e, part);
	encoding_fill(&e, before);
	encoding_run(&other, &before, 1, false);
	first = encoding_run(&e, &part, 1, false);
	second = encoding_run(&other, &part, 1, false);
	assert_int_equal(first.shown_count, second.shown_count);
	for (int k = 0; k < first.shown_count; k++) {
		assert_memory_equal(&first.shown[k].entry, &second.shown[k].entry,
				    sizeof(first.shown->entry));
		assert_memory_equal(first.shown[k].payload, second.shown[k].payload,
				    first.shown[k].entry.bytes);
	}
	assert_memory_equal(&first.error, &second.error, sizeof(first.error));
	encoding_part_free(part);
	encoding_part_free(before);
	encoding_end(&e);
	encoding_end(&other);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(over_scenes), cmocka_unit_test(over_targets),
		cmocka_unit_test(together),    cmocka_unit_test(over_pairs),
		cmocka_unit_test(exact),       cmocka_unit_test(repeats),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
