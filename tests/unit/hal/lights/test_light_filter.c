/* SPDX-License-Identifier: MIT */
/* Light over time: constant light passes unchanged, switched light arrives within the set time and
 * does not overshoot, noise does not crawl, and nothing sticks. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/light_filter.h"
#include "hal/lights/pixel_noise.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { LIGHTS = 100 };

#define MS INT64_C(1000000)
#define FOLLOW (100 * MS)

static const struct transfer_curve srgb = {.named = TRANSFER_SRGB};

static double level(double code)
{
	return transfer_curve_decode(&srgb, code / 255);
}

static double code_of(double light)
{
	return 255 * transfer_curve_encode(&srgb, light);
}

struct filtered_lamp {
	struct light_filter *filter;
	int count;
	float (*x)[3]; /* first the input, then the output */
};

static struct filtered_lamp lamp_begin(int count, float pixels)
{
	struct filtered_lamp l = {.count = count};
	float *seen = malloc(sizeof(*seen) * (size_t)count);

	l.x = calloc((size_t)count, sizeof(*l.x));
	assert_true(seen && l.x);
	for (int i = 0; i < count; i++)
		seen[i] = pixels;
	assert_int_equal(light_filter_create(&l.filter, count), 0);
	light_filter_measured(l.filter, &srgb, 1, seen);
	free(seen);
	return l;
}

static void lamp_end(struct filtered_lamp *l)
{
	light_filter_destroy(l->filter);
	free(l->x);
}

static void filter_fill(struct filtered_lamp *l, double light)
{
	for (int i = 0; i < l->count; i++)
		for (int c = 0; c < 3; c++)
			l->x[i][c] = (float)light;
}

/* Filters a frame in which all lights are equal. */
static double filter_frame(struct filtered_lamp *l, int64_t at_ns, double light)
{
	filter_fill(l, light);
	light_filter_run(l->filter, at_ns, FOLLOW, l->x);
	return (double)l->x[l->count / 2][1];
}

TEST("constant light comes out as it went in")
{
	struct chance chance = chance_begin("constant light");
	struct filtered_lamp l = lamp_begin(LIGHTS, 20);
	float given[LIGHTS][3];

	for (int i = 0; i < LIGHTS; i++)
		for (int c = 0; c < 3; c++)
			given[i][c] = i ? (float)exp(chance_real(&chance, -90, 60)) : 0;
	for (int k = 0; k < 300; k++) {
		memcpy(l.x, given, sizeof(given));
		light_filter_run(l.filter, k * chance_int(&chance, 0, 40) * MS, FOLLOW, l.x);
		assert_memory_equal(l.x, given, sizeof(given));
	}
	lamp_end(&l);
}

/* One light switches, from dark or half, up or down, at several rates. */
TEST("a switched lamp is there in time")
{
	static const double from[] = {0, 0.2, 1, 1, 0.5}, to[] = {1, 0.25, 0, 0.9, 400};
	static const int64_t dt[] = {FOLLOW / 12, 33366667, 40 * MS, 100 * MS, 900 * MS};

	for (int n = 0; n < 25; n++) {
		const double a = from[n % 5], b = to[n % 5];
		struct filtered_lamp l = lamp_begin(LIGHTS, 50);
		double before = a;
		int64_t at = 0;

		for (; at < 10 * dt[n / 5]; at += dt[n / 5])
			filter_frame(&l, at, a);
		for (int64_t since = 0; since < 1000 * MS; since += dt[n / 5]) {
			double now, off;

			filter_fill(&l, a);
			for (int c = 0; c < 3; c++)
				l.x[7][c] = (float)b;
			light_filter_run(l.filter, at + since, FOLLOW, l.x);
			now = (double)l.x[7][1];
			off = fabs(now - (double)(float)b);
			if (since + dt[n / 5] > FOLLOW)
				expect_at_most(off, 0.1001 * fabs(b - a), "n=%d, since=%lld", n,
					       (long long)since);
			if (since + dt[n / 5] < FOLLOW)
				expect_at_least(off, 0.0999 * fabs(b - a), "n=%d, since=%lld", n,
						(long long)since);
			/* towards the new value, never beyond it */
			expect_that(b > a ? now >= before && now <= (double)(float)b
					  : now <= before && now >= (double)(float)b,
				    "n=%d, since=%lld", n, (long long)since);
			expect_equal(l.x[8][1], (float)a, "n=%d, since=%lld", n, (long long)since);
			before = now;
		}
		lamp_end(&l);
	}
}

