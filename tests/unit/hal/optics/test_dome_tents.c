/* SPDX-License-Identifier: MIT */
/* Tents (lights that fall off linearly): their cover, their continuity, and their samples. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/dome.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static struct dome tents_of(int frequency, enum dome_division division)
{
	struct dome dome;

	assert_int_equal(dome_create_shaped(&dome, frequency, division, DOME_TENTS, NULL), 0);
	return dome;
}

static void check_sums(int f, enum dome_division division)
{
	struct dome dome = tents_of(f, division);
	double sum = 0, projected = 0, least = 1;

	for (int i = 0; i < dome.count; i++) {
		sum += dome.solid_angle_sr[i];
		projected += dome.projected_sr[i];
		least = fmin(least, fmin(dome.solid_angle_sr[i], dome.projected_sr[i]));
	}
	if (fabs(sum - 2 * M_PI) > 1e-12 || fabs(projected - M_PI) > 1e-12)
		fail_msg("f = %d, division %d: sums are off by %g and %g", f, division,
			 sum - 2 * M_PI, projected - M_PI);
	assert_true(least > 0);
	dome_free(&dome);
}

TEST("weights sum to the hemisphere")
{
	for (int division = 0; division < DOME_DIVISION_COUNT; division++) {
		for (int f = 1; f <= 12; f++)
			check_sums(f, division);
		for (int f = 27; f <= DOME_FREQUENCY_MAX; f += 37)
			check_sums(f, division);
	}
}

/* The weights of a direction: at most three lights, none negative, sum 1. */
static void weigh(const struct dome *dome, const double dir[3], double *all)
{
	int light[3];
	double weight[3], sum = 0;
	const int count = dome_weights(dome, dir, light, weight);

	memset(all, 0, (size_t)dome->count * sizeof(*all));
	assert_in_range(count, 1, 3);
	for (int k = 0; k < count; k++) {
		expect_that(weight[k] > 0 && all[light[k]] == 0, "k=%d", k);
		all[light[k]] = weight[k];
		sum += weight[k];
		expect_equal(dome_weight(dome, light[k], dir), weight[k], "k=%d", k);
	}
	assert_true(fabs(sum - 1) < 1e-15);
}

/* When a lamp moves, no light changes by more than the step's share of the distance to the next
 * node. */
static void check_step(const struct dome *dome, struct chance *chance, double *here, double *there)
{
	const double step = 1e-6;
	double from[3], to[3], spacing = atan(2) / dome->frequency;

	chance_direction(chance, 0, from);
	if (chance_int(chance, 0, 4) == 0) { /* along the horizon */
		from[2] *= 1e-3;
		vec_normalize(from);
	}
	for (int x = 0; x < 3; x++)
		to[x] = from[x] + step * chance_real(chance, -1, 1);
	to[2] = fmax(to[2], 0);
	weigh(dome, from, here);
	weigh(dome, to, there);
	for (int i = 0; i < dome->count; i++)
		/* The two nearest nodes to any node are some distance apart. Where the horizon is
		 * near the rim a triangle may be flat, so that its height gives no bound. */
		expect_below(fabs(here[i] - there[i]), 4 * sqrt(3) * step / (0.5 * spacing), "i=%d",
			     i);
}

TEST("continuous everywhere")
{
	static const int frequency[] = {1, 2, 3, 4, 5, 8, 9, 12};
	struct chance chance = chance_begin("tents");

	for (int n = 0; n < 16; n++) {
		struct dome dome = tents_of(frequency[n / 2], n % 2);
		double *here = calloc((size_t)dome.count, sizeof(*here));
		double *there = calloc((size_t)dome.count, sizeof(*there));

		assert_true(here && there);
		for (int k = 0; k < 4000; k++)
			check_step(&dome, &chance, here, there);
		free(here);
		free(there);
		dome_free(&dome);
	}
}

/* In the flat triangle of its lights' nodes, the ray of a direction meets their weighted mean. */
TEST("linear between nodes")
{
	struct chance chance = chance_begin("tents");

	for (int f = 3; f <= 9; f++) {
		struct dome dome = tents_of(f, f % 2);
		int inside = 0;

		for (int k = 0; k < 4000; k++) {
			int light[3];
			double dir[3], weight[3], mean[3] = {0}, across[3];
			int count;

			chance_direction(&chance, 0, dir);
			count = dome_weights(&dome, dir, light, weight);
			for (int n = 0; n < count; n++)
				for (int x = 0; x < 3; x++)
					mean[x] += weight[n] * dome.direction[light[n]][x];
			vec_cross(mean, dir, across);
			/* Above all triangles with a foot on the horizon. */
			if (dir[2] > 1.2 * atan(2) / f) {
				expect_below(vec_length(across), 1e-14, "f=%d, k=%d", f, k);
				inside++;
			}
		}
		expect_above(inside, 1500, "f=%d", f);
		dome_free(&dome);
	}
}

TEST("whole at the nodes")
{
	for (int f = 1; f <= 12; f++) {
		struct dome dome = tents_of(f, f % 2 ? DOME_ANGLES : DOME_CHORDS);

		for (int i = 0; i < dome.count; i++)
			expect_below(fabs(dome_weight(&dome, i, dome.direction[i]) - 1), 1e-9,
				     "f=%d, i=%d", f, i);
		dome_free(&dome);
	}
}

TEST("no direction")
{
	static const double none[][3] = {
		{0, 0, 0}, {NAN, 0, 1}, {0, 0, NAN}, {INFINITY, 0, 1}, {1, 0, -1e-300}};
	struct dome dome = tents_of(3, DOME_ANGLES);
	int light[3];
	double weight[3];

	for (size_t k = 0; k < sizeof(none) / sizeof(*none); k++)
		assert_int_equal(dome_weights(&dome, none[k], light, weight), 0);
	assert_true(dome_weights(&dome, (double[]){1, 0, -0.0}, light, weight) > 0);
	dome_free(&dome);
}

