/* The encoder: errors held and declared, against blocks decoded in double precision. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <float.h>

#include "tests/unit/encoding.h"

static double largest_difference(const struct encoding *e, const struct encoding_part *part)
{
	const size_t n = (size_t)e->settings.lights;
	double most = 0;

	for (size_t k = 0; k < (size_t)part->samples.pixels * 3 * n; k++)
		most = fmax(most, fabs(part->is[k] - part->decoded[k]) /
					  encoding_unit(e, part->samples.kind, (int)(k % n)));
	return most;
}

/* White ground of the brightest channel under a lighting; [3][lights]. */
static double white_under(const struct encoding *e, const double *radiance)
{
	double white = 0;

	for (int c = 0; c < 3; c++) {
		double sum = 0;

		for (int i = 0; i < e->settings.lights; i++)
			sum += radiance[c * e->settings.lights + i] *
			       ensemble_projected_sr(&e->light[i]) / M_PI;
		white = fmax(white, sum);
	}
	return white;
}

/* Sums of a part's rows under a lighting: of kind V shares of the ground's light. */
static double lit(const struct encoding *e, const struct encoding_part *part, const double *values,
		  int row, const double *radiance)
{
	const int n = e->settings.lights, c = row % 3;
	double sum = 0, all = 0;

	for (int i = 0; i < n; i++) {
		const double u = part->samples.kind == BASIS_KIND_V ? e->ground[c * n + i] : 1;
		const double x = u * radiance[c * n + i];

		sum += values[(size_t)row * (size_t)n + (size_t)i] * x;
		all += x;
	}
	return part->samples.kind == BASIS_KIND_V ? sum / all : sum;
}

struct seen {
	double rms, most;
};

/* The difference in levels, exposed as ensemble.h says; kind T over black, V over its ground. */
static struct seen seen_under(const struct encoding *e, const struct encoding_part *part,
			      const double *radiance)
{
	const int rows = part->samples.pixels * 3;
	double white = white_under(e, radiance), square = 0;
	struct seen seen = {0, 0};

	for (int r = 0; r < rows && part->samples.kind == BASIS_KIND_T; r++)
		white = fmax(white, lit(e, part, part->is, r, radiance));
	for (int r = 0; r < rows; r++) {
		double is = lit(e, part, part->is, r, radiance);
		double got = lit(e, part, part->decoded, r, radiance), by;

		if (part->samples.kind == BASIS_KIND_V) {
			double ground = 0;

			for (int i = 0; i < e->settings.lights; i++)
				ground += e->ground[r % 3 * e->settings.lights + i] *
					  radiance[r % 3 * e->settings.lights + i];
			is = (1 - is) * ground;
			got = (1 - got) * ground;
		}
		by = fabs(encoding_level(is / white) - encoding_level(got / white));
		square += by * by;
		seen.most = fmax(seen.most, by);
	}
	seen.rms = sqrt(square / rows);
	return seen;
}

/* ---- what is held ---- */

static void hold_cells(const struct encoding *e, const struct encoding_part *part, double limit)
{
	const int n = e->settings.lights;
	double *radiance = calloc(3 * (size_t)n, sizeof(*radiance));

	assert_non_null(radiance);
	for (int i = 0; i < n; i++) {
		struct seen seen;

		for (int c = 0; c < 3; c++)
			radiance[c * n + i] = 1;
		seen = seen_under(e, part, radiance);
		if (seen.most > limit)
			fail_msg("cell %d of %d alone: %g levels, expected at most %g", i, n,
				 seen.most, limit);
		for (int c = 0; c < 3; c++)
			radiance[c * n + i] = 0;
	}
	free(radiance);
}

/* Lightings that are not of the ensemble: a lamp, a sun or soft light in a direction of chance. */
static void light_unseen(const struct encoding *e, struct chance *chance, double *radiance)
{
	const int n = e->settings.lights, which = chance_int(chance, 0, 2);
	double to[3], tone[3];

	chance_direction(chance, 0.05, to);
	for (int c = 0; c < 3; c++)
		tone[c] = chance_real(chance, 0.2, 1);
	for (int i = 0; i < n; i++) {
		const double near = encoding_dot(e->light[i].direction, to);

		for (int c = 0; c < 3; c++)
			radiance[c * n + i] = which == 0 ? 0.05 + tone[c] * pow(fmax(near, 0), 40)
					      : which == 1
						      ? 0.3 + tone[c] * chance_real(chance, 0, 3)
						      : 0.2 * tone[c] + (near > 0.99 ? 300 : 0);
	}
}

