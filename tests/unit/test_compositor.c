/* The compositor: its arithmetic against exact integers, its formula against closed forms. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>

#include "hal/compositor/compositor.h"
#include "hal/compositor/fixed.h"
#include "hal/compositor/kernels.h"
#include "hal/compositor/weights.h"
#include "tests/synthetic_basis.h"

typedef __int128 wide;

/* ---- arithmetic ---- */

static wide exact_round_shift(wide x, int n)
{
	return (x + ((wide)1 << (n - 1))) >> n;
}

static void products_round_like_exact_ones(void **state)
{
	struct chance chance = chance_begin("products");
	const int64_t edge[] = {0,
				1,
				-1,
				INT64_C(1) << 61,
				-(INT64_C(1) << 61),
				(INT64_C(1) << 62) - 1,
				1 - (INT64_C(1) << 62),
				UINT32_MAX};

	(void)state;
	for (int k = 0; k < 2000000; k++) {
		const int64_t a = k % 3 ? (int64_t)chance_bits(&chance) >>
						  chance_int(&chance, 2, 62)
					: edge[chance_int(&chance, 0, 7)];
		const uint32_t m = k % 5 ? (uint32_t)chance_bits(&chance) : UINT32_MAX;
		const int shift = chance_int(&chance, 33, 95);

		assert_true(mul_shift_round(a, m, shift) == exact_round_shift((wide)a * m, shift));
	}
}

static void multipliers_apply_and_saturate(void **state)
{
	struct chance chance = chance_begin("multipliers");

	(void)state;
	for (int k = 0; k < 500000; k++) {
		const float scale = (float)ldexp(chance_real(&chance, 0, 1),
						 chance_int(&chance, -140, 100));
		const double factor = ldexp(chance_real(&chance, 0.5, 1),
					    chance_int(&chance, -60, 60));
		const int64_t a = (int64_t)chance_bits(&chance) >> chance_int(&chance, 2, 62);
		const int32_t limit = 1 << 20;
		const struct multiplier m = multiplier_product(multiplier_from_scale(scale),
							       multiplier_from_double(factor));
		const long double exact = (long double)a * (long double)scale * (long double)factor;
		const long double bound = 0.5L + fabsl(exact) * 0x1p-29L;
		const int32_t got = multiplier_apply(m, a, limit);

		if (exact > limit + bound)
			assert_int_equal(got, limit);
		else if (exact < -limit - bound)
			assert_int_equal(got, -limit);
		else
			assert_true(fabsl(got - exact) <= bound);
	}
	assert_int_equal(multiplier_apply(multiplier_from_double(0), INT64_C(1) << 60, 100), 0);
	assert_int_equal(multiplier_apply(multiplier_product(multiplier_from_scale(0),
							     multiplier_from_double(0x1p119)),
					  INT64_C(1) << 60, 100),
			 0);
}

static void quotients_are_near_exact_ones(void **state)
{
	struct chance chance = chance_begin("quotients");
	const int32_t limit = 1 << 20;

	(void)state;
	for (int k = 0; k < 1000000; k++) {
		const float ns = (float)ldexp(chance_real(&chance, 0.5, 1),
					      chance_int(&chance, -149, 60));
		const float ds = (float)ldexp(chance_real(&chance, 0.5, 1),
					      chance_int(&chance, -145, 60));
		const int64_t n = (int64_t)chance_bits(&chance) >> chance_int(&chance, 1, 62);
		const int64_t d = (int64_t)(chance_bits(&chance) >> chance_int(&chance, 2, 63)) + 1;
		const long double exact = 65536 * ((long double)n * (long double)ns) /
					  ((long double)d * (long double)ds);
		const int32_t got = quotient_q16(n, multiplier_from_scale(ns), d,
						 multiplier_from_scale(ds), limit);
		const long double clamped = exact > limit ? limit : exact < -limit ? -limit : exact;

		assert_true(fabsl(got - clamped) <= 0.5L + fabsl(clamped) * 0x1p-28L);
	}
}

/* ---- weights and kernels ---- */

static struct light_selection selection_of(int count)
{
	struct light_selection s = {.count = count};

	s.radiance = calloc((size_t)count, sizeof(*s.radiance));
	s.used = calloc((size_t)count, sizeof(*s.used));
	assert_true(s.radiance && s.used);
	return s;
}

