/* The encoder: its declared errors against brute force in double precision. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <float.h>
#include <stdbool.h>
#include <string.h>

#include "bake/encode.h"
#include "hal/basis/basis_layout.h"
#include "tests/unit/chance.h"

#define PIXELS_MOST (BASIS_TILE * BASIS_TILE)

/* One kind of samples, and what its blocks say of them. */
struct trial {
	int lights, pixels;
	uint16_t pixel[PIXELS_MOST];
	float *value;	 /* [pixels][3][lights] */
	double *decoded; /* the same */
	double *ground;	 /* [3][lights] */
	bool rest;	 /* the block has one */
};

static void trial_begin(struct trial *t, int lights, int pixels)
{
	const size_t values = (size_t)pixels * 3 * (size_t)lights;

	t->lights = lights;
	t->pixels = pixels;
	t->value = calloc(values, sizeof(*t->value));
	t->decoded = calloc(values, sizeof(*t->decoded));
	t->ground = calloc((size_t)lights * 3, sizeof(*t->ground));
	assert_true(t->value && t->decoded && t->ground);
	for (int p = 0; p < pixels; p++)
		t->pixel[p] = (uint16_t)(p * (PIXELS_MOST / pixels));
	for (int i = 0; i < lights * 3; i++)
		t->ground[i] = 1 + i % 5;
}

static void trial_end(struct trial *t)
{
	free(t->value);
	free(t->decoded);
	free(t->ground);
}

static void decode_block(struct trial *t, const struct basis_block_payload *block)
{
	const struct basis_block_entry *e = &block->entry;
	const struct basis_layout at = basis_layout(e->kind, e->pixels, e->channels,
						    (int)e->lights);
	const uint8_t *payload = block->payload;
	const uint16_t *pixel = (const uint16_t *)(payload + at.pixel);
	const uint16_t *light = (const uint16_t *)(payload + at.light);
	const float *scale = (const float *)(payload + at.scale);
	const int16_t *row = (const int16_t *)(payload + at.row);

	assert_true(e->bytes == at.bytes);
	t->rest = light[e->lights - 1] == t->lights;
	assert_true(!t->rest || e->kind == BASIS_KIND_V);
	for (int p = 0; p < e->pixels; p++) {
		int own = 0;

		while (t->pixel[own] != pixel[p])
			own++;
		assert_true(own < t->pixels);
		for (int c = 0; c < 3; c++) {
			const int r = e->channels == 3 ? p * 3 + c : p;
			const int16_t *from = row + (size_t)r * (size_t)at.stride;
			const uint32_t listed = e->lights - t->rest;
			double *to = t->decoded + ((size_t)own * 3 + (size_t)c) * (size_t)t->lights;

			for (int i = 0; t->rest && i < t->lights; i++)
				to[i] = (double)scale[r] * from[listed];
			for (uint32_t i = 0; i < listed; i++)
				to[light[i]] = (double)scale[r] * from[i];
		}
	}
}

static void encode(struct trial *t, enum basis_kind kind, double cut, struct encode_result *result,
		   struct encoder **encoder)
{
	const struct encode_settings settings = {t->lights, 1, t->ground, cut};
	const struct encode_samples samples = {kind, 0, t->pixels, t->pixel, t->value};

	assert_int_equal(encoder_create(encoder, &settings), 0);
	assert_int_equal(encode_tile(*encoder, 9, &samples, 1, result), 0);
	t->rest = false;
	memset(t->decoded, 0, (size_t)t->pixels * 3 * (size_t)t->lights * sizeof(*t->decoded));
	for (int b = 0; b < result->count; b++)
		decode_block(t, &result->blocks[b]);
}

/* The worst that lighting can make of the errors of one row, as a share of all its weight: any
 * weighted mean lies between the extremes, which single lights reach. */
static double worst_error(const struct trial *t)
{
	double worst = 0;

	for (size_t k = 0; k < (size_t)t->pixels * 3 * (size_t)t->lights; k++)
		worst = fmax(worst, fabs((double)t->value[k] - t->decoded[k]));
	return worst;
}

