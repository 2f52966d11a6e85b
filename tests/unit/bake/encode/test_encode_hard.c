/* SPDX-License-Identifier: MIT */
/* Hard cases of the encoder: values that no pattern fits, sizes that fill no line, and what it
 * refuses. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "bake/judge/shade.h"
#include "tests/support/bake/encode_promises.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* Noise has full rank, so that no pattern helps. */
TEST("over noise")
{
	struct chance chance = chance_begin("noise");

	for (int k = 0; k < 2; k++) {
		struct encode_rig e = encode_rig_dome(4, 4);
		struct encode_rig_part *part = encode_rig_part_new(
			&e, k ? BASIS_KIND_T : BASIS_KIND_V, 100, k ? 3 : 1, false);
		const int n = e.settings.lights;
		struct encode_result result;

		encode_rig_start(&e);
		for (int r = 0; r < 100 * part->samples.channels; r++)
			for (int i = 0; i < n; i++)
				part->direct[r * n + i] =
					(float)(chance_real(&chance, 0, 0.3) *
						(k ? e.light[i].solid_angle_sr : 1));
		result = encode_promises_hold(&e, part, NULL);
		expect_above(result.shown_count, 0, "k=%d", k);
		encode_rig_part_free(part);
		encode_rig_end(&e);
	}
}

/* With many lights nearly each column is too dim to be used alone, but together they matter. */
TEST("over many lights")
{
	struct chance chance = chance_begin("many lights");

	for (int k = 0; k < 2; k++) {
		struct encode_rig e = encode_rig_dome(12, 3);
		struct encode_rig_part *part = encode_rig_part_new(
			&e, k ? BASIS_KIND_T : BASIS_KIND_V, 64, k ? 3 : 1, false);
		const int n = e.settings.lights;

		encode_rig_start(&e);
		for (int r = 0; r < 64 * part->samples.channels; r++)
			for (int i = 0; i < n; i++)
				part->direct[r * n + i] =
					chance_real(&chance, 0, 1) < 0.3
						? (float)(k ? 0.3 * e.light[i].solid_angle_sr : 1)
						: 0;
		encode_promises_hold(&e, part, NULL);
		encode_rig_part_free(part);
		encode_rig_end(&e);
	}
}

/* Lights near the horizon: an object that faces them throws many times their light on the ground,
 * beside a dark shadow. */
TEST("over low lights")
{
	struct chance chance = chance_begin("low lights");

	for (int k = 0; k < 2; k++) {
		struct encode_rig e = encode_rig_dome(12, 3);
		struct encode_rig_part *part = encode_rig_part_new(&e, BASIS_KIND_V, 100, k ? 3 : 1,
								   false);
		const int channels = part->samples.channels, n = e.settings.lights;

		encode_rig_start(&e);
		for (int r = 0; r < 100 * channels; r++)
			for (int i = 0; i < n; i++)
				part->direct[r * n + i] =
					i % 50		    ? (float)chance_real(&chance, 0, 0.1)
					: r / channels < 50 ? (float)chance_real(&chance, -57, -10)
							    : (float)chance_real(&chance, 0.98, 1);
		encode_promises_hold(&e, part, NULL);
		encode_rig_part_free(part);
		encode_rig_end(&e);
	}
}

/* Near mirrors: each pixel sees a few lights many times brighter than diffuse ones, and nearly
 * nothing of the others. Columns of groups reach as far. */
TEST("over mirrors")
{
	struct encode_rig e = encode_rig_dome(12, 6);
	struct encode_rig_part *part = encode_rig_part_new(&e, BASIS_KIND_T, 256, 3, false);
	const int n = e.settings.lights;

	encode_rig_start(&e);
	for (int p = 0; p < 256; p++) {
		const double x = (p % 16 - 7.5) / 16, y = (p / 16 - 7.5) / 16;
		const double to[3] = {x, y, sqrt(1 - x * x - y * y)};

		for (int k = 0; k < 3 * n; k++) {
			const struct basis_light *light = &e.light[k % n];
			const double near = fmax(encode_rig_dot(light->direction, to), 0);

			part->direct[(p * 3 + k / n) * n + k % n] =
				(float)((1e-5 + 60 * pow(near, 400)) * light->solid_angle_sr);
		}
	}
	encode_promises_hold(&e, part, NULL);
	encode_rig_part_free(part);
	encode_rig_end(&e);
}