static int64_t weight_of(const struct weights *w, int light)
{
	int64_t sum = 0;

	for (int d = WEIGHT_DIGITS - 1; d >= 0; d--) {
		assert_in_range(w->digit[d][light] + 2048, 0, 4095);
		sum = sum * 4096 + w->digit[d][light];
	}
	return sum;
}

static void weights_are_rounded_light(void **state)
{
	enum { N = 500 };
	struct chance chance = chance_begin("weights");
	struct light_selection s = selection_of(N);
	struct weights w;

	(void)state;
	assert_int_equal(weights_create(&w, N), 0);
	for (int k = 0; k < 200; k++) {
		const double top = ldexp(1, chance_int(&chance, -40, 120));
		wide sum = 0;
		int bits;

		for (int i = 0; i < N; i++)
			s.radiance[i][0] = k % 4    ? top * chance_real(&chance, 0, 1)
					   : i == k ? top
						    : ldexp(top, -20);
		s.ambient[0] = k % 3 ? top * chance_real(&chance, 0, 1) : 0;
		weights_object(&w, &s, 0, 1);
		/* unit = 65535 * 2^-bits, of which the mantissa tells the exact power */
		bits = (int)lrint(log2(65535) - (log2(w.unit.mantissa) - w.unit.shift));
		assert_true(bits <= 20);
		for (int i = 0; i < N; i++) {
			assert_true(fabs((double)weight_of(&w, i) -
					 ldexp(s.radiance[i][0], bits)) <= 0.5);
			sum += weight_of(&w, i);
		}
		assert_true(w.sum == sum);
		assert_true(sum + (wide)N * w.ambient <= ((wide)1 << 46) + 2 * N);
		if (bits < 20) /* no coarser than need be */
			assert_true(sum + (wide)N * w.ambient >= ((wide)1 << 45) - 2 * N);
	}
	weights_free(&w);
	weights_free(&w);
	light_selection_free(&s);
}

/* What a row must come to: each light times its own value or, where it is not listed, the rest's.
 */
static wide exact_sum(const struct basis_block *b, const int16_t *row, const struct weights *w,
		      int lights)
{
	const int listed = b->lights - b->rest;
	wide sum = 0;
	int next = 0;

	for (int i = 0; i < lights; i++) {
		if (next < listed && b->light[next] == i)
			sum += (wide)row[next++] * weight_of(w, i);
		else if (b->rest)
			sum += (wide)row[listed] * weight_of(w, i);
	}
	return sum;
}

/* A row of the worst values times the worst weights; and random ones. */
static void sums_are_exact(void **state)
{
	enum { N = 100, LISTED = 77, STRIDE = 96, PIXELS = 5 };
	struct chance chance = chance_begin("sums");
	static int16_t row[PIXELS * 3 * STRIDE] __attribute__((aligned(64)));
	uint16_t light[LISTED];
	struct basis_block block = {.kind = BASIS_KIND_T,
				    .pixels = PIXELS,
				    .lights = LISTED,
				    .stride = STRIDE,
				    .light = light,
				    .row = row};
	struct light_selection s = selection_of(N);
	struct weights w[3];
	struct segments segments[3];
	int64_t sum[PIXELS][3];

	(void)state;
	for (int c = 0; c < 3; c++) {
		assert_int_equal(weights_create(&w[c], N), 0);
		assert_int_equal(segments_create(&segments[c], N), 0);
	}
	for (int k = 0; k < 300; k++) {
		block.channels = k % 2 ? 3 : 1;
		/* A rest that shares a run with others, one that has a run alone, and none. */
		block.lights = k % 3 == 1 ? 65 : LISTED;
		block.rest = k % 3 < 2;
		for (int i = 0; i < LISTED; i++)
			light[i] = (uint16_t)(block.rest && i == block.lights - 1
						      ? N
						      : i + (i > 40 ? 13 : 0));
		for (int r = 0; r < PIXELS * 3; r++) {
			for (int i = 0; i < STRIDE; i++)
				row[r * STRIDE + i] =
					i >= block.lights
						? 0
						: (int16_t)(k % 5 == 0 ? 32767
							    : k % 5 == 1
								    ? -32767
								    : chance_int(&chance, -32767,
										 32767));
		}
		for (int c = 0; c < 3; c++) {
			for (int i = 0; i < N; i++)
				s.radiance[i][c] =
					k % 7 == 0   ? ldexp(1, 60) /* digits of 2^39 and 2^40 */
					: k % 7 == 1 ? ldexp(2048.0 * (1 + 4096), -20)
					: k % 7 == 2 ? (i == 5 + c) * 1e9
						     : ldexp(chance_real(&chance, 0, 1),
							     chance_int(&chance, -30, 30));
			weights_receiver(&w[c], &s, c);
			segments_gather(&segments[c], &w[c], &block);
		}
		kernel_sums_c(&block, segments, sum);
		for (int p = 0; p < PIXELS; p++) {
			for (int c = 0; c < 3; c++) {
				const int r = block.channels == 3 ? p * 3 + c : p;
				const wide exact = exact_sum(&block, row + r * STRIDE, &w[c], N);

				assert_true(sum[p][c] == exact);
				assert_true(exact < (wide)1 << 62 && exact > -((wide)1 << 62));
			}
		}
	}
	for (int c = 0; c < 3; c++) {
		weights_free(&w[c]);
		segments_free(&segments[c]);
	}
	light_selection_free(&s);
}