/* |sum error L| / sum weight L under lights that are random, or all on one side of the error. */
static double lit_error(const struct trial *t, const double *weight, int pattern,
			struct chance *chance)
{
	double worst = 0;

	for (int r = 0; r < t->pixels * 3; r++) {
		double sum = 0, all = 0;

		for (int i = 0; i < t->lights; i++) {
			const size_t k = (size_t)r * (size_t)t->lights + (size_t)i;
			const double error = (double)t->value[k] - t->decoded[k];
			const double light = pattern == 0   ? chance_real(chance, 0, 1)
					     : pattern == 1 ? error > 0
							    : error < 0;
			const double w = weight ? weight[r % 3 * t->lights + i] : 1;

			sum += error * w * light;
			all += w * light;
		}
		if (all > 0)
			worst = fmax(worst, fabs(sum) / all);
	}
	return worst;
}

/* Values of many sizes, some 0, some light nowhere above a small share of the rest. */
static void fill(struct trial *t, bool negative, double faint, struct chance *chance)
{
	for (int r = 0; r < t->pixels * 3; r++) {
		const double size = pow(10, chance_real(chance, -3, 0));

		for (int i = 0; i < t->lights; i++) {
			const double v = chance_real(chance, negative ? -1 : 0, 1);
			float *to = &t->value[(size_t)r * (size_t)t->lights + (size_t)i];

			if (r / 3 % 7 == 3)
				*to = (float)(faint * v); /* a pixel that may go */
			else if (i % 3 == 1)
				*to = (float)(faint * v); /* a light that may go */
			else
				*to = i % 11 == 5 ? 0 : (float)(size * v);
		}
	}
}

static void declared_errors_hold(void **state)
{
	static const int counts[] = {1, 6, 26, 91, 406};
	static const double cuts[] = {0, 1e-4, 1e-3, 0.05};
	struct chance chance = chance_begin("declared errors");
	double object_use = 0, ratio_use = 0;

	(void)state;
	for (int k = 0; k < 60; k++) {
		const bool object = k % 2;
		const double cut = cuts[k / 2 % 4];
		struct encode_result result;
		struct encoder *encoder;
		struct trial t;
		double declared;

		trial_begin(&t, counts[k % 5], chance_int(&chance, 1, 60));
		fill(&t, !object, k % 3 ? cut : 1e-6, &chance);
		encode(&t, object ? BASIS_KIND_T : BASIS_KIND_V, cut, &result, &encoder);
		declared = object ? result.object_error : result.ratio_error;
		assert_true((object ? result.ratio_error : result.object_error) == 0);
		assert_true(worst_error(&t) <= declared);
		for (int pattern = 0; pattern < 3; pattern++)
			assert_true(lit_error(&t, object ? NULL : t.ground, pattern, &chance) <=
				    declared * (1 + 1e-12));
		if (object)
			object_use = fmax(object_use, worst_error(&t) / declared);
		else
			ratio_use = fmax(ratio_use, worst_error(&t) / declared);
		encoder_destroy(encoder);
		trial_end(&t);
	}
	/* The bounds are not idle: something comes close to them. */
	printf("# largest error over declared: object %.3f, ratio %.3f\n", object_use, ratio_use);
	assert_true(object_use > 0.9 && ratio_use > 0.9);
}