static void hold_unseen(const struct encoding *e, const struct encoding_part *part, int times,
			struct chance *chance)
{
	double *radiance = calloc(3 * (size_t)e->settings.lights, sizeof(*radiance));

	assert_non_null(radiance);
	for (int k = 0; k < times; k++) {
		struct seen seen;

		light_unseen(e, chance, radiance);
		seen = seen_under(e, part, radiance);
		/* Hardly more than what was tried, or than its brightest cell alone. */
		if (seen.rms > e->settings.target.cell || seen.most > 1.5 * e->settings.target.max)
			fail_msg("unseen light %d: RMS %g, most %g levels", k, seen.rms, seen.most);
	}
	free(radiance);
}

static void hold_skies(const struct encoding *e, const struct encoding_part *part)
{
	const size_t n = (size_t)e->settings.lights;
	double *radiance = calloc(3 * n, sizeof(*radiance));

	assert_non_null(radiance);
	for (int s = 0; s < e->ensemble.skies; s++) {
		struct seen seen;

		for (size_t k = 0; k < 3 * n; k++)
			radiance[k] = (double)e->ensemble.radiance[(size_t)s * 3 * n + k];
		seen = seen_under(e, part, radiance);
		if (seen.rms > e->settings.target.rms || seen.most > e->settings.target.max)
			fail_msg("sky %d, kind %d, %d pixels, %d lights: RMS %g, most %g levels", s,
				 (int)part->samples.kind, part->samples.pixels, (int)n, seen.rms,
				 seen.most);
	}
	free(radiance);
}

static void check_format(const struct encoding *e, const struct encode_result *result)
{
	for (int k = 0; k < result->shown_count; k++) {
		const struct basis_block_entry *b = &result->shown[k].entry;
		const struct encoding_arrays a = encoding_arrays_of(&result->shown[k],
								    e->settings.coarse);

		assert_true(b->tile == 5 && b->pixels && b->patterns + b->columns > 0);
		assert_true(!k || result->shown[k - 1].entry.kind <= b->kind);
		assert_true(b->columns || b->bits == 16);
		for (int p = 1; p < b->pixels; p++)
			assert_true(a.pixel[p] > a.pixel[p - 1]);
		for (uint32_t n = 0; n < b->columns; n++) {
			assert_true(a.light[n] < e->settings.lights);
			assert_true(!n || a.light[n] > a.light[n - 1]);
			assert_true(a.column_scale[n] >= 0 &&
				    (double)a.column_scale[n] * (b->bits == 8 ? 127 : 32767) <=
					    BASIS_VALUE_MAX);
			for (int p = 0; p < (b->pixels + 63) / 64 * 64 && b->bits == 8; p++)
				assert_true(a.column8[((size_t)(p / 64) * b->channels * b->columns +
						       n) * 64 +
						      (size_t)(p % 64)] >= -127 * (p < b->pixels));
		}
		for (int j = 0; j < b->patterns; j++) {
			double sum = 0;

			for (int i = 0; i < a.stride; i++) {
				assert_true(a.pattern[j * a.stride + i] != -32768);
				assert_true(i < e->settings.coarse ||
					    a.pattern[j * a.stride + i] == 0);
				sum += abs(a.pattern[j * a.stride + i]);
			}
			assert_true((double)a.pattern_scale[j] * 32767 * sum <= BASIS_VALUE_MAX);
		}
	}
}

/* One part by itself: all that is promised of it. */
static struct encode_result hold(struct encoding *e, struct encoding_part *part,
				 struct chance *chance)
{
	const struct encode_result result = encoding_run(e, &part, 1, false);
	const double bound = part->samples.kind == BASIS_KIND_T ? result.object_error
								: result.ratio_error;
	const double is = largest_difference(e, part);