/* ---- selection ---- */

static const struct synthetic_options plain = {
	.width = 40,
	.height = 23,
	.lights = 26,
	.grounds = 2,
	.receiver_lights = 11,
	.object_share = 0.4,
	.ground_share = 0.3,
	.stand_in_share = 0.2,
	.peak = 1,
	.bounce = 0.3,
	.seed = 11,
};

static void selection_keeps_what_reaches_the_threshold(void **state)
{
	struct synthetic *s = *state;
	struct light_selection sel;
	float radiance[26][3] = {{0}};
	double power = 0;

	for (int i = 0; i < 26; i++)
		radiance[i][i % 3] = (float)i;
	radiance[25][0] = NAN;
	radiance[25][1] = -1; /* and [1] was 25 */
	radiance[24][0] = INFINITY;
	assert_int_equal(light_selection_create(&sel, &s->basis), 0);
	light_selection_choose(&sel, &s->basis, 0, (const float(*)[3])radiance, 10,
			       THRESHOLD_AMBIENT, 2);
	assert_int_equal(sel.used_count, 14); /* 10 to 23 */
	for (int i = 0; i < 26; i++) {
		assert_int_equal(sel.used[i], i >= 10 && i < 24);
		for (int c = 0; c < 3; c++)
			assert_true(sel.radiance[i][c] ==
				    (sel.used[i] && i % 3 == c ? (double)i : 0));
	}
	for (int i = 0; i < 10; i += 3)
		power += i * s->basis.lights[i].solid_angle_sr;
	assert_true(fabs(sel.ambient[0] - power / (2 * M_PI)) < 1e-12);
	light_selection_choose(&sel, &s->basis, 0, (const float(*)[3])radiance, 0, THRESHOLD_DROP,
			       2);
	assert_int_equal(sel.used_count, 26);
	assert_true(sel.ambient[0] == 0 && sel.dropped_error[0] == 0);
	light_selection_free(&sel);
	light_selection_free(&sel);
}

/* The promise about dropped light, held against every row of a file. */
static void dropped_light_errs_no_more_than_said(void **state)
{
	struct chance chance = chance_begin("dropped light");
	struct synthetic *s = *state;
	const struct basis_pose *pose = &s->basis.poses[0];
	struct light_selection sel;
	/* Peaks are of the transport before it was quantised. */
	const double rounding = 26 * s->basis.info.object_error;
	double closest = 0;

	assert_int_equal(light_selection_create(&sel, &s->basis), 0);
	for (int k = 0; k < 40; k++) {
		const double gain = chance_real(&chance, 0, 3);
		float radiance[26][3];

		for (int i = 0; i < 26; i++)
			for (int c = 0; c < 3; c++)
				radiance[i][c] = (float)chance_real(&chance, 0, 1);
		light_selection_choose(&sel, &s->basis, 0, (const float(*)[3])radiance,
				       chance_real(&chance, 0, 1.2),
				       (enum threshold_mode)(k % THRESHOLD_MODE_COUNT), gain);
		for (int n = 0; n < pose->block_count; n++) {
			const struct basis_block *b = &pose->blocks[n];

			for (int r = 0; b->kind == BASIS_KIND_T && r < b->pixels * 3; r++) {
				const int c = r % 3;
				double off = 0;

				for (int i = 0; i < b->lights; i++) {
					const int l = b->light[i];

					off += (double)b->scale[r] * b->row[r * b->stride + i] *
					       (sel.radiance[l][c] + sel.ambient[c] -
						(double)radiance[l][c]);
				}
				off = fabs(off) * gain;
				assert_true(off <= sel.dropped_error[c] + gain * 2 * rounding);
				closest = fmax(closest, off / (sel.dropped_error[c] + 1e-30));
			}
		}
	}
	assert_true(closest > 0.2); /* and is not said much too large */
	light_selection_free(&sel);
}