/* The output at a time does not depend on the number of frames before it. */
TEST("time counts and not frames")
{
	struct chance chance = chance_begin("time");
	double at_50[20];

	for (int n = 0; n < 20; n++) {
		struct filtered_lamp l = lamp_begin(LIGHTS, 50);
		int64_t at = 1;

		filter_frame(&l, 0, 0.1);
		while (at < 50 * MS) {
			filter_frame(&l, at, 0.8);
			at += n ? chance_int(&chance, 1, 30) * MS : 50 * MS;
		}
		at_50[n] = filter_frame(&l, 50 * MS, 0.8);
		expect_below(fabs(at_50[n] - at_50[0]), 2e-5, "n=%d", n);
		lamp_end(&l);
	}
}

/* ---- noise ---- */

static double normal(struct chance *chance)
{
	double sum = -6;

	for (int k = 0; k < 12; k++)
		sum += chance_real(chance, 0, 1);
	return sum;
}

/* Mean of that many pixels of an 8-bit camera. */
static double seen(struct chance *chance, double code, double noise, int pixels)
{
	double sum = 0;

	for (int k = 0; k < pixels; k++)
		sum += level(fmin(fmax(round(code + noise * normal(chance)), 0), 255));
	return sum / pixels;
}

struct crawl {
	/* Largest change of a pixel that sees one light, and of one that sees all. */
	int mirror, diffuse;
	double mean; /* mean of all outputs */
	double given;
};

static struct crawl crawl_of(struct chance *chance, int64_t follow_ns, int pixels, int64_t dt)
{
	enum { FRAMES = 300 };
	static int before[LIGHTS], shone;
	struct filtered_lamp l = lamp_begin(LIGHTS, (float)pixels);
	struct crawl found = {0};

	for (int k = 0; k < FRAMES; k++) {
		double all = 0;

		for (int i = 0; i < LIGHTS; i++)
			for (int c = 0; c < 3; c++) {
				l.x[i][c] = (float)seen(chance, 20 + 2.2 * i, 1.5, pixels);
				found.given += (double)l.x[i][c] / (3.0 * LIGHTS * FRAMES);
			}
		light_filter_run(l.filter, k * dt, follow_ns, l.x);
		for (int i = 0; i < LIGHTS; i++) {
			const int code = (int)lrint(code_of((double)l.x[i][1]));

			if (k && abs(code - before[i]) > found.mirror)
				found.mirror = abs(code - before[i]);
			before[i] = code;
			for (int c = 0; c < 3; c++)
				found.mean += (double)l.x[i][c] / (3.0 * LIGHTS * FRAMES);
			all += (double)l.x[i][1] / LIGHTS;
		}
		if (k && abs((int)lrint(code_of(all)) - shone) > found.diffuse)
			found.diffuse = abs((int)lrint(code_of(all)) - shone);
		shone = (int)lrint(code_of(all));
	}
	lamp_end(&l);
	return found;
}

TEST("noise moves no pixel by more than a level")
{
	struct chance chance = chance_begin("noise");

	for (int pixels = 2; pixels <= 32; pixels *= 4) {
		const struct crawl found = crawl_of(&chance, FOLLOW, pixels, 33 * MS);
		const struct crawl without = crawl_of(&chance, 0, pixels, 33 * MS);

		printf("# cells of %d pixels, noise 1.5 codes: a mirror changes by %d levels (unfiltered %d), white by %d; mean %+.1e of what was given\n",
		       pixels, found.mirror, without.mirror, found.diffuse,
		       found.mean / found.given - 1);
		expect_that(found.mirror <= 1 && found.diffuse <= 1, "pixels=%d", pixels);
		expect_that(pixels > 8 || without.mirror > 1, "pixels=%d", pixels);
		expect_below(fabs(found.mean / found.given - 1), 1e-3, "pixels=%d", pixels);
	}
}

