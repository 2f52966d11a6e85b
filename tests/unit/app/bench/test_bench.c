/* SPDX-License-Identifier: MIT */
/* What bench and reports compare frames with: transport light by light, the thesis's algorithm,
 * errors, lightings. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/image/image.h"
#include "hal/measure/measure.h"
#include "hal/measure/thesis.h"
#include "tests/support/basis/synthetic_basis.h"
#include "tests/support/chance.h"
#include "tests/support/test.h"

static struct synthetic_options every_encoding(struct chance *chance)
{
	return (struct synthetic_options){
		.width = 37,
		.height = 21,
		.lights = 45,
		.grounds = 2,
		.coarse = chance_int(chance, 0, 1) ? 12 : 0,
		.patterns = 5,
		.columns = 20,
		.layers = 3,
		.tinted = true,
		.vary = true,
		.object_share = 0.5,
		.ground_share = 0.5,
		.stand_in_share = 0.3,
		.peak = 0.9,
		.bounce = 0.3,
		.seed = chance_bits(chance),
	};
}

/* ---- transport ---- */

static double unit_of(const struct basis *basis, const struct basis_block *b, int c, int i)
{
	return b->kind == BASIS_KIND_V ? basis_ground(basis, b->ground, c)[i]
				       : basis->lights[i].solid_angle_sr;
}

static double transport_at(const struct unpacked *t, enum basis_kind kind, int p, int c, int i)
{
	const size_t row = (size_t)c * (size_t)t->lights + (size_t)i;

	return (double)(kind == BASIS_KIND_T   ? t->object[row][p]
			: kind == BASIS_KIND_U ? t->unlit[row][p]
					       : t->taken[row][p]);
}

/* Subtracts a tile's blocks from the transport, which must leave nothing. */
static void check_tile(const struct basis *basis, const struct basis_tile *tile, struct unpacked *t)
{
	const int n = (int)basis->info.lights;
	double *is = calloc((size_t)UNPACKED_PIXELS * 3 * (size_t)n, sizeof(*is) * 3);
	double *value = calloc((size_t)UNPACKED_PIXELS * 3 * (size_t)n, sizeof(*value));

	assert_true(is && value);
	unpacked_fill(t, basis, tile);
	for (int k = 0; k < tile->block_count; k++) {
		const struct basis_block *b = &tile->blocks[k];
		const int part = b->kind == BASIS_KIND_T ? 0 : b->kind == BASIS_KIND_U ? 1 : 2;

		memset(value, 0, (size_t)UNPACKED_PIXELS * 3 * (size_t)n * sizeof(*value));
		synthetic_add_values(b, n, basis->coarse, value);
		for (int at = 0; at < b->pixels * 3 * n; at++) {
			const int i = at % n, c = at / n % 3, p = b->pixel[at / n / 3];
			const double unit = unit_of(basis, b, c, i);

			is[((part * UNPACKED_PIXELS + p) * 3 + c) * n + i] += value[at] * unit;
			if (b->kind == BASIS_KIND_V)
				is[((1 * UNPACKED_PIXELS + p) * 3 + c) * n + i] = unit;
		}
	}
	for (int part = 0; part < 3; part++) {
		static const enum basis_kind kinds[3] = {BASIS_KIND_T, BASIS_KIND_U, BASIS_KIND_D};

		for (int at = 0; at < UNPACKED_PIXELS * 3 * n; at++) {
			const double want = is[part * UNPACKED_PIXELS * 3 * n + at];
			const double got = transport_at(t, kinds[part], at / n / 3, at / n % 3,
							at % n);

			assert_true(fabs(want - got) < 1e-5);
		}
	}
	free(value);
	free(is);
}

TEST("transport is what blocks say")
{
	struct chance chance = chance_begin("transport");

	for (int round = 0; round < 4; round++) {
		const struct synthetic_options options = every_encoding(&chance);
		struct synthetic s;
		struct unpacked t;

		synthetic_open(&s, &options);
		assert_int_equal(unpacked_create(&t, &s.basis), 0);
		for (int k = 0; k < s.basis.tiles_across * s.basis.tiles_down; k++)
			check_tile(&s.basis, &s.basis.poses[0].shown.tiles[k], &t);
		unpacked_free(&t);
		synthetic_close(&s);
	}
}

/* ---- the thesis ---- */

struct bench_scene {
	struct basis *basis;
	struct light_selection lights;
	struct canvas background, out;
};

