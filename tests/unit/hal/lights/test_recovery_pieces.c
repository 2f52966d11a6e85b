/* SPDX-License-Identifier: MIT */
/* The clipped lights that belong to one piece. */
#include <stdbool.h>

#include <math.h>
#include <stdlib.h>

#include "hal/lights/recovery.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static int at(const struct dome *dome, double height_deg, double azimuth_deg)
{
	const double h = height_deg * M_PI / 180, a = azimuth_deg * M_PI / 180;
	const double direction[3] = {cos(h) * cos(a), cos(h) * sin(a), sin(h)};

	return dome_cell_of(dome, direction);
}

static bool is_on_horizon(const struct dome *dome, int light)
{
	double corner[16][3];
	const int corners = dome_cell_corners(dome, light, corner, 16);

	for (int k = 0; k < corners; k++)
		if (corner[k][2] == 0)
			return true;
	return false;
}

TEST("what touches is one piece")
{
	static const int frequencies[] = {1, 4, 9};
	struct clipped_pieces *pieces;
	struct fault fault = {.text = ""};
	struct dome dome;
	float *clipped;

	for (size_t n = 0; n < sizeof(frequencies) / sizeof(*frequencies); n++) {
		const double *size;
		double ring = 0;
		int top;

		assert_int_equal(dome_create(&dome, frequencies[n], &fault), 0);
		assert_int_equal(clipped_pieces_create(&pieces, &dome), 0);
		clipped = calloc((size_t)dome.count, sizeof(*clipped));
		assert_non_null(clipped);
		size = clipped_pieces_find(pieces, clipped);
		for (int i = 0; i < dome.count; i++)
			expect_equal(size[i], 0, "n=%zu, i=%d", n, i);
		for (int i = 0; i < dome.count; i++)
			clipped[i] = 1;
		size = clipped_pieces_find(pieces, clipped);
		for (int i = 0; i < dome.count; i++)
			expect_below(fabs(size[i] / (2 * M_PI) - 1), 1e-12, "n=%zu, i=%d", n, i);
		/* The cells on the horizon form a ring, far from the zenith. */
		top = at(&dome, 90, 0);
		for (int i = 0; i < dome.count; i++) {
			clipped[i] = i != top && is_on_horizon(&dome, i) ? 0.5f : 0;
			ring += (double)clipped[i] * dome.solid_angle_sr[i];
		}
		clipped[top] = frequencies[n] > 1 ? 0.25f : 0;
		size = clipped_pieces_find(pieces, clipped);
		for (int i = 0; i < dome.count; i++) {
			const double is = i == top ? (double)clipped[i] * dome.solid_angle_sr[i]
					  : clipped[i] > 0 ? ring
							   : 0;

			expect_at_most(fabs(size[i] - is), 1e-12, "n=%zu, i=%d", n, i);
		}
		free(clipped);
		clipped_pieces_destroy(pieces);
		dome_free(&dome);
	}
}

TEST("two lamps are two pieces")
{
	struct clipped_pieces *pieces;
	struct fault fault = {.text = ""};
	float clipped[500] = {0};
	const double *size;
	struct dome dome;
	int a, b, c;

	assert_int_equal(dome_create(&dome, 9, &fault), 0);
	assert_int_equal(clipped_pieces_create(&pieces, &dome), 0);
	a = at(&dome, 40, 0);
	b = at(&dome, 40, 9);
	c = at(&dome, 40, 30);
	assert_true(a != b && b != c);
	clipped[a] = clipped[b] = clipped[c] = 1;
	size = clipped_pieces_find(pieces, clipped);
	assert_true(fabs(size[a] - dome.solid_angle_sr[a] - dome.solid_angle_sr[b]) < 1e-12);
	assert_true(size[b] == size[a] && size[c] == dome.solid_angle_sr[c]);
	for (int azimuth = 9; azimuth < 30; azimuth++) /* a bridge between two pieces */
		clipped[at(&dome, 40, azimuth)] = 1;
	size = clipped_pieces_find(pieces, clipped);
	assert_true(size[c] == size[a] && size[a] > 4 * dome.solid_angle_sr[a]);
	clipped[a] = clipped[c] = NAN;
	size = clipped_pieces_find(pieces, clipped);
	assert_true(size[a] == 0 && size[c] == 0 && size[b] > 0);
	clipped_pieces_destroy(pieces);
	clipped_pieces_destroy(NULL);
	dome_free(&dome);
}