/* ---- one pixel, where the answer is known ---- */

struct one {
	struct basis basis;
	struct basis_pose pose;
	struct basis_tile tile;
	struct basis_block block[3];
	struct basis_light light[2];
	double ground[3][2];
	uint16_t coverage;
	float peak[3][3];
	int16_t row[3][32] __attribute__((aligned(64)));
	float scale[3];
	int32_t total[3][3];
	uint16_t lists[2], with_rest[2];
};

static void one_begin(struct one *o)
{
	memset(o, 0, sizeof(*o));
	o->lists[1] = 1;
	o->with_rest[0] = 1;
	o->with_rest[1] = 2;
	for (int i = 0; i < 2; i++) {
		o->light[i] = (struct basis_light){{0, 0, 1}, M_PI};
		for (int c = 0; c < 3; c++)
			o->ground[c][i] = i ? 3 : 1;
	}
	o->tile = (struct basis_tile){0, 0, 1, 1, o->block, 0, 0};
	o->pose = (struct basis_pose){&o->coverage, (const float(*)[3])o->peak, &o->tile, o->block,
				      0};
	o->basis = (struct basis){
		.info = {.width = 1, .height = 1, .lights = 2, .grounds = 1, .poses = 1},
		.lights = o->light,
		.ground = &o->ground[0][0],
		.tiles_across = 1,
		.tiles_down = 1,
		.poses = &o->pose};
}

/* A block of one pixel, one row for all channels, and two values. */
static void one_add(struct one *o, enum basis_kind kind, double first, double second)
{
	const int n = o->tile.block_count++;
	const double most = fmax(fabs(first), fabs(second));

	o->pose.block_count++;
	o->scale[n] = (float)(most / 32767);
	o->row[n][0] = (int16_t)lrint(most > 0 ? first / most * 32767 : 0);
	o->row[n][1] = (int16_t)lrint(most > 0 ? second / most * 32767 : 0);
	for (int c = 0; c < 3; c++)
		o->total[n][c] = kind == BASIS_KIND_V ? (int32_t)lrint(8192.0 * (o->row[n][0] +
										 3 * o->row[n][1]))
						      : o->row[n][0] + o->row[n][1];
	o->block[n] = (struct basis_block){.kind = kind,
					   .encoding = BASIS_ENCODING_DENSE,
					   .pixels = 1,
					   .channels = 1,
					   .lights = 2,
					   .stride = 32,
					   .pixel = o->lists,
					   .light = o->lists,
					   .scale = &o->scale[n],
					   .total = o->total[n],
					   .row = o->row[n]};
}

/* A V block that lists light 1 (when `listed`), and the rest. */
static void one_add_rest(struct one *o, bool listed, double second, double rest)
{
	const int n = o->tile.block_count;
	struct basis_block *b = &o->block[n];
	int32_t total;

	if (listed)
		one_add(o, BASIS_KIND_V, second, rest);
	else
		one_add(o, BASIS_KIND_V, rest, 0);
	b->rest = true;
	b->lights = 1 + listed;
	b->light = o->with_rest + !listed;
	/* Light 0, not listed, has u = 1 of 4. */
	total = listed ? 8192 * (3 * o->row[n][0] + o->row[n][1]) : 32768 * o->row[n][0];
	for (int c = 0; c < 3; c++)
		o->total[n][c] = total;
}

/* Both compositors on one pixel of background 128: linear out, in 0..1. */
static void one_expect(struct one *o, double first, double second, double ambient, double gain,
		       double expected)
{
	const struct compositor_settings settings = {TRANSFER_LINEAR, TRANSFER_LINEAR, gain, true};
	const uint8_t background[4] = {128, 128, 128, 0};
	const struct picture picture = {background, 4, 4, 1, 1};
	struct light_selection sel = selection_of(2);
	struct compositor *compositor;
	uint8_t out[4];
	double exact[3];

	for (int c = 0; c < 3; c++) {
		sel.radiance[0][c] = first;
		sel.radiance[1][c] = second;
		sel.ambient[c] = ambient;
	}
	assert_int_equal(compositor_create(&compositor, &o->basis, NULL, NULL), 0);
	compositor_set(compositor, &settings);
	assert_int_equal(compositor_run(compositor, 0, &sel, &picture, out, 4), 0);
	assert_int_equal(compositor_reference(&o->basis, 0, &settings, &sel, &picture, exact), 0);
	for (int c = 0; c < 3; c++) {
		assert_true(fabs(exact[c] / 255 - expected) < 2e-4);
		assert_true(fabs(out[c] / 255.0 - expected) < 0.6 / 255);
	}
	assert_int_equal(out[3], 255);
	compositor_destroy(compositor);
	light_selection_free(&sel);
}

