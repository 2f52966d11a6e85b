/* SPDX-License-Identifier: MIT */
/* Lights left out by a budget: no pixel changes by more than the budget, in double precision, in
 * any light; as many lights are left out as the bound allows; and the set does not flicker. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/compositor.h"
#include "hal/compositor/light/light_budget.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { LIGHTS = 120, PIXELS = 40, GROUNDS = 2 };

/* An object over two grounds, pixel by pixel, and what a file declares of it. */
struct budget_scene {
	struct basis basis;
	struct basis_pose pose;
	struct basis_light light[LIGHTS];
	double ground[GROUNDS][3][LIGHTS];
	float peak[LIGHTS + 1][3];
	double object[PIXELS][3][LIGHTS]; /* t */
	double shade[PIXELS][3][LIGHTS];  /* v */
	double coverage[PIXELS];
	struct light_selection selection;
	float radiance[LIGHTS][3];
	double gain;
};

/* Fills a pixel sparsely or evenly: mirrors and matt surfaces, hard and soft shadows. */
static void fill_pixel(struct chance *chance, struct budget_scene *s, int p)
{
	const double sparse = chance_real(chance, 0, 1);

	s->coverage[p] = p % 3 == 0 ? 0 : p % 3 == 1 ? 1 : chance_real(chance, 0, 1);
	for (int c = 0; c < 3; c++) {
		double sum = 0;

		for (int i = 0; i < LIGHTS; i++) {
			const bool none = chance_real(chance, 0, 1) < sparse;

			s->object[p][c][i] = none ? 0 : (double)(float)chance_real(chance, 0, 0.05);
			s->shade[p][c][i] = chance_real(chance, 0, 1) < sparse
						    ? (double)chance_int(chance, 0, 1)
						    : chance_real(chance, 0, 1);
			s->peak[i][c] = fmaxf(s->peak[i][c], (float)s->object[p][c][i]);
			sum += s->object[p][c][i];
		}
		s->peak[LIGHTS][c] = fmaxf(s->peak[LIGHTS][c], nextafterf((float)sum, 1e30f));
	}
}

static struct budget_scene *scene_begin(struct chance *chance)
{
	struct budget_scene *s = calloc(1, sizeof(*s));

	assert_non_null(s);
	s->gain = 1;
	for (int i = 0; i < LIGHTS; i++) {
		chance_direction(chance, 0, s->light[i].direction);
		s->light[i].solid_angle_sr = 2 * M_PI / LIGHTS * chance_real(chance, 0.5, 1.5);
		for (int g = 0; g < GROUNDS; g++)
			for (int c = 0; c < 3; c++)
				s->ground[g][c][i] = chance_real(chance, 0, g ? 1e6 : 0.01);
	}
	for (int p = 0; p < PIXELS; p++)
		fill_pixel(chance, s, p);
	s->pose.peak = (const float(*)[3])s->peak;
	s->basis = (struct basis){.info = {.lights = LIGHTS, .grounds = GROUNDS, .poses = 1},
				  .lights = s->light,
				  .ground = &s->ground[0][0][0],
				  .poses = &s->pose};
	assert_int_equal(light_selection_create(&s->selection, &s->basis), 0);
	return s;
}

static void scene_end(struct budget_scene *s)
{
	light_selection_free(&s->selection);
	free(s);
}

static void budget_choose(struct budget_scene *s, double budget, enum threshold_mode mode)
{
	s->selection.budget = budget;
	light_selection_choose(&s->selection, &s->basis, 0, (const float(*)[3])s->radiance, 0, mode,
			       s->gain);
}

/* A pixel over a white background, in linear light that is not clipped. */
static double budget_pixel(const struct budget_scene *s, int p, int c, const double (*light)[3],
			   const double ambient[3])
{
	const double *u = s->ground[p % GROUNDS][c];
	double object = 0, less = 0, ground = 0;

	for (int i = 0; i < LIGHTS; i++) {
		const double l = light[i][c] + ambient[c];

		object += s->object[p][c][i] * l;
		less += s->shade[p][c][i] * u[i] * l;
		ground += u[i] * l + u[i] * 0x1p-20;
	}
	return s->gain * object + (1 - s->coverage[p]) * fmax(1 - less / ground, 0);
}

