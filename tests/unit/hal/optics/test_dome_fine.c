/* SPDX-License-Identifier: MIT */
/* Domes that are finer in parts: their nodes are those of whole domes, their cells divide the
 * hemisphere. */
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/dome.h"
#include "hal/optics/dome_parts.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define DEGREE (M_PI / 180)

static struct dome_fine part_at(double azimuth, double height, double radius, int frequency)
{
	return (struct dome_fine){.direction = {cos(height * DEGREE) * cos(azimuth * DEGREE),
						cos(height * DEGREE) * sin(azimuth * DEGREE),
						sin(height * DEGREE)},
				  .radius_rad = radius * DEGREE,
				  .frequency = frequency};
}

static struct dome made(int frequency, const struct dome_fine *fine, int count)
{
	struct dome dome;
	struct fault fault = {.text = ""};
	int wrong;

	expect_success(dome_create_fine(&dome, frequency, fine, count, &wrong, &fault), &fault);
	return dome;
}

/* Index of the node in this direction; -1: there is none. */
static int node_at(const double (*node)[3], int count, const double d[3])
{
	for (int k = 0; k < count; k++)
		if (vec_angle(node[k], d) < 1e-12)
			return k;
	return -1;
}

TEST("nodes are those of whole domes")
{
	const struct dome_fine fine[] = {part_at(120, 35, 2, 18), part_at(-20, 8, 1, 72)};
	struct dome base = made(9, NULL, 0);
	struct dome dome = made(9, fine, 2);
	int of[2] = {0, 0};

	for (int i = 0; i < base.count; i++)
		expect_equal(memcmp(dome.direction[i], base.direction[i], sizeof(*base.direction)),
			     0, "i=%d", i);
	for (int f = 0; f < 2; f++) {
		const int count = dome_node_count(fine[f].frequency);
		double(*node)[3] = calloc((size_t)count, sizeof(*node));

		assert_int_equal(dome_nodes_fill(fine[f].frequency, node), 0);
		for (int i = base.count; i < dome.count; i++)
			of[f] += node_at((const double(*)[3])node, count, dome.direction[i]) >= 0 &&
				 vec_angle(dome.direction[i], fine[f].direction) < 15 * DEGREE;
		free(node);
	}
	assert_int_equal(of[0] + of[1], dome.count - base.count);
	assert_in_range(of[0], 3, 16);
	assert_in_range(of[1], 60, 300);
	dome_free(&base);
	dome_free(&dome);
}

/* Cells far from a part stay as they are; around its middle they are those of the finer dome. */
TEST("cells are fine where asked")
{
	const struct dome_fine fine[] = {part_at(200, 40, 5, 36)};
	struct dome base = made(9, NULL, 0);
	struct dome finer = made(36, NULL, 0);
	struct dome dome = made(9, fine, 1);
	struct chance chance = chance_begin("cells_are_fine_where_asked");

	for (int i = 0; i < base.count; i++)
		if (vec_angle(base.direction[i], fine[0].direction) > 30 * DEGREE)
			expect_below(fabs(dome.solid_angle_sr[i] / base.solid_angle_sr[i] - 1),
				     1e-12, "i=%d", i);
	for (int k = 0; k < 200; k++) {
		const struct dome_fine within = part_at(200 + chance_real(&chance, -4, 4),
							40 + chance_real(&chance, -3, 3), 0, 36);
		const int own = dome_cell_of(&dome, within.direction);
		const int same = dome_cell_of(&finer, within.direction);

		expect_below(vec_angle(dome.direction[own], finer.direction[same]), 1e-9, "k=%d",
			     k);
		expect_below(fabs(dome.solid_angle_sr[own] / finer.solid_angle_sr[same] - 1), 1e-9,
			     "k=%d", k);
	}
	dome_free(&base);
	dome_free(&finer);
	dome_free(&dome);
}

/* Solid angles sum to the hemisphere, and the cell of a direction is that of the nearest node. */
static void check_whole(const struct dome *dome, struct chance *chance)
{
	double sum = 0, projected = 0;

	for (int i = 0; i < dome->count; i++) {
		sum += dome->solid_angle_sr[i];
		projected += dome->projected_sr[i];
		expect_above(dome->solid_angle_sr[i], 0, "i=%d", i);
	}
	expect_below(fabs(sum - 2 * M_PI), 1e-11, "%d lights", dome->count);
	expect_below(fabs(projected - M_PI), 1e-11, "%d lights", dome->count);
	for (int k = 0; k < 500; k++) {
		double d[3] = {chance_real(chance, -1, 1), chance_real(chance, -1, 1),
			       chance_real(chance, 0, 1)};
		double best = -1;
		int nearest = -1;

		for (int i = 0; i < dome->count; i++)
			if (vec_dot(dome->direction[i], d) > best) {
				best = vec_dot(dome->direction[i], d);
				nearest = i;
			}
		expect_equal(dome_cell_of(dome, d), nearest, "k=%d", k);
	}
}