/* The mean of weight / density is the solid angle, that of weight * height / density the projected
 * one; and each sample is within reach. */
static void check_samples(const struct dome *dome, int light, double tolerance)
{
	const int side = 64;
	const double least = cos(dome_light_reach_rad(dome, light) + 1e-9);
	double sum = 0, projected = 0;

	for (int k = 0; k < side * side; k++) {
		double dir[3], each;

		dome_light_sample(dome, light, (k % side + 0.5) / side, (k / side + 0.5) / side,
				  dir);
		expect_that(fabs(vec_length(dir) - 1) < 1e-14 && dir[2] >= 0, "k=%d", k);
		expect_at_least(vec_dot(dir, dome->direction[light]), least, "k=%d", k);
		each = dome_weight(dome, light, dir) / dome_light_density(dome, light, dir);
		sum += each / (side * side);
		projected += each * dir[2] / (side * side);
	}
	assert_true(fabs(sum / dome->solid_angle_sr[light] - 1) < tolerance);
	assert_true(fabs(projected - dome->projected_sr[light]) <
		    tolerance * dome->solid_angle_sr[light]);
}

TEST("samples keep their order")
{
	for (int f = 1; f <= 9; f += 2)
		for (int division = 0; division < DOME_DIVISION_COUNT; division++) {
			struct dome dome = tents_of(f + (f > 3), division);

			for (int i = 0; i < dome.count; i++)
				check_samples(&dome, i, f == 1 ? 5e-3 : 2e-3);
			dome_free(&dome);
		}
}

/* Evenly spaced directions of the hemisphere, against the solid angles and densities that each
 * light declares. */
TEST("weights and densities against counting")
{
	static const int frequency[] = {1, 2, 5};
	const int count = 200000;

	for (int n = 0; n < 3; n++) {
		struct dome dome = tents_of(frequency[n], DOME_ANGLES);
		double *sum = calloc(2 * (size_t)dome.count, sizeof(*sum));

		assert_non_null(sum);
		for (int k = 0; k < count; k++) {
			const double z = (k + 0.5) / count,
				     turn = 2 * M_PI * k * 0.6180339887498949;
			const double dir[3] = {sqrt(1 - z * z) * cos(turn),
					       sqrt(1 - z * z) * sin(turn), z};
			double weight[3];
			int light[3];
			const int lights = dome_weights(&dome, dir, light, weight);

			for (int j = 0; j < lights; j++) {
				sum[2 * light[j]] += weight[j] * 2 * M_PI / count;
				sum[2 * light[j] + 1] += dome_light_density(&dome, light[j], dir) *
							 2 * M_PI / count;
			}
		}
		for (int i = 0; i < dome.count; i++) {
			expect_below(fabs(sum[2 * i] / dome.solid_angle_sr[i] - 1), 2e-3,
				     "n=%d, i=%d", n, i);
			expect_below(fabs(sum[2 * i + 1] - 1), 2e-3, "n=%d, i=%d", n, i);
		}
		free(sum);
		dome_free(&dome);
	}
}

TEST("samples at the limits")
{
	static const double limits[] = {0, 5e-324, 1e-17, 0.5, 0.9999999999999999};
	struct dome dome = tents_of(9, DOME_CHORDS);

	for (int i = 0; i < dome.count; i++)
		for (int k = 0; k < 25; k++) {
			double dir[3];

			dome_light_sample(&dome, i, limits[k % 5], limits[k / 5], dir);
			expect_below(fabs(vec_length(dir) - 1), 1e-14, "i=%d, k=%d", i, k);
			expect_above(vec_dot(dir, dome.direction[i]), 0.97, "i=%d, k=%d", i, k);
			expect_below(fabs(dome_weight(&dome, i, dir) /
						  dome_light_density(&dome, i, dir) /
						  dome.solid_angle_sr[i] -
					  1),
				     0.1, "i=%d, k=%d", i, k);
		}
	dome_free(&dome);
}

/* What the tests above check of tents holds of cells. */
TEST("cells are the other shape")
{
	struct chance chance = chance_begin("tents");
	struct dome dome;

	assert_int_equal(dome_create_shaped(&dome, 4, DOME_ANGLES, DOME_CELLS, NULL), 0);
	for (int k = 0; k < 1000; k++) {
		double dir[3], weight[3], drawn[3];
		const double u = chance_real(&chance, 0, 1), v = chance_real(&chance, 0, 1);
		int light[3];

		chance_direction(&chance, 0, dir);
		expect_equal(dome_weights(&dome, dir, light, weight), 1, "k=%d", k);
		expect_equal(light[0], dome_cell_of(&dome, dir), "k=%d", k);
		expect_equal(weight[0], 1, "k=%d", k);
		expect_equal(dome_light_density(&dome, light[0], dir),
			     1 / dome.solid_angle_sr[light[0]], "k=%d", k);
		dome_light_sample(&dome, light[0], u, v, drawn);
		dome_cell_sample(&dome, light[0], u, v, dir);
		assert_memory_equal(drawn, dir, sizeof(dir));
		expect_at_least(vec_dot(dir, dome.direction[light[0]]),
				cos(dome_light_reach_rad(&dome, light[0]) + 1e-9), "k=%d", k);
	}
	dome_free(&dome);
}

TEST("refused")
{
	struct fault fault = {""};
	struct dome dome;

	assert_int_equal(dome_create_shaped(&dome, 4, DOME_ANGLES, DOME_SHAPE_COUNT, &fault),
			 -EINVAL);
	assert_non_null(strstr(fault.text, "expected cells or tents"));
	assert_null(dome.direction);
}