static double largest_change(const struct budget_scene *s)
{
	static const double none[3];
	double all[LIGHTS][3], most = 0;

	for (int i = 0; i < LIGHTS; i++)
		for (int c = 0; c < 3; c++)
			all[i][c] = (double)s->radiance[i][c];
	for (int p = 0; p < PIXELS; p++) {
		for (int c = 0; c < 3; c++) {
			const double before = budget_pixel(s, p, c, (const double(*)[3])all, none);
			const double after = budget_pixel(s, p, c,
							  (const double(*)[3])s->selection.radiance,
							  s->selection.ambient);

			most = fmax(most, fabs(after - before));
		}
	}
	return most;
}

static int ascending(const void *a, const void *b)
{
	const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;

	return (x > y) - (x < y);
}

/* Largest number of lights that fit into a budget, counted one by one. */
static int most_possible(const struct budget_scene *s, double budget)
{
	uint64_t sorted[LIGHTS], sum = 0;
	int count = 0;

	memcpy(sorted, s->selection.bound, sizeof(sorted));
	qsort(sorted, LIGHTS, sizeof(*sorted), ascending);
	while (count < LIGHTS &&
	       (double)(sum += sorted[count]) <= budget * (double)LIGHT_BUDGET_WHITE)
		count++;
	return count;
}

enum lighting { RANDOM, ONE_LARGE, EQUAL, DARK, STEEP, COLOURED, LIGHTINGS };

static void budget_light(struct chance *chance, struct budget_scene *s, enum lighting lighting)
{
	for (int i = 0; i < LIGHTS; i++) {
		for (int c = 0; c < 3; c++) {
			const double random = chance_real(chance, 0, 1);

			s->radiance[i][c] = (float)(lighting == RANDOM	    ? random
						    : lighting == ONE_LARGE ? (i == 7 ? 1e6 : 1)
						    : lighting == EQUAL	    ? 0.5
						    : lighting == DARK	    ? 0
						    : lighting == STEEP	    ? exp(-40 * random)
									: (i % 3 == c) * random);
		}
	}
}

TEST("no pixel changes by more")
{
	static const double budgets[] = {1e-9, 0.001, 0.01, 0.1, 0.5, 1};
	struct chance chance = chance_begin("budget");
	double closest = 0;

	for (int n = 0; n < 4 * LIGHTINGS * THRESHOLD_MODE_COUNT; n++) {
		struct budget_scene *s = scene_begin(&chance);
		const enum threshold_mode mode =
			(enum threshold_mode)(n / LIGHTINGS % THRESHOLD_MODE_COUNT);

		s->gain = n % 5 ? 1 : 8;
		budget_light(&chance, s, (enum lighting)(n % LIGHTINGS));
		for (size_t k = 0; k < sizeof(budgets) / sizeof(*budgets); k++) {
			const double change = (budget_choose(s, budgets[k], mode),
					       largest_change(s));

			expect_at_most(change, budgets[k] + 1e-12, "lighting %d, mode %d, round %d",
				       n % LIGHTINGS, mode, n);
			expect_equal(LIGHTS - s->selection.used_count, most_possible(s, budgets[k]),
				     "lighting %d, mode %d, round %d, budget %g", n % LIGHTINGS,
				     mode, n, budgets[k]);
			closest = fmax(closest, change / budgets[k]);
		}
		scene_end(s);
	}
	printf("# the largest change is %.2f of its budget\n", closest);
	assert_true(closest > 0.05); /* the bound is near the truth */
}