static void formula_gives_the_closed_forms(void **state)
{
	const double b = 128 / 255.0;
	struct one o;

	(void)state;
	one_begin(&o); /* nothing there: the background */
	one_expect(&o, 1, 1, 0, 1, b);

	one_begin(&o); /* an opaque object: 0.25 * 1 + 0.5 * 0.5, twice */
	o.coverage = 65535;
	one_add(&o, BASIS_KIND_T, 0.25, 0.5);
	one_expect(&o, 1, 0.5, 0, 1, 0.5);
	one_expect(&o, 0.5, 0.25, 0, 2, 0.5);
	one_expect(&o, 0, 0, 0.4, 1, 0.3); /* ambient over both */
	one_expect(&o, 0.5, 0, 0.4, 1, 0.425);
	one_expect(&o, 0, 0, 0, 1, 0);
	one_expect(&o, 9, 9, 0, 1, 1); /* clipped */
	one_expect(&o, 1, 1, 0, 0, 0); /* no gain, no object */

	one_begin(&o); /* half covered by an object that gives off nothing */
	o.coverage = 32768;
	one_expect(&o, 1, 1, 0, 1, b / 2);

	one_begin(&o); /* half covered, in shadow: 0.1 + 0.5 * 0.25 * b */
	o.coverage = 32768;
	one_add(&o, BASIS_KIND_T, 0.1, 0);
	one_add(&o, BASIS_KIND_V, 0, 1);
	one_expect(&o, 1, 1, 0, 1, 0.1 + 0.5 * 0.25 * b);

	one_begin(&o); /* light 1 (u = 3, of 4) is shadowed */
	one_add(&o, BASIS_KIND_V, 0, 1);
	one_expect(&o, 1, 1, 0, 1, 0.25 * b);
	one_expect(&o, 1, 0, 0, 1, b);
	one_expect(&o, 0, 1, 0, 1, 0);
	one_expect(&o, 3, 1, 0, 1, 0.5 * b);
	one_expect(&o, 0, 0, 0.5, 1, 0.25 * b);
	one_expect(&o, 2, 0, 1, 1, 0.5 * b); /* (3 * 1) / (1 * 3 + 3 * 1) is taken */
	one_expect(&o, 1e6, 1e6, 0, 1, 0.25 * b);
	one_expect(&o, 0, 0, 0, 1, b);			   /* 0/0 */
	one_expect(&o, 0, 0x1p-20 * 4 / 3, 0, 1, 0.5 * b); /* as much as e */

	one_begin(&o); /* light 1 is shadowed, the other adds half: u = 1 and 3 */
	one_add_rest(&o, true, 1, -0.5);
	one_expect(&o, 1, 1, 0, 1, (1 - 0.75 + 0.125) * b);
	one_expect(&o, 1, 0, 0, 1, 1.5 * b);
	one_expect(&o, 0, 1, 0, 1, 0);
	one_expect(&o, 3, 1, 0, 1, 0.75 * b);
	one_expect(&o, 0, 0, 0.5, 1, 0.375 * b);
	one_expect(&o, 2, 0, 1, 1, (1 - 0.5 + 0.25) * b);
	one_expect(&o, 1e6, 1e6, 0, 1, 0.375 * b);
	one_expect(&o, 0, 0, 0, 1, b);

	one_begin(&o); /* one number whatever the light, down to e */
	one_add_rest(&o, false, 0, 0.25);
	one_expect(&o, 1, 1, 0, 1, 0.75 * b);
	one_expect(&o, 1, 0, 0, 1, 0.75 * b);
	one_expect(&o, 0, 7, 0, 1, 0.75 * b);
	one_expect(&o, 0, 0, 0.3, 1, 0.75 * b);
	one_expect(&o, 1, 5, 0.3, 1, 0.75 * b);
	one_expect(&o, 0, 0, 0, 1, b);
	one_expect(&o, 0, 0x1p-20 * 4 / 3, 0, 1, 0.875 * b);

	one_begin(&o); /* light that the object adds */
	one_add(&o, BASIS_KIND_V, -0.5, -0.5);
	one_expect(&o, 1, 1, 0, 1, 1.5 * b);

	one_begin(&o); /* no more than 16 times: 1 code becomes 16 */
	one_add(&o, BASIS_KIND_V, -500, -500);
	one_expect(&o, 1, 1, 0, 1, 1);

	one_begin(&o); /* a receiver of its own: u = 1, 3 and d = 0, 3 */
	one_add(&o, BASIS_KIND_D, 0, 3);
	one_add(&o, BASIS_KIND_U, 1, 3);
	one_expect(&o, 1, 1, 0, 1, 0.25 * b);
	one_expect(&o, 1, 0, 0, 1, b);
	one_expect(&o, 0, 0, 0.5, 1, 0.25 * b);
	one_expect(&o, 1e6, 1e6, 0, 1, 0.25 * b);
	one_expect(&o, 0, 0, 0, 1, b);
	one_expect(&o, 0, 0x1p-20 * 4 / 3, 0, 1, 0.5 * b);

	one_begin(&o); /* a receiver that no light reaches: unchanged, whatever d says */
	one_add(&o, BASIS_KIND_D, 1, 3);
	one_add(&o, BASIS_KIND_U, 0, 0);
	one_expect(&o, 1, 1, 0, 1, b);
	one_expect(&o, 0, 0, 0, 1, b);
}