static void cuts_drop_what_they_should(void **state)
{
	struct chance chance = chance_begin("cuts");
	struct encode_result result;
	struct encoder *encoder;
	struct trial t;

	(void)state;
	trial_begin(&t, 91, 20);
	fill(&t, true, 1e-3, &chance);
	encode(&t, BASIS_KIND_V, 1e-3, &result, &encoder);
	assert_int_equal(result.count, 1);
	assert_int_equal(result.blocks[0].entry.tile, 9);
	assert_int_equal(result.blocks[0].entry.pixels, 20 - 3); /* 3, 10 and 17 are faint */
	assert_true(result.blocks[0].entry.lights <= 61);
	assert_int_equal(result.blocks[0].entry.channels, 3);
	encoder_destroy(encoder);
	encode(&t, BASIS_KIND_V, 0, &result, &encoder);
	assert_int_equal(result.blocks[0].entry.pixels, 20);
	encoder_destroy(encoder);
	encode(&t, BASIS_KIND_V, 1.5, &result, &encoder); /* nothing is left */
	assert_int_equal(result.count, 0);
	assert_true(result.ratio_error <= 1 && result.ratio_error >= worst_error(&t));
	encoder_destroy(encoder);
	memset(t.value, 0, 20 * 3 * 91 * sizeof(*t.value));
	encode(&t, BASIS_KIND_T, 0, &result, &encoder);
	assert_int_equal(result.count, 0);
	assert_true(result.object_error == 0);
	encoder_destroy(encoder);
	trial_end(&t);
}

/*
 * A cast shadow of some lights, over light thrown back by the object, which v of all lights shows:
 * `bounce` strong, varying by `spread` from light to light and smoothly over the pixels. `colour`
 * is how much of it differs by channel.
 */
static void fill_ground(struct trial *t, int shadowing, double bounce, double spread, double colour,
			struct chance *chance)
{
	for (int i = 0; i < t->lights; i++) {
		const double own = chance_real(chance, -spread, spread);
		const double edge = chance_real(chance, 0, t->pixels);

		for (int p = 0; p < t->pixels; p++) {
			const double there = 1 + 0.5 * p / t->pixels;

			for (int c = 0; c < 3; c++) {
				const double thrown = (-bounce * (1 + colour * (c - 1)) + own) *
						      there;
				const bool shadow = i < shadowing && p < edge;

				t->value[((size_t)p * 3 + (size_t)c) * (size_t)t->lights +
					 (size_t)i] = (float)(shadow ? 1 + thrown : thrown);
			}
		}
	}
}

/* The change of a ratio under a uniform sky: exact, and as decoded. */
static double uniform_error(const struct trial *t)
{
	double worst = 0;

	for (int r = 0; r < t->pixels * 3; r++) {
		const double *u = t->ground + r % 3 * t->lights;
		double error = 0, all = 0;

		for (int i = 0; i < t->lights; i++) {
			const size_t k = (size_t)r * (size_t)t->lights + (size_t)i;

			error += u[i] * ((double)t->value[k] - t->decoded[k]);
			all += u[i];
		}
		worst = fmax(worst, fabs(error) / all);
	}
	return worst;
}

static void a_rest_stands_for_smooth_light(void **state)
{
	static const int counts[] = {64, 91, 406, 2000};
	struct chance chance = chance_begin("rest");
	double use = 0, smallest = 1e9;

	(void)state;
	for (int k = 0; k < 24; k++) {
		const double cut = k % 3 ? 1.0 / 256 : 1.0 / 1024, spread = 0.35 * cut;
		const double colour = k % 2 ? 0 : 0.4;
		const int shadowing = counts[k % 4] / 16;
		struct encode_result result;
		struct encoder *encoder;
		struct trial t;
		const struct basis_block_entry *e;
		size_t all;

		trial_begin(&t, counts[k % 4], k % 4 == 3 ? 40 : 256);
		for (int i = 0; i < 3 * t.lights; i++) /* a coloured ground */
			t.ground[i] = (1 + i / t.lights) * (1 + i % t.lights % 5);
		fill_ground(&t, shadowing, 7 * cut, spread, colour, &chance);
		encode(&t, BASIS_KIND_V, cut, &result, &encoder);
		assert_int_equal(result.count, 1);
		e = &result.blocks[0].entry;
		assert_true(t.rest && (int)e->lights <= shadowing + 1);
		assert_int_equal(e->channels, colour > 0 ? 3 : 1);
		assert_true(worst_error(&t) <= result.ratio_error);
		assert_true(result.ratio_error <= cut + 1.6 / 32767 * 0.6);
		for (int pattern = 0; pattern < 3; pattern++)
			assert_true(lit_error(&t, t.ground, pattern, &chance) <=
				    result.ratio_error * (1 + 1e-12));
		/* Only the listed are off in the mean, by their rounding. */
		assert_true(uniform_error(&t) <= 0.6 * 1.6 / 32767 + 1e-6);
		use = fmax(use, worst_error(&t) / result.ratio_error);
		/* Not one light could be left out without the rest: all of it would be stored. */
		all = basis_layout(BASIS_KIND_V, t.pixels, e->channels, t.lights).bytes;
		if (t.lights >= 406)
			smallest = fmin(smallest, (double)all / (double)e->bytes);
		encoder_destroy(encoder);
		trial_end(&t);
	}
	printf("# a tile with a rest is at least %.1f times smaller; error over declared %.3f\n",
	       smallest, use);
	assert_true(smallest >= 5 && use > 0.9);
}