static void bench_scene_open(struct bench_scene *f, struct basis *basis, struct chance *chance,
			     double dark)
{
	float(*radiance)[3] = calloc(basis->info.lights, sizeof(*radiance));

	assert_non_null(radiance);
	f->basis = basis;
	for (uint32_t i = 0; i < basis->info.lights; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)chance_real(chance, 0, 1);
	assert_int_equal(light_selection_create(&f->lights, basis), 0);
	light_selection_choose(&f->lights, basis, 0, (const float(*)[3])radiance, dark,
			       THRESHOLD_DROP, 1);
	assert_int_equal(
		canvas_create(&f->background, (int)basis->info.width, (int)basis->info.height), 0);
	assert_int_equal(canvas_create(&f->out, (int)basis->info.width, (int)basis->info.height),
			 0);
	background_fill(&f->background);
	free(radiance);
}

static void bench_scene_close(struct bench_scene *f)
{
	light_selection_free(&f->lights);
	canvas_free(&f->background);
	canvas_free(&f->out);
}

static double code_value(const struct canvas *canvas, int x, int y, int c)
{
	return canvas->pixels[(size_t)y * canvas->stride + (size_t)x * 4 + 2 - (size_t)c];
}

/* A pixel in double precision: each stored byte is right to half a step, so that a sum is right to
 * half a step of all light. */
static void check_pixel(const struct bench_scene *f, const struct unpacked *t, int x, int y, int p,
			double step)
{
	const uint16_t a = f->basis->poses[0].coverage[y * (int)f->basis->info.width + x];

	for (int c = 0; c < 3; c++) {
		const double is = code_value(&f->out, x, y, c);
		const double behind = code_value(&f->background, x, y, c);
		double object = 0, unlit = 0, taken = 0, light = 0, most = 0, want, slack;

		for (int i = 0; i < t->lights; i++) {
			const double l = f->lights.radiance[i][c];

			object += transport_at(t, BASIS_KIND_T, p, c, i) * l;
			unlit += transport_at(t, BASIS_KIND_U, p, c, i) * l;
			taken += transport_at(t, BASIS_KIND_D, p, c, i) * l;
			light += l;
			for (int other = 0; other < 3; other++) {
				const double u = transport_at(t, BASIS_KIND_U, p, other, i);
				const double d = transport_at(t, BASIS_KIND_D, p, other, i);

				most = fmax(most, fmax(u, u - d));
			}
		}
		if (a > 32767) {
			want = 255 * object;
			slack = 0.51 + 0.5 * step * light;
		} else if (t->is_receiver[p] && unlit > 0) {
			const double half = 0.5 * most / 255 * light;

			/* clipped to 0..255 */
			want = behind * fmax(unlit - taken, 0) / unlit;
			slack = 1.01 + behind * half * (1 + fabs(unlit - taken) / unlit) /
					       fmax(unlit - half, 1e-9);
		} else {
			want = t->is_receiver[p] ? 0 : behind;
			slack = 0;
		}
		assert_true(fabs(is - fmin(want, 255)) <= slack);
	}
}

static void check_frame(const struct bench_scene *f, double step)
{
	const struct basis *basis = f->basis;
	struct unpacked t;

	assert_int_equal(unpacked_create(&t, basis), 0);
	for (int k = 0; k < basis->tiles_across * basis->tiles_down; k++) {
		const struct basis_tile *tile = &basis->poses[0].shown.tiles[k];

		unpacked_fill(&t, basis, tile);
		for (int y = 0; y < tile->height; y++)
			for (int x = 0; x < tile->width; x++)
				check_pixel(f, &t, tile->x + x, tile->y + y, y * BASIS_TILE + x,
					    step);
	}
	unpacked_free(&t);
}

static double brightest(const struct basis *basis)
{
	double most = 0;

	for (uint32_t i = 0; i < 3 * basis->info.lights; i++)
		most = fmax(most, (double)basis->poses[0].peak[i / 3][i % 3]);
	return most;
}

TEST("thesis composites")
{
	struct chance chance = chance_begin("thesis");

	for (int threads = 1; threads < 4; threads++) {
		struct synthetic_options options = every_encoding(&chance);
		struct fault fault = {""};
		struct synthetic s;
		struct thesis *thesis;
		struct pool *pool;
		struct bench_scene f;

		/* plain bytes: no light counts twice, and none appears from nowhere */
		options.vary = options.tinted = false;
		options.layers = 1;
		options.patterns = 0;
		options.columns = -1;
		synthetic_open(&s, &options);
		assert_int_equal(pool_create(&pool, threads), 0);
		assert_int_equal(
			thesis_create(&thesis, &s.basis, &s.basis.poses[0].shown, pool, &fault), 0);
		bench_scene_open(&f, &s.basis, &chance, threads == 2 ? 0.4 : 0);
		thesis_light(thesis, &f.lights);
		thesis_run(thesis, &f.background, &f.out, pool);
		check_frame(&f, brightest(&s.basis));
		assert_true(thesis_bytes(thesis, 10) == 10 * thesis_bytes(thesis, 1));
		bench_scene_close(&f);
		thesis_destroy(thesis);
		pool_destroy(pool);
		synthetic_close(&s);
	}
}

