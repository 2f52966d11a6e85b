/* SPDX-License-Identifier: MIT */
/* Dropped light that comes back as nine spherical harmonics, against normal equations solved by
 * elimination. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "hal/compositor/compositor.h"
#include "hal/optics/dome.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"

enum { LIGHTS_MAX = 512, NINE = 9, PIXELS = 40 };

/* A sky and pixels of an object under it. */
struct return_scene {
	struct dome dome;
	struct basis_light light[LIGHTS_MAX];
	float object[PIXELS][LIGHTS_MAX][3], peak[LIGHTS_MAX + 1][3];
	float radiance[LIGHTS_MAX][3];
	struct basis_pose pose;
	struct basis basis;
	struct light_selection selection;
};

static void fill_pixels(struct return_scene *s, struct chance *chance)
{
	for (int p = 0; p < PIXELS; p++) {
		for (int c = 0; c < 3; c++) {
			float all = 0;

			for (int i = 0; i < s->dome.count; i++) {
				float *t = &s->object[p][i][c];

				*t = (float)(pow(chance_real(chance, 0, 1), 3) *
					     s->light[i].solid_angle_sr);
				all += *t;
				s->peak[i][c] = fmaxf(s->peak[i][c], *t);
			}
			s->peak[s->dome.count][c] = fmaxf(s->peak[s->dome.count][c], all);
		}
	}
}

static void scene_begin(struct return_scene *s, int frequency, struct chance *chance)
{
	memset(s, 0, sizeof(*s));
	assert_int_equal(dome_create(&s->dome, frequency, DOME_ANGLES, NULL), 0);
	assert_true(s->dome.count <= LIGHTS_MAX);
	for (int i = 0; i < s->dome.count; i++) {
		memcpy(s->light[i].direction, s->dome.direction[i], sizeof(s->light[i].direction));
		s->light[i].solid_angle_sr = s->dome.solid_angle_sr[i];
	}
	fill_pixels(s, chance);
	s->pose.peak = (const float(*)[3])s->peak;
	s->basis = (struct basis){.info = {.lights = (uint32_t)s->dome.count, .poses = 1},
				  .lights = s->light,
				  .poses = &s->pose};
	assert_int_equal(light_selection_create(&s->selection, &s->basis), 0);
}

static void scene_end(struct return_scene *s)
{
	light_selection_free(&s->selection);
	dome_free(&s->dome);
}

/* Dim light that leans to one side, and a few lamps. */
static void return_light(struct return_scene *s, struct chance *chance)
{
	double towards[3];

	chance_direction(chance, 0, towards);
	for (int i = 0; i < s->dome.count; i++) {
		const double *d = s->dome.direction[i];
		const double lean =
			1 + 0.9 * (d[0] * towards[0] + d[1] * towards[1] + d[2] * towards[2]);

		for (int c = 0; c < 3; c++)
			s->radiance[i][c] =
				(float)(0.1 * lean * lean * chance_real(chance, 0.5, 1.5) +
					(i % 29 == 3 ? 30 : 0));
	}
}

static void return_choose(struct return_scene *s, double threshold, enum threshold_mode mode)
{
	light_selection_choose(&s->selection, &s->basis, 0, (const float(*)[3])s->radiance,
			       threshold, mode, 2);
}

static void nine_of(const double d[3], double y[NINE])
{
	const double plain[NINE] = {1,
				    d[1],
				    d[2],
				    d[0],
				    d[0] * d[1],
				    d[1] * d[2],
				    3 * d[2] * d[2] - 1,
				    d[0] * d[2],
				    d[0] * d[0] - d[1] * d[1]};

	memcpy(y, plain, sizeof(plain));
}

