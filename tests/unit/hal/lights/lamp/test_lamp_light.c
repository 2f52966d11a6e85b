/* SPDX-License-Identifier: MIT */
/* The light of lamps at places, taken out of the lights of a dome. */
#include <math.h>
#include <string.h>

#include "hal/lights/lamp/lamp_light.h"
#include "hal/optics/dome_placed.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { LIGHTS = 406 };

static struct dome dome;
static struct dome_placed *placed;

struct sky_test {
	float radiance[LIGHTS][3];
	double power[LAMPS_MAX][3];
};

static int dome_begin(void **state)
{
	(void)state;
	assert_int_equal(dome_create(&dome, 9, NULL), 0);
	assert_int_equal(dome.count, LIGHTS);
	assert_int_equal(dome_placed_create(&placed, &dome), 0);
	return 0;
}

static int dome_end(void **state)
{
	(void)state;
	dome_placed_destroy(placed);
	dome_free(&dome);
	return 0;
}

/* A sky of this radiance, brighter towards +X. */
static void sky_begin(struct sky_test *t, float even, float slope)
{
	for (int i = 0; i < LIGHTS; i++)
		for (int c = 0; c < 3; c++)
			t->radiance[i][c] = even + slope * (float)dome.direction[i][0];
}

/* Adds light of this power from a direction as the sampler places it. */
static void add_light(struct sky_test *t, const double dir[3], const double power[3])
{
	double weight[3];
	int to[3], facet = -1, count;

	count = dir[2] > 0 ? dome_placed_share(placed, dome_cell_of(&dome, dir), &facet, dir, to,
					       weight)
			   : 0;
	for (int n = 0; n < count; n++)
		for (int c = 0; c < 3; c++)
			t->radiance[to[n]][c] +=
				(float)(weight[n] * power[c] / dome.solid_angle_sr[to[n]]);
}

/* The lamp is `off` rad away from where it is said to be. */
static void add_lamp(struct sky_test *t, const struct lamps *lamps, int lamp, double off,
		     const double power[3])
{
	double dir[3], across[2][3];

	for (int k = 0; k < 3; k++)
		dir[k] = lamps->lamp[lamp].position[k] - lamps->fisheye[k];
	vec_normalize(dir);
	vec_across(dir, across);
	for (int k = 0; k < 3; k++)
		dir[k] += off * across[0][k];
	vec_normalize(dir);
	add_light(t, dir, power);
}

static void take(struct sky_test *t, const struct lamps *lamps)
{
	struct lamp_light *light;

	assert_int_equal(lamp_light_create(&light, &dome, placed, lamps), 0);
	lamp_light_take(light, t->radiance, t->power);
	lamp_light_destroy(light);
}

static double sum_of(const struct sky_test *t, int c)
{
	double sum = 0;

	for (int i = 0; i < LIGHTS; i++)
		sum += dome.solid_angle_sr[i] * (double)t->radiance[i][c];
	return sum;
}

TEST("a lamp's power is what it adds to an even sky, wherever it hangs")
{
	struct chance chance = {7};
	struct sky_test t;

	for (int n = 0; n < 40; n++) {
		const double power[3] = {0.4, 0.2, 0};
		struct lamps lamps = {.count = 1};

		for (int k = 0; k < 3; k++) {
			lamps.lamp[0].position[k] = chance_real(&chance, k < 2 ? -2 : 1, 2);
			lamps.fisheye[k] = chance_real(&chance, -0.2, 0.2);
		}
		lamps.lamp[0].radius = 1e-4; /* a point, as add_lamp() has it */
		sky_begin(&t, 0.25F, 0);
		add_lamp(&t, &lamps, 0, 0, power);
		take(&t, &lamps);
		for (int c = 0; c < 3; c++) /* the level factor of dome_placed.h is a part of it */
			expect_below(fabs(t.power[0][c] - power[c]), 0.03 * power[c] + 1e-6,
				     "n=%d c=%d is %g", n, c, t.power[0][c]);
		for (int i = 0; i < LIGHTS; i++)
			expect_below(fabs((double)t.radiance[i][0] - 0.25), 1e-3, "n=%d light %d",
				     n, i);
	}
}

/* Returns the RMS of thirty lamps' errors of P, as shares of P. panel: what shines as brightly, 9
 * degrees beside each. */
static double error_of_lamps(double off, double panel)
{
	struct chance chance = {9};
	double squares = 0;

	for (int n = 0; n < 30; n++) {
		const double power[3] = {0.4, 0.4, 0.4}, more[3] = {panel, panel, panel};
		struct lamps lamps = {.count = 1, .lamp = {{{0, 0, 1.5}, 0.04}}};
		struct sky_test t;

		for (int k = 0; k < 2; k++)
			lamps.lamp[0].position[k] = chance_real(&chance, -1, 1);
		sky_begin(&t, 0.25F, 0);
		add_lamp(&t, &lamps, 0, off, power);
		add_lamp(&t, &lamps, 0, -9 * M_PI / 180, more);
		take(&t, &lamps);
		squares += pow(t.power[0][0] / power[0] - 1, 2);
	}
	return sqrt(squares / 30);
}

TEST("what is as bright beside a lamp adds a quarter to its power at most, and 1.5 degrees take a tenth")
{
	expect_below(error_of_lamps(0, 0), 0.01, "where it is said to be");
	expect_below(error_of_lamps(0.026, 0), 0.1, "1.5 degrees off");
	expect_below(error_of_lamps(0, 0.4), 0.25, "beside a panel");
}

TEST("no light is lost or counted twice, with any lamps in any sky")
{
	struct chance chance = {8};
	struct sky_test t;

	for (int n = 0; n < 40; n++) {
		struct lamps lamps = {.count = LAMPS_MAX};
		double before[3];

		sky_begin(&t, 0.5F, 0.4F);
		for (int l = 0; l < LAMPS_MAX; l++) {
			const double power[3] = {chance_real(&chance, 0, 1), 0.1, 0};

			for (int k = 0; k < 3; k++)
				lamps.lamp[l].position[k] = chance_real(&chance, k < 2 ? -2 : -0.2,
									2);
			lamps.lamp[l].radius = chance_real(&chance, 0.01, 0.3);
			add_lamp(&t, &lamps, l, 0, power);
		}
		for (int c = 0; c < 3; c++)
			before[c] = sum_of(&t, c);
		take(&t, &lamps);
		for (int c = 0; c < 3; c++) {
			double after = sum_of(&t, c);

			for (int l = 0; l < LAMPS_MAX; l++) {
				expect_at_least(t.power[l][c], 0, "n=%d lamp %d", n, l);
				after += t.power[l][c];
			}
			expect_below(fabs(after - before[c]), 1e-5 * before[c], "n=%d c=%d", n, c);
		}
	}
}

TEST("a lamp below the fisheye's horizon is not seen")
{
	const struct lamps lamps = {
		.count = 1, .lamp = {{{1, 0, 0.5}, 0.1}}, .fisheye = {0, 0, 0.8}};
	struct sky_test t;

	sky_begin(&t, 0.5F, 0.4F);
	take(&t, &lamps);
	for (int c = 0; c < 3; c++)
		expect_equal(t.power[0][c], 0, "c=%d", c);
}

TEST_GROUP(dome_begin, dome_end);