/* Where most lights are shadowed, the rest is shadow and the lit ones are listed. */
static void a_rest_may_be_shadow(void **state)
{
	struct chance chance = chance_begin("shadow as rest");
	struct encode_result result;
	struct encoder *encoder;
	struct trial t;

	(void)state;
	trial_begin(&t, 406, 100);
	for (int k = 0; k < 100 * 3 * 406; k++)
		t.value[k] = (float)(k % 406 % 20 == 7 ? chance_real(&chance, 0, 0.3)
						       : 1 + chance_real(&chance, -4e-4, 4e-4));
	encode(&t, BASIS_KIND_V, 1e-3, &result, &encoder);
	assert_true(t.rest && result.blocks[0].entry.lights == 21);
	assert_true(worst_error(&t) <= result.ratio_error);
	encoder_destroy(encoder);
	for (int k = 0; k < 100 * 3 * 406; k++) /* and nothing but the rest */
		t.value[k] = 1;
	encode(&t, BASIS_KIND_V, 1e-3, &result, &encoder);
	assert_true(t.rest && result.blocks[0].entry.lights == 1);
	assert_true(worst_error(&t) <= result.ratio_error && result.ratio_error < 1e-4);
	encoder_destroy(encoder);
	encode(&t, BASIS_KIND_T, 1e-3, &result, &encoder); /* never of other kinds */
	assert_true(!t.rest && result.blocks[0].entry.lights == 406);
	encoder_destroy(encoder);
	trial_end(&t);
}

/* Shadows and light of many sizes that fit no rest well: still within what is declared. */
static void odd_rests_keep_their_bound(void **state)
{
	struct chance chance = chance_begin("odd rests");
	int rests = 0;

	(void)state;
	for (int k = 0; k < 60; k++) {
		const double cut = pow(10, chance_real(&chance, -4, -1));
		const int lights = chance_int(&chance, 33, 500);
		struct encode_result result;
		struct encoder *encoder;
		struct trial t;

		trial_begin(&t, lights, chance_int(&chance, 1, 64));
		fill_ground(&t, chance_int(&chance, 0, lights / 2), chance_real(&chance, -4, 4),
			    chance_real(&chance, 0, 1.5) * cut,
			    k % 3 ? chance_real(&chance, 0, 1e-3) : 0, &chance);
		for (int c = 0; c < 3; c++) /* ground that gets nothing of some lights */
			for (int i = 0; i < lights; i++)
				t.ground[c * lights + i] = k % 4 == 0 ? 0
							   : i % 3 == c
								   ? 0
								   : chance_real(&chance, 0, 1);
		encode(&t, BASIS_KIND_V, cut, &result, &encoder);
		rests += t.rest;
		assert_true(worst_error(&t) <= result.ratio_error);
		assert_true(result.ratio_error <= cut * 1.001 + 10.0 / 32767 * 0.6);
		encoder_destroy(encoder);
		trial_end(&t);
	}
	printf("# %d of 60 odd blocks have a rest\n", rests);
	assert_true(rests > 10);
}