/* Each light's bound, computed from the formula of the header. */
TEST("the bound is what the header says")
{
	struct chance chance = chance_begin("bound");
	struct budget_scene *s = scene_begin(&chance);

	budget_light(&chance, s, RANDOM);
	budget_choose(s, 0.01, THRESHOLD_DROP);
	for (int i = 0; i < LIGHTS; i++) {
		double most = 0;

		for (int c = 0; c < 3; c++) {
			double share = 0;

			for (int g = 0; g < GROUNDS; g++) {
				double sum = 0;

				for (int k = 0; k < LIGHTS; k++)
					sum += s->ground[g][c][k] *
					       ((double)s->radiance[k][c] + 0x1p-20);
				share = fmax(share, s->ground[g][c][i] / sum);
			}
			most = fmax(most,
				    (double)s->radiance[i][c] * ((double)s->peak[i][c] + share));
		}
		expect_below(
			fabs((double)s->selection.bound[i] / (double)LIGHT_BUDGET_WHITE - most),
			1e-11, "light %d", i);
	}
	scene_end(s);
}

TEST("ends of the range")
{
	struct chance chance = chance_begin("ends");
	struct budget_scene *s = scene_begin(&chance);

	budget_light(&chance, s, EQUAL);
	budget_choose(s, 0, THRESHOLD_DROP); /* by threshold 0: all lights are used */
	assert_int_equal(s->selection.used_count, LIGHTS);
	budget_choose(s, 1e-13, THRESHOLD_DROP); /* every light that sends something stays */
	assert_int_equal(s->selection.used_count, LIGHTS);
	s->radiance[3][0] = s->radiance[3][1] = s->radiance[3][2] = 0;
	s->radiance[4][0] = NAN;
	s->radiance[5][1] = FLT_MAX;
	budget_choose(s, 1e-13, THRESHOLD_AMBIENT);
	assert_false(s->selection.used[3]);
	assert_true(s->selection.used[5]);
	budget_choose(s, 1, THRESHOLD_DROP);
	assert_true(s->selection.used[5]);
	budget_light(&chance, s, DARK);
	budget_choose(s, 1e-9, THRESHOLD_DROP);
	assert_int_equal(s->selection.used_count, 0);
	scene_end(s);
}

TEST("the cut is that of sorting")
{
	struct chance chance = chance_begin("cut");
	uint64_t bound[500], sorted[500];

	for (int n = 0; n < 2000; n++) {
		const int count = chance_int(&chance, 1, 500), bits = chance_int(&chance, 1, 41);
		uint64_t room = chance_bits(&chance) >> chance_int(&chance, 16, 63), sum = 0;
		struct light_cut cut;
		int most = 0, below = 0;

		for (int i = 0; i < count; i++)
			bound[i] = sorted[i] = chance_bits(&chance) >> (64 - bits);
		qsort(sorted, (size_t)count, sizeof(*sorted), ascending);
		while (most < count && (sum += sorted[most]) <= room)
			most++;
		cut = light_budget_cut(bound, count, room);
		expect_equal(cut.count, most, "%d lights, round %d", count, n);
		for (int i = 0; i < count; i++)
			below += bound[i] < cut.bound;
		expect_equal(below + cut.equal, most, "%d lights, round %d", count, n);
	}
}

/* Noise of two per cent in all lights. */
TEST("the set does not flicker")
{
	struct chance chance = chance_begin("flicker");
	struct budget_scene *s = scene_begin(&chance);
	float still[LIGHTS][3];
	bool used[LIGHTS];
	int changes = 0;

	budget_light(&chance, s, STEEP);
	memcpy(still, s->radiance, sizeof(still));
	for (int k = 0; k < 1000; k++) {
		for (int i = 0; i < LIGHTS; i++)
			for (int c = 0; c < 3; c++)
				s->radiance[i][c] = still[i][c] *
						    (float)chance_real(&chance, 0.98, 1.02);
		budget_choose(s, 0.02, THRESHOLD_DROP);
		expect_at_most(largest_change(s), 0.02, "frame %d", k);
		changes += k && memcmp(used, s->selection.used, sizeof(used)) != 0;
		memcpy(used, s->selection.used, sizeof(used));
	}
	assert_true(changes <= 1);
	budget_choose(s, 0.03, THRESHOLD_DROP); /* another threshold chooses anew */
	assert_int_equal(LIGHTS - s->selection.used_count, most_possible(s, 0.03));
	scene_end(s);
}