/* k times the light: k times the object, and the same shadow. */
static void brighter_light_scales_the_object_alone(void **state)
{
	const double b = 128 / 255.0;
	struct one object, shadow;

	(void)state;
	one_begin(&object);
	object.coverage = 65535;
	one_add(&object, BASIS_KIND_T, 0.25, 0.5);
	one_begin(&shadow);
	one_add(&shadow, BASIS_KIND_V, 0, 1);
	for (double k = 1.0 / 4096; k <= 2; k *= 1.37) {
		one_expect(&object, k, k / 2, 0, 1, k / 2);
		one_expect(&object, k / 2, k / 4, k / 3, 1, k / 2);
		if (k > 0.05) /* the residue e shows in less light */
			one_expect(&shadow, k, k, 0, 1, 0.25 * b);
		one_expect(&shadow, 1e5 * k, 3e5 * k, 0, 1, 0.1 * b);
	}
}

/* ---- pictures ---- */

struct frame_of {
	struct light_selection lights;
	struct compositor *compositor;
	struct picture picture;
	uint8_t *background, *out;
	size_t stride, bytes;
};

static void frame_begin(struct frame_of *f, const struct basis *basis, struct pool *pool,
			struct chance *chance)
{
	const int w = (int)basis->info.width, h = (int)basis->info.height;
	float(*radiance)[3] = calloc(basis->info.lights, sizeof(*radiance));

	f->stride = (size_t)w * 4 + 4; /* one pixel more, which must stay as it is */
	f->bytes = f->stride * (size_t)h;
	f->background = malloc(f->bytes);
	f->out = malloc(f->bytes);
	assert_true(radiance && f->background && f->out);
	for (size_t i = 0; i < f->bytes; i++)
		f->background[i] = (uint8_t)chance_bits(chance);
	memset(f->out, 0x5a, f->bytes);
	for (uint32_t i = 0; i < basis->info.lights; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)chance_real(chance, 0, 1);
	f->picture = (struct picture){f->background, 4, (ptrdiff_t)f->stride, w, h};
	assert_int_equal(light_selection_create(&f->lights, basis), 0);
	light_selection_choose(&f->lights, basis, 0, (const float(*)[3])radiance, 0.3,
			       THRESHOLD_AMBIENT, 1);
	assert_int_equal(compositor_create(&f->compositor, basis, pool, NULL), 0);
	free(radiance);
}

static void frame_end(struct frame_of *f)
{
	compositor_destroy(f->compositor);
	light_selection_free(&f->lights);
	free(f->background);
	free(f->out);
}