/* Gaussian elimination with pivots. */
static void return_solve(double a[NINE][NINE + 1])
{
	for (int k = 0; k < NINE; k++) {
		int best = k;

		for (int r = k + 1; r < NINE; r++)
			best = fabs(a[r][k]) > fabs(a[best][k]) ? r : best;
		for (int n = 0; n <= NINE; n++) {
			const double keep = a[k][n];

			a[k][n] = a[best][n];
			a[best][n] = keep;
		}
		for (int r = 0; r < NINE; r++) {
			const double share = a[r][k] / a[k][k];

			for (int n = k; n <= NINE && r != k; n++)
				a[r][n] -= share * a[k][n];
		}
	}
}

/* Least-squares fit to the dropped lights, evaluated at every light. */
static void fit_plainly(const struct return_scene *s, int c, double fit[LIGHTS_MAX])
{
	double a[NINE][NINE + 1] = {{0}};

	for (int i = 0; i < s->dome.count; i++) {
		const double w = s->light[i].solid_angle_sr;
		const double f = s->selection.used[i] ? 0 : (double)s->radiance[i][c];
		double y[NINE];

		nine_of(s->dome.direction[i], y);
		for (int r = 0; r < NINE; r++) {
			for (int n = 0; n < NINE; n++)
				a[r][n] += w * y[r] * y[n];
			a[r][NINE] += w * y[r] * f;
		}
	}
	return_solve(a);
	for (int i = 0; i < s->dome.count; i++) {
		double y[NINE];

		nine_of(s->dome.direction[i], y);
		fit[i] = 0;
		for (int k = 0; k < NINE; k++)
			fit[i] += a[k][NINE] / a[k][k] * y[k];
	}
}

static double returned(const struct return_scene *s, int i, int c)
{
	const double kept = s->selection.used[i] ? (double)s->radiance[i][c] : 0;

	return s->selection.radiance[i][c] - kept + s->selection.ambient[c];
}

/* RMS over the sky of returned minus dropped light. */
static double miss(const struct return_scene *s, int c)
{
	double sum = 0;

	for (int i = 0; i < s->dome.count; i++) {
		const double lost = s->selection.used[i] ? 0 : (double)s->radiance[i][c];

		sum += s->light[i].solid_angle_sr * pow(returned(s, i, c) - lost, 2);
	}
	return sqrt(sum / (2 * M_PI));
}

static void check_fit(const struct return_scene *s, int c)
{
	double fit[LIGHTS_MAX], mean = 0, back = 0, lowest = 0, share;

	for (int i = 0; i < s->dome.count; i++) {
		const double w = s->light[i].solid_angle_sr / (2 * M_PI);

		mean += s->selection.used[i] ? 0 : w * (double)s->radiance[i][c];
		back += w * returned(s, i, c);
	}
	fit_plainly(s, c, fit);
	for (int i = 0; i < s->dome.count; i++)
		lowest = fmin(lowest, fit[i] - mean);
	share = lowest < -mean ? mean / -lowest : 1;
	assert_true(fabs(back - mean) < 1e-12 * mean);
	for (int i = 0; i < s->dome.count; i++) {
		expect_at_least(s->selection.radiance[i][c], 0, "light %d of %d, channel %d", i,
				s->dome.count, c);
		expect_below(fabs(returned(s, i, c) - (mean + share * (fit[i] - mean))),
			     1e-10 * mean, "light %d of %d, channel %d", i, s->dome.count, c);
	}
}

static void is_the_least_squares_fit(void **state)
{
	static struct return_scene s;
	struct chance chance = chance_begin("return");

	(void)state;
	for (int f = 2; f <= 9; f++) {
		scene_begin(&s, f, &chance);
		for (int n = 0; n < 10; n++) {
			return_light(&s, &chance);
			return_choose(&s, n % 2 ? 1 : 0.2, THRESHOLD_HARMONICS);
			expect_below(s.selection.used_count, s.dome.count,
				     "frequency %d, lighting %d", f, n);
			for (int c = 0; c < 3; c++)
				check_fit(&s, c);
		}
		scene_end(&s);
	}
}