static void alike_channels_share_a_row(void **state)
{
	struct chance chance = chance_begin("channels");
	struct encode_result result;
	struct encoder *encoder;
	struct trial t;

	(void)state;
	trial_begin(&t, 26, 10);
	for (int k = 0; k < 10 * 3 * 26; k++) {
		const int p = k / 78, i = k % 26;

		t.value[k] = k % 78 < 26 ? (float)chance_real(&chance, -1, 1) : t.value[p * 78 + i];
	}
	for (int kind = 0; kind < 2; kind++) { /* exactly alike: T too */
		encode(&t, (enum basis_kind)kind, 0, &result, &encoder);
		assert_int_equal(result.blocks[0].entry.channels, 1);
		assert_true(worst_error(&t) <= fmax(result.object_error, result.ratio_error));
		encoder_destroy(encoder);
	}
	for (int k = 0; k < 10 * 3 * 26; k++)
		t.value[k] += (float)chance_real(&chance, -0.01, 0.01);
	encode(&t, BASIS_KIND_V, 0.02, &result, &encoder); /* nearly: V alone */
	assert_int_equal(result.blocks[0].entry.channels, 1);
	assert_true(worst_error(&t) <= result.ratio_error && result.ratio_error < 0.025);
	encoder_destroy(encoder);
	encode(&t, BASIS_KIND_T, 0.02, &result, &encoder);
	assert_int_equal(result.blocks[0].entry.channels, 3);
	encoder_destroy(encoder);
	trial_end(&t);
}

static void hostile_values_are_handled(void **state)
{
	static const float bad[] = {NAN, INFINITY, -INFINITY, FLT_MAX};
	static const float odd[] = {FLT_MIN, 1e-45F, 1e-40F, 3e-34F, 1e-30F, 1e30F};
	const double ground[6] = {1, 1, 1, 1, 1, 1};
	const struct encode_settings settings = {2, 1, ground, 0};
	struct encode_result result;
	struct encoder *encoder;
	struct trial t;
	float value[6];
	const uint16_t pixel = 255;
	struct encode_samples samples = {BASIS_KIND_T, 0, 1, &pixel, value};

	(void)state;
	assert_int_equal(encoder_create(&encoder, &settings), 0);
	for (size_t k = 0; k < sizeof(bad) / sizeof(*bad); k++) {
		for (int at = 0; at < 6; at++) {
			for (int i = 0; i < 6; i++)
				value[i] = i == at ? bad[k] : 1;
			assert_int_equal(encode_tile(encoder, 0, &samples, 1, &result), -EDOM);
		}
	}
	encoder_destroy(encoder);
	encoder_destroy(NULL);
	trial_begin(&t, 2, 1);
	for (size_t k = 0; k < sizeof(odd) / sizeof(*odd); k++) {
		for (int i = 0; i < 6; i++)
			t.value[i] = i == 3 ? -odd[k] : i % 2 ? odd[k] : odd[k] / 3;
		encode(&t, BASIS_KIND_T, 0, &result, &encoder);
		assert_true(worst_error(&t) <= result.object_error);
		encoder_destroy(encoder);
	}
	trial_end(&t);
}