	check_format(e, &result);
	if (is > bound || is < 0.99 * bound - 1e-5)
		fail_msg("largest difference %g, declared %g", is, bound);
	hold_cells(e, part, e->settings.target.cell);
	hold_skies(e, part);
	if (chance)
		hold_unseen(e, part, 40, chance);
	assert_true(ensemble_sky_rms(&result.error) <= e->settings.target.rms);
	assert_true(result.error.cell_max <= e->settings.target.cell);
	return result;
}

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
		hold(&e, part, &chance);
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

		e.settings.target.cell = cell;
		encoding_start(&e);
		encoding_fill(&e, part);
		result = hold(&e, part, NULL);
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
	check_format(&e, &both);
	assert_true(both.error.sky_count == 3 * 64);
	assert_true(both.error.cell_count == 3 * 64 * e.settings.lights);
	assert_true(both.error.cell_max <= 2 * e.settings.target.cell);
	for (int k = 0; k < 2; k++)
		assert_true(largest_difference(&e, part[k]) <=
			    (k ? both.ratio_error : both.object_error));
	for (int k = 0; k < 2; k++)
		encoding_part_free(part[k]);
	encoding_end(&e);
}

/* ---- hard values ---- */

/* Full rank: no pattern does. */
static void over_noise(void **state)
{
	struct chance chance = chance_begin("noise");

	(void)state;
	for (int k = 0; k < 2; k++) {
		struct encoding e = encoding_dome(4, 4);
		struct encoding_part *part = encoding_part_new(&e, k ? BASIS_KIND_T : BASIS_KIND_V,
							       100, k ? 3 : 1, false);
		const int n = e.settings.lights;
		struct encode_result result;

		encoding_start(&e);
		for (int r = 0; r < 100 * part->samples.channels; r++)
			for (int i = 0; i < n; i++)
				part->direct[r * n + i] =
					(float)(chance_real(&chance, 0, 0.3) *
						(k ? e.light[i].solid_angle_sr : 1));
		result = hold(&e, part, NULL);
		assert_true(result.shown_count > 0);
		encoding_part_free(part);
		encoding_end(&e);
	}
}

static void over_sizes(void **state)
{
	static const int pixels[] = {1, 2, 31, 32, 33, 64, 65, 255, 256};

	(void)state;
	for (int lights = 0; lights < 2; lights++)
		for (size_t k = 0; k < sizeof(pixels) / sizeof(*pixels); k++)
			for (int kind = BASIS_KIND_T; kind <= BASIS_KIND_V; kind++) {
				struct encoding e = lights ? encoding_dome(1, 1) : encoding_lamp();
				struct encoding_part *part = encoding_part_new(
					&e, (enum basis_kind)kind, pixels[k], 3, k % 2);

				encoding_start(&e);
				encoding_fill(&e, part);
				hold(&e, part, NULL);
				encoding_part_free(part);
				encoding_end(&e);
			}
}

/* Nothing, all alike, one light a million times the rest, values that hardly are. */
static void over_values(void **state)
{
	(void)state;
	for (int k = 0; k < 6; k++) {
		struct encoding e = encoding_dome(4, 4);
		struct encoding_part *part =
			encoding_part_new(&e, k == 1 ? BASIS_KIND_V : BASIS_KIND_T, 70, 3, false);
		const int n = e.settings.lights;
		struct encode_result result;

		encoding_start(&e);
		for (int r = 0; r < 210; r++)
			for (int i = 0; i < n; i++) {
				const double w = e.light[i].solid_angle_sr;

				part->direct[r * n + i] =
					(float)(k == 0	 ? 0
						: k == 1 ? 1
						: k == 2 ? 0.2 * w
						: k == 3 ? w * 1e-3 * (i == 7 ? 1e6 : 1) * (r % 7)
						: k == 4 ? 1e-44 * (r % 5)
							 : 1e-30 * (i % 5) * (r % 3));
			}
		result = hold(&e, part, NULL);
		assert_true(k != 0 || !result.shown_count);
		/* 6,000 is the largest value of the fourth. */
		assert_true(result.object_error < (k == 3 ? 6000 / 250.0 : 1e-2));
		assert_true(result.ratio_error < 1e-2);
		encoding_part_free(part);
		encoding_end(&e);
	}
}

static int encode_one(struct encoding *e, struct encoding_part *part, float value)
{
	struct encode_result result;

	part->direct[3] = value;
	return encode_tile(e->encoder, 0, e->coverage, &part->samples, 1, &result);
}