/* The fit is never farther from the dropped light than the mean alone, and mostly much nearer. */
static void nine_are_nearer_than_one(void **state)
{
	static struct return_scene s;
	struct chance chance = chance_begin("return");
	double of_one = 0, of_nine = 0;

	(void)state;
	scene_begin(&s, 6, &chance);
	for (int n = 0; n < 50; n++) {
		double one[3];

		return_light(&s, &chance);
		return_choose(&s, 1, THRESHOLD_AMBIENT);
		for (int c = 0; c < 3; c++)
			one[c] = miss(&s, c);
		return_choose(&s, 1, THRESHOLD_HARMONICS);
		for (int c = 0; c < 3; c++) {
			expect_at_most(miss(&s, c), one[c] * (1 + 1e-12), "lighting %d, channel %d",
				       n, c);
			of_one += one[c];
			of_nine += miss(&s, c);
		}
	}
	print_message("# nine terms miss %.2f of what one term misses\n", of_nine / of_one);
	assert_true(of_nine < 0.7 * of_one);
	scene_end(&s);
}

static void no_pixel_is_off_by_more(void **state)
{
	static struct return_scene s;
	struct chance chance = chance_begin("return");
	double closest = 0;

	(void)state;
	scene_begin(&s, 4, &chance);
	for (int n = 0; n < 30; n++) {
		return_light(&s, &chance);
		return_choose(&s, 0.1 * (n % 4 + 1), THRESHOLD_HARMONICS);
		for (int p = 0; p < PIXELS; p++)
			for (int c = 0; c < 3; c++) {
				double off = 0;

				for (int i = 0; i < s.dome.count; i++)
					off += 2 * (double)s.object[p][i][c] *
					       (s.selection.radiance[i][c] -
						(double)s.radiance[i][c]);
				expect_at_most(fabs(off), s.selection.dropped_error[c] * (1 + 1e-6),
					       "lighting %d, pixel %d, channel %d", n, p, c);
				if (s.selection.dropped_error[c] > 0)
					closest = fmax(closest,
						       fabs(off) / s.selection.dropped_error[c]);
			}
	}
	print_message("# the largest error is %.2f of its bound\n", closest);
	assert_true(closest > 0.02);
	scene_end(&s);
}

/* Six lights cannot tell nine terms apart: each light comes back as it was. */
static void few_lights(void **state)
{
	static struct return_scene s;
	struct chance chance = chance_begin("return");

	(void)state;
	scene_begin(&s, 1, &chance);
	return_light(&s, &chance);
	return_choose(&s, 1000, THRESHOLD_HARMONICS);
	assert_int_equal(s.selection.used_count, 0);
	for (int c = 0; c < 3; c++)
		expect_below(miss(&s, c), 1e-9, "channel %d", c);
	scene_end(&s);
}

static void nothing_dropped_and_nothing_there(void **state)
{
	static struct return_scene s;
	struct chance chance = chance_begin("return");

	(void)state;
	scene_begin(&s, 3, &chance);
	return_light(&s, &chance);
	return_choose(&s, 0, THRESHOLD_HARMONICS);
	for (int i = 0; i < s.dome.count; i++)
		for (int c = 0; c < 3; c++)
			expect_equal(s.selection.radiance[i][c], s.radiance[i][c],
				     "light %d, channel %d", i, c);
	memset(s.radiance, 0, sizeof(s.radiance));
	return_choose(&s, 1, THRESHOLD_HARMONICS);
	for (int c = 0; c < 3; c++)
		expect_that(s.selection.radiance[5][c] == 0 && s.selection.dropped_error[c] == 0,
			    "channel %d", c);
	scene_end(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(is_the_least_squares_fit),
		cmocka_unit_test(nine_are_nearer_than_one),
		cmocka_unit_test(no_pixel_is_off_by_more),
		cmocka_unit_test(few_lights),
		cmocka_unit_test(nothing_dropped_and_nothing_there),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