/* A tile's blocks do not depend on the tile before it, of which the encoder keeps nothing. */
TEST("each tile begins anew")
{
	struct encode_rig e = encode_rig_dome(3, 2);
	const int n = e.settings.lights;
	struct part part = {
		.kind = BASIS_KIND_T, .rows = 1, .value = calloc((size_t)n, sizeof(float))};
	struct shade fresh, used;
	size_t bytes;

	assert_non_null(part.value);
	e.settings.ensemble = &e.ensemble;
	assert_int_equal(shade_create(&fresh, &e.settings), 0);
	assert_int_equal(shade_create(&used, &e.settings), 0);
	shade_begin(&fresh);
	shade_begin(&used);
	part.value[1] = -1;
	shade_set(&used, &e.settings, &part, 1);
	shade_try(&used, used.skies.tried + 3);
	shade_begin(&used);
	bytes = (size_t)used.skies.skies * 3 * (size_t)n * sizeof(*used.skies.radiance);
	assert_int_equal(used.skies.tried, fresh.skies.tried);
	assert_memory_equal(used.skies.radiance, fresh.skies.radiance, bytes);
	assert_memory_equal(used.tried, fresh.tried,
			    (size_t)used.skies.tried * sizeof(*used.tried));
	shade_free(&fresh);
	shade_free(&used);
	free(part.value);
	encode_rig_end(&e);
}

TEST("over sizes")
{
	static const int pixels[] = {1, 2, 31, 32, 33, 64, 65, 255, 256};

	for (int lights = 0; lights < 2; lights++)
		for (size_t k = 0; k < sizeof(pixels) / sizeof(*pixels); k++)
			for (int kind = BASIS_KIND_T; kind <= BASIS_KIND_V; kind++) {
				struct encode_rig e = lights ? encode_rig_dome(1, 1)
							     : encode_rig_lamp();
				struct encode_rig_part *part = encode_rig_part_new(
					&e, (enum basis_kind)kind, pixels[k], 3, k % 2);

				encode_rig_start(&e);
				encode_rig_fill(&e, part);
				encode_promises_hold(&e, part, NULL);
				encode_rig_part_free(part);
				encode_rig_end(&e);
			}
}

/* All zeros, all equal, one light a million times the others, and denormal values. */
TEST("over values")
{
	for (int k = 0; k < 6; k++) {
		struct encode_rig e = encode_rig_dome(4, 4);
		struct encode_rig_part *part =
			encode_rig_part_new(&e, k == 1 ? BASIS_KIND_V : BASIS_KIND_T, 70, 3, false);
		const int n = e.settings.lights;
		struct encode_result result;

		encode_rig_start(&e);
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
		result = encode_promises_hold(&e, part, NULL);
		expect_that(k != 0 || !result.shown_count, "k=%d", k);
		/* 6,000 is the largest value of the fourth case. Alone in its light the pixel is
		 * white, and two levels of white are 1.8 %. */
		expect_below(result.object_error, (k == 3 ? 6000 * 0.018 : 1e-2), "k=%d", k);
		expect_below(result.ratio_error, 1e-2, "k=%d", k);
		encode_rig_part_free(part);
		encode_rig_end(&e);
	}
}

static int encode_one(struct encode_rig *e, struct encode_rig_part *part, float value)
{
	struct encode_result result;

	part->direct[3] = value;
	return encode_tile(e->encoder, 0, e->coverage, &part->samples, 1, &result);
}

TEST("refuses")
{
	struct encode_rig e = encode_rig_dome(2, 2);
	struct encode_rig_part *part = encode_rig_part_new(&e, BASIS_KIND_T, 5, 3, true);
	struct encode_rig_part *pair[2];
	struct encode_samples samples[2];
	struct encode_result result;

	encode_rig_start(&e);
	encode_rig_fill(&e, part);
	assert_int_equal(encode_tile(e.encoder, 0, e.coverage, NULL, 0, &result), 0);
	assert_int_equal(result.shown_count, 0);
	assert_int_equal(encode_one(&e, part, NAN), -EDOM);
	assert_int_equal(encode_one(&e, part, INFINITY), -EDOM);
	assert_int_equal(encode_one(&e, part, -1e31F), -EDOM);
	assert_int_equal(encode_one(&e, part, 70000 * (float)e.light[3].solid_angle_sr), -EDOM);
	assert_int_equal(encode_one(&e, part, 60000 * (float)e.light[3].solid_angle_sr), 0);
	part->bounce[1] = NAN;
	assert_int_equal(encode_one(&e, part, 0), -EDOM);
	for (int k = 0; k < 2; k++) {
		pair[k] = encode_rig_part_new(&e, k ? BASIS_KIND_U : BASIS_KIND_D, 5, 3, false);
		encode_rig_fill(&e, pair[k]);
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
	encode_rig_part_free(part);
	for (int k = 0; k < 2; k++)
		encode_rig_part_free(pair[k]);
	encode_rig_end(&e);
}