static void refuses(void **state)
{
	struct encoding e = encoding_dome(2, 2);
	struct encoding_part *part = encoding_part_new(&e, BASIS_KIND_T, 5, 3, true);
	struct encoding_part *pair[2];
	struct encode_samples samples[2];
	struct encode_result result;

	(void)state;
	encoding_start(&e);
	encoding_fill(&e, part);
	assert_int_equal(encode_one(&e, part, NAN), -EDOM);
	assert_int_equal(encode_one(&e, part, INFINITY), -EDOM);
	assert_int_equal(encode_one(&e, part, -1e31F), -EDOM);
	assert_int_equal(encode_one(&e, part, 70000 * (float)e.light[3].solid_angle_sr), -EDOM);
	assert_int_equal(encode_one(&e, part, 60000 * (float)e.light[3].solid_angle_sr), 0);
	part->bounce[1] = NAN;
	assert_int_equal(encode_one(&e, part, 0), -EDOM);
	for (int k = 0; k < 2; k++) {
		pair[k] = encoding_part_new(&e, k ? BASIS_KIND_U : BASIS_KIND_D, 5, 3, false);
		encoding_fill(&e, pair[k]);
		samples[k] = pair[k]->samples;
	}
	assert_int_equal(encode_tile(e.encoder, 0, e.coverage, samples, 1, &result), -EINVAL);
	assert_int_equal(encode_tile(e.encoder, 0, e.coverage, samples + 1, 1, &result), -EINVAL);
	samples[1].pixels = 4;
	assert_int_equal(encode_tile(e.encoder, 0, e.coverage, samples, 2, &result), -EINVAL);
	samples[1].pixels = 5;
	pair[1]->direct[0] = -1e-6F;
	assert_int_equal(encode_tile(e.encoder, 0, e.coverage, samples, 2, &result), -EDOM);
	assert_int_equal(encode_tile(e.encoder, 0, e.coverage, NULL, 0, &result), 0);
	assert_int_equal(result.shown_count, 0);
	encoding_part_free(part);
	for (int k = 0; k < 2; k++)
		encoding_part_free(pair[k]);
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
		check_format(&e, &result);
		assert_true(result.shown_count >= 2);
		assert_true(ensemble_sky_rms(&result.error) <= e.settings.target.rms);
		assert_true(result.error.cell_max <= 2 * e.settings.target.cell);
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

/* ---- the coarse lights ---- */

static void over_coarse(void **state)
{
	static const int fine[] = {2, 5, 9, 12, 20, 36}, coarse[] = {1, 2, 3, 4, 9};

	(void)state;
	for (size_t a = 0; a < 6; a++)
		for (size_t b = 0; b < 5; b++) {
			struct encoding e, few;

			if (coarse[b] >= fine[a])
				continue;
			e = encoding_dome(fine[a], coarse[b]);
			few = encoding_dome(coarse[b], coarse[b]);
			for (int i = 0; i < e.settings.lights; i++) {
				const struct basis_coarse *g = &e.gather[i];
				double mean[3] = {0, 0, 0};
				int sum = 0;

				for (int k = 0; k < 3; k++) {
					assert_true(g->index[k] < e.settings.coarse);
					assert_true(!k || !g->weight[k] ||
						    (g->weight[k - 1] &&
						     g->index[k] > g->index[k - 1]));
					assert_true(g->weight[k] || !g->index[k]);
					sum += g->weight[k];
					for (int x = 0; x < 3; x++)
						mean[x] += g->weight[k] *
							   few.light[g->index[k]].direction[x];
				}
				assert_int_equal(sum, BASIS_COARSE_ONE);
				/* Inside the triangles: the mean lies in the light's direction. */
				if (e.light[i].direction[2] > 1.0 / coarse[b])
					assert_true(encoding_dot(mean, e.light[i].direction) >
						    (1 - 1e-7) * sqrt(encoding_dot(mean, mean)));
			}
			encoding_end(&e);
			encoding_end(&few);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(over_scenes), cmocka_unit_test(over_targets),
		cmocka_unit_test(together),    cmocka_unit_test(over_noise),
		cmocka_unit_test(over_sizes),  cmocka_unit_test(over_values),
		cmocka_unit_test(refuses),     cmocka_unit_test(over_pairs),
		cmocka_unit_test(exact),       cmocka_unit_test(repeats),
		cmocka_unit_test(over_coarse),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