static void background_alone_is_copied(void **state)
{
	struct chance chance = chance_begin("background");
	struct synthetic *s = *state;
	struct transfer_tables from, to;
	struct frame_of f;

	frame_begin(&f, &s->basis, NULL, &chance);
	for (int pair = 0; pair < TRANSFER_COUNT * TRANSFER_COUNT; pair++) {
		const struct compositor_settings settings = {(enum transfer)(pair / TRANSFER_COUNT),
							     (enum transfer)(pair % TRANSFER_COUNT),
							     1, false};

		transfer_tables_fill(&from, settings.background);
		transfer_tables_fill(&to, settings.output);
		compositor_set(f.compositor, &settings);
		assert_int_equal(
			compositor_run(f.compositor, 0, &f.lights, &f.picture, f.out, f.stride), 0);
		for (size_t i = 0; i < f.bytes; i++) {
			const uint8_t in = f.background[i];

			if (i % f.stride >= f.stride - 4)
				assert_int_equal(f.out[i], 0x5a);
			else if (i % f.stride % 4 == 3)
				assert_int_equal(f.out[i], 255);
			else if (settings.background == settings.output)
				assert_int_equal(f.out[i], in);
			else
				assert_int_equal(f.out[i], to.encode[from.decode[in]]);
		}
	}
	frame_end(&f);
}

static void untouched_pixels_are_copied(void **state)
{
	struct chance chance = chance_begin("untouched");
	struct synthetic *s = *state;
	const struct basis_pose *pose = &s->basis.poses[0];
	bool touched[23][40] = {{false}};
	struct frame_of f;
	int copies = 0;

	for (int y = 0; y < 23; y++)
		for (int x = 0; x < 40; x++)
			touched[y][x] = pose->coverage[y * 40 + x] != 0;
	for (int t = 0; t < 6; t++) {
		const struct basis_tile *tile = &pose->tiles[t];

		for (int n = 0; n < tile->block_count; n++)
			for (int p = 0; p < tile->blocks[n].pixels; p++)
				touched[tile->y + tile->blocks[n].pixel[p] / BASIS_TILE]
				       [tile->x + tile->blocks[n].pixel[p] % BASIS_TILE] = true;
	}
	frame_begin(&f, &s->basis, NULL, &chance);
	assert_int_equal(compositor_run(f.compositor, 0, &f.lights, &f.picture, f.out, f.stride),
			 0);
	for (size_t y = 0; y < 23; y++) {
		for (size_t x = 0; x < 40; x++) {
			if (touched[y][x])
				continue;
			assert_memory_equal(f.out + y * f.stride + x * 4,
					    f.background + y * f.stride + x * 4, 3);
			copies++;
		}
		assert_int_equal(f.out[y * f.stride + 160], 0x5a);
	}
	assert_true(copies > 50 && copies < 800);
	frame_end(&f);
}

static void flips_are_only_reading_order(void **state)
{
	struct chance chance = chance_begin("flips");
	struct synthetic *s = *state;
	struct frame_of f;
	uint8_t *flipped, *expected;

	frame_begin(&f, &s->basis, NULL, &chance);
	flipped = malloc(f.bytes);
	expected = malloc(f.bytes);
	assert_true(flipped && expected);
	for (int flip = 0; flip < 8; flip++) {
		const bool h = flip & 1, v = flip & 2;
		const struct compositor_settings settings = {TRANSFER_SRGB, TRANSFER_SRGB, 1,
							     !(flip & 4)};
		const struct picture picture = {
			f.background + (h ? 39 * 4 : 0) + (v ? 22 * f.stride : 0), h ? -4 : 4,
			v ? -(ptrdiff_t)f.stride : (ptrdiff_t)f.stride, 40, 23};
		const struct picture upright = {flipped, 4, (ptrdiff_t)f.stride, 40, 23};

		for (size_t y = 0; y < 23; y++)
			for (size_t x = 0; x < 40; x++)
				memcpy(flipped + y * f.stride + x * 4,
				       f.background + (v ? 22 - y : y) * f.stride +
					       (h ? 39 - x : x) * 4,
				       4);
		compositor_set(f.compositor, &settings);
		memset(expected, 0x5a, f.bytes);
		assert_int_equal(
			compositor_run(f.compositor, 0, &f.lights, &upright, expected, f.stride),
			0);
		assert_int_equal(
			compositor_run(f.compositor, 0, &f.lights, &picture, f.out, f.stride), 0);
		assert_memory_equal(f.out, expected, f.bytes);
	}
	free(flipped);
	free(expected);
	frame_end(&f);
}