static void d_and_u_stay_together(void **state)
{
	const double ground[18] = {1};
	const struct encode_settings settings = {6, 1, ground, 0.1};
	const uint16_t pixel[2] = {4, 8}, other[2] = {4, 9};
	float d[2][18] = {{0}}, u[2][18] = {{0}};
	struct encode_samples s[2] = {{BASIS_KIND_D, 0, 2, pixel, d[0]},
				      {BASIS_KIND_U, 0, 2, pixel, u[0]}};
	const struct basis_layout at = basis_layout(BASIS_KIND_U, 1, 1, 1);
	struct encode_result r;
	struct encoder *encoder;

	(void)state;
	assert_int_equal(encoder_create(&encoder, &settings), 0);
	u[0][1] = 1;
	assert_int_equal(encode_tile(encoder, 0, s, 2, &r), 0);
	assert_int_equal(r.count, 0); /* nothing is taken anywhere */
	d[1][3] = 1e-6F;	      /* not cut: ratio_cut is of V */
	assert_int_equal(encode_tile(encoder, 0, s, 2, &r), 0);
	assert_int_equal(r.count, 2);
	for (int b = 0; b < 2; b++) {
		assert_int_equal(r.blocks[b].entry.kind, b ? BASIS_KIND_U : BASIS_KIND_D);
		assert_int_equal(r.blocks[b].entry.pixels, 1);
		assert_int_equal(((const uint16_t *)r.blocks[b].payload)[0], 8);
	}
	/* The U of that pixel is dark, and still there. */
	assert_int_equal(r.blocks[1].entry.lights, 1);
	assert_int_equal(((const int16_t *)((const uint8_t *)r.blocks[1].payload + at.row))[0], 0);
	assert_int_equal(encode_tile(encoder, 0, s, 1, &r), -EINVAL);
	assert_int_equal(encode_tile(encoder, 0, s + 1, 1, &r), -EINVAL);
	s[1].pixel = other;
	assert_int_equal(encode_tile(encoder, 0, s, 2, &r), -EINVAL);
	s[1].pixel = pixel;
	u[1][17] = -1;
	assert_int_equal(encode_tile(encoder, 0, s, 2, &r), -EDOM);
	encoder_destroy(encoder);
}

static void totals_are_sums(void **state)
{
	struct chance chance = chance_begin("totals");
	struct trial t;

	(void)state;
	trial_begin(&t, 60, 12);
	for (int kind = 0; kind < 2; kind++) {
		struct encode_result r;
		struct encoder *encoder;
		struct basis_layout at;
		const struct basis_block_entry *e;
		const uint8_t *payload;

		fill(&t, true, 0, &chance);
		encode(&t, (enum basis_kind)kind, 0, &r, &encoder);
		e = &r.blocks[0].entry;
		at = basis_layout(e->kind, e->pixels, e->channels, (int)e->lights);
		payload = r.blocks[0].payload;
		for (int k = 0; k < e->pixels * 3; k++) {
			const int16_t *row = (const int16_t *)(payload + at.row) + k * at.stride;
			const uint16_t *light = (const uint16_t *)(payload + at.light);
			const double *u = t.ground + k % 3 * 60;
			double sum = 0, all = 0;

			for (uint32_t i = 0; i < e->lights; i++)
				sum += row[i] * (kind == BASIS_KIND_V ? u[light[i]] : 1);
			for (int i = 0; kind == BASIS_KIND_V && i < 60; i++)
				all += u[i] / 32768;
			sum /= all > 0 ? all : 1;
			assert_true(fabs(((const int32_t *)(payload + at.total))[k] - sum) < 0.501);
		}
		encoder_destroy(encoder);
	}
	trial_end(&t);
}

static void many_lights_fit(void **state)
{
	struct chance chance = chance_begin("many lights");
	struct encode_result result;
	struct encoder *encoder;
	struct trial t;

	(void)state;
	trial_begin(&t, 20000, 40);
	fill(&t, false, 1e-7, &chance);
	encode(&t, BASIS_KIND_T, 0, &result, &encoder);
	assert_true(result.count == 1 && result.blocks[0].entry.lights > 13000);
	assert_true(worst_error(&t) <= result.object_error);
	encoder_destroy(encoder);
	trial_end(&t);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(declared_errors_hold),
		cmocka_unit_test(cuts_drop_what_they_should),
		cmocka_unit_test(a_rest_stands_for_smooth_light),
		cmocka_unit_test(a_rest_may_be_shadow),
		cmocka_unit_test(odd_rests_keep_their_bound),
		cmocka_unit_test(alike_channels_share_a_row),
		cmocka_unit_test(hostile_values_are_handled),
		cmocka_unit_test(d_and_u_stay_together),
		cmocka_unit_test(totals_are_sums),
		cmocka_unit_test(many_lights_fit),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