/* The sum over time of a flash, or of several, is kept. */
TEST("energy is kept")
{
	struct filtered_lamp l = lamp_begin(LIGHTS, 50);
	double in = 0, out = 0;
	int64_t at = 0;

	filter_frame(&l, 0, 0);
	for (int k = 0; k < 4000; k++) {
		const double light = k < 300 && k % 60 < 30 ? 1 : 0;

		at += 33 * MS;
		in += light;
		out += filter_frame(&l, at, light);
	}
	assert_true(fabs(out / in - 1) < 0.01);
	lamp_end(&l);
}

/* ---- what noise hides ---- */

/* A light that grows by one code in ten seconds, in steps far below the camera's noise. */
TEST("a slow lamp does not stick")
{
	struct filtered_lamp l = lamp_begin(1, 4);
	double light = level(120), now = 0;
	int64_t at = 0;

	for (int speed = 0; speed < 3; speed++) { /* 0.1, 1 and 10 codes a second */
		double before = filter_frame(&l, at, light);

		for (int k = 0; k < 300; k++) {
			at += 33 * MS;
			light += (level(121) - level(120)) * 0.033 * 0.1 * pow(10, speed);
			now = filter_frame(&l, at, light);
			expect_that(now >= before && now <= (double)(float)light, "speed=%d, k=%d",
				    speed, k);
			/* The line above the slope's square is up to 1.4 above its root. */
			expect_at_most(light - now,
				       1.4 * 4 * PIXEL_NOISE_CODES *
					       (level(code_of(light) + 1) - light),
				       "speed=%d, k=%d", speed, k);
			expect_that(k < 90 || now > before, "speed=%d, k=%d", speed, k);
			before = now;
		}
		for (int k = 0; k < 200; k++)
			now = filter_frame(&l, at += 33 * MS, light);
		expect_equal(now, (double)(float)light, "speed=%d", speed);
	}
	lamp_end(&l);
}

/* The whole room changes by five per cent, which no single light shows. */
TEST("what all lights say together is heard")
{
	struct chance chance = chance_begin("together");
	struct filtered_lamp l = lamp_begin(LIGHTS, 2);
	double sum = 0;

	for (int k = 0; k < 64; k++) {
		const double share = k < 60 ? 1 : 0.95;

		sum = 0;
		for (int i = 0; i < LIGHTS; i++)
			for (int c = 0; c < 3; c++)
				l.x[i][c] = (float)(seen(&chance, 128, 1.5, 2) * share);
		light_filter_run(l.filter, k * 33 * MS, FOLLOW, l.x);
		for (int i = 0; i < LIGHTS; i++)
			sum += (double)l.x[i][1] / LIGHTS;
	}
	assert_true(fabs(sum / level(128) - 0.95) < 0.01);
	lamp_end(&l);
}

/* ---- beginnings ---- */

TEST("it begins anew")
{
	struct filtered_lamp l = lamp_begin(LIGHTS, 50);
	float pixels[LIGHTS];
	const double half = (double)0.5f;

	assert_true(filter_frame(&l, 5000 * MS, 1) == 1);
	assert_true(filter_frame(&l, 5033 * MS, half) > half);
	assert_true(filter_frame(&l, 5000 * MS, half) == half); /* an older frame */
	assert_true(filter_frame(&l, 5300 * MS, 1) < 1);	/* a slow camera is followed */
	assert_true(filter_frame(&l, 6401 * MS, half) ==
		    half);				     /* more than a second without frames */
	assert_true(filter_frame(&l, 6401 * MS, 1) == half); /* the same time again */
	assert_true(filter_frame(&l, 6434 * MS, 1) < 1);
	light_filter_begin(l.filter);
	assert_true(filter_frame(&l, 6467 * MS, half) == half);
	for (int i = 0; i < LIGHTS; i++)
		pixels[i] = 1;
	light_filter_measured(l.filter, &srgb, 2, pixels);
	assert_true(filter_frame(&l, 6500 * MS, 1) == 1);
	filter_fill(&l, 0.5);
	light_filter_run(l.filter, 6533 * MS, 0, l.x); /* filter off */
	assert_true(l.x[3][2] == 0.5f);
	assert_true(filter_frame(&l, 6566 * MS, 1) < 1); /* on again, from the last light */
	lamp_end(&l);
}