/* A file without D blocks needs no weights for them. */
static void a_file_without_receivers_is_composited(void **state)
{
	struct synthetic_options o = plain;
	struct chance chance = {5};
	struct synthetic s;
	struct frame_of f;
	double *exact;

	(void)state;
	o.stand_in_share = 0;
	synthetic_open(&s, &o);
	frame_begin(&f, &s.basis, NULL, &chance);
	exact = malloc(sizeof(*exact) * 3 * 40 * 23);
	assert_non_null(exact);
	assert_int_equal(compositor_run(f.compositor, 0, &f.lights, &f.picture, f.out, f.stride),
			 0);
	assert_int_equal(compositor_reference(&s.basis, 0,
					      &(struct compositor_settings){TRANSFER_SRGB,
									    TRANSFER_SRGB, 1, true},
					      &f.lights, &f.picture, exact),
			 0);
	for (int i = 0; i < 40 * 23 * 3; i++)
		assert_true(fabs(f.out[(size_t)(i / 120) * f.stride + (size_t)(i / 3 % 40) * 4 + 2 -
				       (size_t)(i % 3)] -
				 exact[i]) < 1);
	free(exact);
	frame_end(&f);
	synthetic_close(&s);
}

static void threads_do_not_change_a_byte(void **state)
{
	struct synthetic *s = *state;
	uint8_t *alone = NULL;

	for (int threads = 0; threads <= 4; threads++) {
		struct chance chance = {5};
		struct pool *pool = NULL;
		struct frame_of f;

		if (threads)
			assert_int_equal(pool_create(&pool, threads), 0);
		frame_begin(&f, &s->basis, pool, &chance);
		assert_int_equal(
			compositor_run(f.compositor, 0, &f.lights, &f.picture, f.out, f.stride), 0);
		if (!alone) {
			alone = malloc(f.bytes);
			assert_non_null(alone);
			memcpy(alone, f.out, f.bytes);
		}
		assert_memory_equal(f.out, alone, f.bytes);
		frame_end(&f);
		pool_destroy(pool);
	}
	free(alone);
}

static void wrong_sizes_are_refused(void **state)
{
	const struct compositor_settings settings = {TRANSFER_SRGB, TRANSFER_SRGB, 1, true};
	struct chance chance = {5};
	struct synthetic *s = *state;
	struct picture wrong;
	struct frame_of f;
	double exact;

	frame_begin(&f, &s->basis, NULL, &chance);
	wrong = f.picture;
	wrong.width--;
	assert_int_equal(compositor_run(f.compositor, 0, &f.lights, &wrong, f.out, f.stride),
			 -EINVAL);
	assert_int_equal(compositor_reference(&s->basis, 0, &settings, &f.lights, &wrong, &exact),
			 -EINVAL);
	assert_int_equal(compositor_run(f.compositor, 1, &f.lights, &f.picture, f.out, f.stride),
			 -EINVAL);
	assert_int_equal(compositor_run(f.compositor, -1, &f.lights, &f.picture, f.out, f.stride),
			 -EINVAL);
	assert_int_equal(compositor_run(f.compositor, 0, &f.lights, &f.picture, f.out, 159),
			 -EINVAL);
	f.lights.count--;
	assert_int_equal(compositor_run(f.compositor, 0, &f.lights, &f.picture, f.out, f.stride),
			 -EINVAL);
	assert_int_equal(f.out[0], 0x5a);
	frame_end(&f);
	compositor_destroy(NULL);
}

static int setup(void **state)
{
	struct synthetic *s = calloc(1, sizeof(*s));

	assert_non_null(s);
	synthetic_open(s, &plain);
	*state = s;
	return 0;
}

static int teardown(void **state)
{
	synthetic_close(*state);
	free(*state);
	return 0;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(products_round_like_exact_ones),
		cmocka_unit_test(multipliers_apply_and_saturate),
		cmocka_unit_test(quotients_are_near_exact_ones),
		cmocka_unit_test(weights_are_rounded_light),
		cmocka_unit_test(sums_are_exact),
		cmocka_unit_test(selection_keeps_what_reaches_the_threshold),
		cmocka_unit_test(dropped_light_errs_no_more_than_said),
		cmocka_unit_test(formula_gives_the_closed_forms),
		cmocka_unit_test(brighter_light_scales_the_object_alone),
		cmocka_unit_test(background_alone_is_copied),
		cmocka_unit_test(untouched_pixels_are_copied),
		cmocka_unit_test(flips_are_only_reading_order),
		cmocka_unit_test(a_file_without_receivers_is_composited),
		cmocka_unit_test(threads_do_not_change_a_byte),
		cmocka_unit_test(wrong_sizes_are_refused),
	};

	return cmocka_run_group_tests(tests, setup, teardown);
}