/* ---- errors ---- */

TEST("errors are those that were made")
{
	struct chance chance = chance_begin("errors");
	struct synthetic_options options = every_encoding(&chance);
	struct synthetic s;
	struct scope scope;
	struct composite_error e, worse = {.psnr_db = 90};
	struct bench_scene f;
	struct picture background;
	double *truth;
	const struct view whole = {.width = 37, .height = 21, .squash = 1};

	options.object_share = options.ground_share = 0.2;
	options.stand_in_share = 0;
	synthetic_open(&s, &options);
	bench_scene_open(&f, &s.basis, &chance, 0);
	background = view_picture(&whole, f.background.pixels, f.background.stride);
	assert_int_equal(scope_create(&scope, &s.basis, &s.basis.poses[0].shown), 0);
	assert_true(scope.objects > 0 && scope.shadows > 0);
	truth = calloc(3 * 37 * 21, sizeof(*truth));
	assert_non_null(truth);
	memset(f.background.pixels, 128, f.background.stride * 21);
	memset(f.out.pixels, 100, f.out.stride * 21);
	for (int at = 0; at < 37 * 21; at++) /* 2.5 in shadows, 0 elsewhere in scope, 50 outside */
		for (int c = 0; c < 3; c++)
			truth[3 * at + c] = scope.pixel[at] == SCOPE_SHADOW   ? 102.5
					    : scope.pixel[at] == SCOPE_OBJECT ? 100
									      : 150;
	e = error_measure(&scope, truth, &f.out, &background, TRANSFER_LINEAR);
	assert_true(fabs(e.max - 2.5) < 1e-12);
	assert_true(fabs(e.rms - 2.5 * sqrt((double)scope.shadows /
					    (double)(scope.objects + scope.shadows))) < 1e-12);
	assert_true(fabs(e.psnr_db - 20 * log10(255 / e.rms)) < 1e-9);
	assert_true(e.frame_psnr_db < e.psnr_db);
	assert_true(fabs(e.contrast - 2.5 / 128) < 1e-12);
	error_worse(&worse, &e);
	assert_true(worse.psnr_db == e.psnr_db && worse.max == e.max && worse.rms == e.rms);
	free(truth);
	scope_free(&scope);
	bench_scene_close(&f);
	synthetic_close(&s);
}

/* ---- lightings ---- */

static double white_ground(const struct basis *basis, const float (*radiance)[3], int c)
{
	double sum = 0;

	for (uint32_t i = 0; i < basis->info.lights; i++)
		sum += basis->lights[i].solid_angle_sr * basis->lights[i].direction[2] *
		       (double)radiance[i][c] / M_PI;
	return sum;
}

TEST("lightings are exposed")
{
	struct chance chance = chance_begin("lightings");
	const struct synthetic_options options = every_encoding(&chance);
	struct lightings l = {.count = 0};
	struct fault fault = {""};
	struct synthetic s;

	synthetic_open(&s, &options);
	assert_int_equal(lightings_add_built_in(&l, &s.basis, 1000, &fault), 0);
	assert_int_equal(l.count, 4);
	for (int k = 0; k < l.count; k++) {
		for (int m = 0; m < l.item[k].members; m++) {
			const float(*r)[3] = lighting_member(&l.item[k], &s.basis, m);
			double most = 0;

			for (int c = 0; c < 3; c++)
				most = fmax(most, white_ground(&s.basis, r, c));
			assert_true(l.item[k].members > 1 ? most < 1 + 1e-6
							  : fabs(most - 1) < 1e-6);
		}
	}
	/* never more parts than lights */
	assert_int_equal(l.item[3].members, 45);
	lightings_free(&l);
	/* the lights are no dome */
	assert_int_equal(lightings_add_panorama(&l, &s.basis, "none.hdr", &fault), -ENOENT);
	assert_int_equal(lightings_add_file(&l, &s.basis, "none.txt", &fault), -ENOENT);
	lightings_free(&l);
	synthetic_close(&s);
}