TEST("all parts divide the hemisphere")
{
	const struct dome_fine fine[] = {
		part_at(0, 90, 3, 18),	 part_at(30, 0, 2, 72),	  part_at(-90, 3, 8, 36),
		part_at(140, 45, 1, 54), part_at(143, 47, 6, 27), part_at(-10, 60, 90, 9),
	};
	struct chance chance = chance_begin("all_shapes_divide_the_hemisphere");

	for (int n = 1; n <= 6; n++) {
		struct dome dome = made(9, fine, n);

		check_whole(&dome, &chance);
		dome_free(&dome);
	}
}

/* A coarse cell among fine ones has hundreds of corners. */
TEST("a coarse cell among fine ones")
{
	const struct dome_fine around[] = {part_at(0, 60, 20, 72), part_at(120, 60, 20, 72),
					   part_at(-120, 60, 20, 72)};
	struct dome_fine ring[5];
	struct chance chance = chance_begin("a_coarse_cell_among_fine_ones");

	for (int k = 0; k < 5; k++)
		ring[k] = part_at(72 * k, 26, 0, 72);
	for (int base = 1; base <= (thorough() ? 3 : 1); base += 2) {
		struct dome dome = made(base, base == 1 ? ring : around, base == 1 ? 5 : 3);

		check_whole(&dome, &chance);
		dome_free(&dome);
	}
}

/* A part that is the whole sky gives all nodes of the finer dome. */
TEST("a whole sky")
{
	const struct dome_fine fine = part_at(0, 90, 90, 18);
	struct dome dome = made(9, &fine, 1);
	struct dome whole = made(18, NULL, 0);

	assert_int_equal(dome.count, whole.count);
	for (int i = 0; i < whole.count; i++) {
		const int own = dome_cell_of(&dome, whole.direction[i]);

		expect_below(fabs(dome.solid_angle_sr[own] / whole.solid_angle_sr[i] - 1), 1e-9,
			     "i=%d", i);
	}
	dome_free(&dome);
	dome_free(&whole);
}

/* A reader of a file makes the same dome from its nodes, to the bit. */
TEST("the same from its nodes")
{
	const struct dome_fine fine[] = {part_at(77, 5, 3, 72)};
	struct fault fault = {.text = ""};
	struct dome dome = made(9, fine, 1), again;

	expect_success(dome_create_nodes(&again, dome.direction[0], 3, dome.count, 9, &fault),
		       &fault);
	assert_int_equal(again.count, dome.count);
	assert_memory_equal(again.solid_angle_sr, dome.solid_angle_sr,
			    (size_t)dome.count * sizeof(double));
	assert_memory_equal(again.projected_sr, dome.projected_sr,
			    (size_t)dome.count * sizeof(double));
	dome_free(&dome);
	dome_free(&again);
}

TEST("refused")
{
	const struct dome_fine fine[] = {part_at(0, 40, 2, 18), part_at(50, 40, 2, 20)};
	const struct dome_fine below = part_at(0, -1, 2, 18);
	double node[4][3] = {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-0.6, -0.8, 0}};
	struct fault fault = {.text = ""};
	struct dome dome;
	int wrong;

	assert_int_equal(dome_create_fine(&dome, 9, fine, 2, &wrong, &fault), -EINVAL);
	assert_int_equal(wrong, 1);
	assert_string_equal(fault.text,
			    "frequency is 20, expected a multiple of the dome's 9 up to 72");
	assert_int_equal(dome_create_fine(&dome, 9, &below, 1, &wrong, &fault), -EINVAL);
	assert_string_equal(fault.text, "is below the horizon");
	assert_int_equal(dome_create_nodes(&dome, node[0], 3, 4, 0, &fault), 0);
	dome_free(&dome);
	assert_int_equal(dome_create_nodes(&dome, node[0], 3, 0, 0, &fault), -EINVAL);
	for (int k = 0; k < 3; k++) {
		const double wrongs[3][3] = {{0, 0, -1}, {0, 0, 0.5}, {0, 0.001, 0.9999995}};

		memcpy(node[3], wrongs[k], sizeof(node[3]));
		expect_equal(dome_create_nodes(&dome, node[0], 3, 4, 0, &fault), -EINVAL, "k=%d",
			     k);
		expect_equal(dome.count, 0, "k=%d", k);
	}
}
