/* SPDX-License-Identifier: MIT */
/* The dome: counts, nodes, exact cells and samples of them, each against brute force. */
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

static struct dome dome_of(int frequency)
{
	struct dome dome;

	assert_int_equal(dome_create(&dome, frequency, NULL), 0);
	return dome;
}

/* ---- nodes ---- */

TEST("published counts")
{
	static const int frequency[] = {1, 2, 3, 4, 6, 9};
	static const int count[] = {6, 26, 46, 86, 186, 406};

	for (int i = 0; i < 6; i++) {
		struct dome dome = dome_of(frequency[i]);

		expect_equal(dome.count, count[i], "i=%d", i);
		dome_free(&dome);
	}
}

static void check_nodes(int f, const double (*node)[3], int count)
{
	const int on_horizon = f % 2 ? 0 : 10;
	double lowest = 1;
	int horizon = 0;

	/* half of all 10 f^2 + 2 nodes, and the other half of the nodes on the horizon */
	assert_int_equal(count, 5 * f * f + 1 + on_horizon / 2);
	assert_true(node[0][0] == 0 && node[0][1] == 0 && node[0][2] == 1);
	for (int i = 0; i < count; i++) {
		expect_below(fabs(vec_length(node[i]) - 1), 3e-16, "i=%d", i);
		expect_at_least(node[i][2], 0, "i=%d", i);
		horizon += node[i][2] == 0;
		if (node[i][2] > 0)
			lowest = fmin(lowest, node[i][2]);
	}
	assert_int_equal(horizon, on_horizon);
	/* ten decades above rounding, so that every machine puts a node on the same side */
	assert_true(lowest > 3e-6);
}

/* Azimuth in 0..2 pi; a value that rounding puts just below 0 becomes 0. */
static double azimuth(const double d[3])
{
	const double phi = atan2(d[1], d[0]);

	return phi < -1e-9 ? phi + 2 * M_PI : phi;
}

/* Checks the order of lights, because files refer to lights by index: rows from the zenith down,
 * each from azimuth 0 on. */
static void check_order(int f, const double (*node)[3])
{
	for (int row = 1; row <= f; row++) { /* the cap: each row has 5 nodes more */
		const int first = 1 + 5 * row * (row - 1) / 2;

		expect_below(fabs(azimuth(node[first])), 1e-14, "row=%d", row);
		for (int i = first + 1; i < first + 5 * row; i++)
			expect_above(azimuth(node[i]), azimuth(node[i - 1]), "row=%d, i=%d", row,
				     i);
	}
}

TEST("counts and order of all frequencies")
{
	for (int f = 1; f <= DOME_FREQUENCY_MAX; f++) {
		const int count = dome_node_count(f);
		double(*node)[3] = calloc((size_t)count, sizeof(*node));

		assert_non_null(node);
		assert_int_equal(dome_nodes_fill(f, node), 0);
		check_nodes(f, (const double(*)[3])node, count);
		check_order(f, (const double(*)[3])node);
		free(node);
	}
}

static void point_between(const double a[3], const double b[3], double t, double out[3])
{
	const double angle = acos(fmin(1, vec_dot(a, b)));

	for (int k = 0; k < 3; k++)
		out[k] = angle < 1e-9 ? a[k]
				      : (sin((1 - t) * angle) * a[k] + sin(t * angle) * b[k]) /
						sin(angle);
}

/* A node of any face: the mean of the three ways that the thesis allows. */
static void face_node(const double (*corner)[3], const int weight[3], double out[3])
{
	const int f = weight[0] + weight[1] + weight[2];

	out[0] = out[1] = out[2] = 0;
	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, l = (i + 2) % 3;
		double m[3], p[3];

		point_between(corner[j], corner[l],
			      weight[i] == f ? 0 : (double)weight[l] / (weight[j] + weight[l]), m);
		point_between(corner[i], m, (double)(weight[j] + weight[l]) / f, p);
		for (int k = 0; k < 3; k++)
			out[k] += p[k];
	}
	vec_normalize(out);
}

static void icosahedron(double vertex[12][3])
{
	const double z = 1 / sqrt(5), r = 2 / sqrt(5);

	memset(vertex, 0, 12 * sizeof(vertex[0]));
	vertex[0][2] = 1;
	vertex[11][2] = -1;
	for (int i = 0; i < 5; i++) {
		const double upper = i * 2 * M_PI / 5, lower = upper + M_PI / 5;

		vertex[1 + i][0] = r * cos(upper);
		vertex[1 + i][1] = r * sin(upper);
		vertex[1 + i][2] = z;
		vertex[6 + i][0] = r * cos(lower);
		vertex[6 + i][1] = r * sin(lower);
		vertex[6 + i][2] = -z;
	}
}

static bool adjacent(const double a[3], const double b[3])
{
	return fabs(vec_dot(a, b) - 1 / sqrt(5)) < 1e-9;
}

/* Finds the nearest node of the dome; returns its distance. */
static double nearest_node(const struct dome *dome, const double p[3], int *index)
{
	double best = INFINITY;

	for (int i = 0; i < dome->count; i++) {
		const double *d = dome->direction[i];
		const double far = hypot(hypot(d[0] - p[0], d[1] - p[1]), d[2] - p[2]);

		if (far < best) {
			best = far;
			*index = i;
		}
	}
	return best;
}

/* Divides all twenty faces alike and looks up each node in the dome. Shared edges must meet, no
 * node may be missing, and none may be left over. */
static void check_against_all_faces(int f)
{
	struct dome dome = dome_of(f);
	bool *met = calloc((size_t)dome.count, sizeof(*met));
	double vertex[12][3];
	int faces = 0;

	assert_non_null(met);
	icosahedron(vertex);
	for (int a = 0; a < 12; a++)
		for (int b = a + 1; b < 12; b++)
			for (int c = b + 1; c < 12; c++) {
				double corner[3][3];

				if (!adjacent(vertex[a], vertex[b]) ||
				    !adjacent(vertex[b], vertex[c]) ||
				    !adjacent(vertex[a], vertex[c]))
					continue;
				faces++;
				memcpy(corner[0], vertex[a], sizeof(corner[0]));
				memcpy(corner[1], vertex[b], sizeof(corner[0]));
				memcpy(corner[2], vertex[c], sizeof(corner[0]));
				for (int i = 0; i <= f; i++)
					for (int j = 0; j <= f - i; j++) {
						const int weight[3] = {f - i - j, i, j};
						double p[3];
						int index = -1;

						face_node((const double(*)[3])corner, weight, p);
						if (p[2] < -1e-9)
							continue;
						expect_below(nearest_node(&dome, p, &index), 1e-14,
							     "a=%d, b=%d, c=%d, i=%d, j=%d", a, b,
							     c, i, j);
						met[index] = true;
					}
			}
	assert_int_equal(faces, 20);
	for (int i = 0; i < dome.count; i++)
		assert_true(met[i]);
	free(met);
	dome_free(&dome);
}

TEST("nodes of all faces")
{
	static const int frequency[] = {1, 2, 3, 4, 5, 6, 9, 12};

	for (unsigned i = 0; i < sizeof(frequency) / sizeof(*frequency); i++)
		check_against_all_faces(frequency[i]);
}

/* Along an edge from the zenith down: equal steps of angle. */
TEST("division of an edge")
{
	const int f = 6;
	struct dome angles = dome_of(f);

	for (int row = 1; row <= f; row++) {
		const int first = 1 + 5 * row * (row - 1) / 2; /* at azimuth 0 */
		const double *d = angles.direction[first];
		double theta, phi;

		dome_angles(&angles, first, &theta, &phi);
		expect_that(fabs(theta - row * atan(2) / f) < 1e-14 && fabs(phi) < 1e-14, "row=%d",
			    row);
		expect_below(fabs(d[0] - sin(theta)), 1e-14, "row=%d", row);
	}
	dome_free(&angles);
}

/* ---- cells ---- */

static void check_sums(int f)
{
	struct dome dome = dome_of(f);
	double sum = 0, projected = 0;

	for (int i = 0; i < dome.count; i++) {
		const double mean = 2 * M_PI / dome.count;

		sum += dome.solid_angle_sr[i];
		projected += dome.projected_sr[i];
		expect_above(dome.solid_angle_sr[i], 0.3 * mean, "i=%d", i);
		expect_below(dome.solid_angle_sr[i], 1.7 * mean, "i=%d", i);
		expect_above(dome.projected_sr[i], 0, "i=%d", i);
		expect_below(dome.projected_sr[i], dome.solid_angle_sr[i], "i=%d", i);
	}
	assert_true(fabs(sum - 2 * M_PI) < 1e-12);
	assert_true(fabs(projected - M_PI) < 1e-12);
	dome_free(&dome);
}

TEST("weights sum to the hemisphere")
{
	static const int large[] = {27, 36, 45, 54, 63, 72};
	const unsigned count = thorough() ? sizeof(large) / sizeof(*large) : 2;

	for (int f = 1; f <= 20; f++)
		check_sums(f);
	for (unsigned i = 0; i < count; i++)
		check_sums(large[i]);
}

/* f = 1: the cell of the zenith is a twelfth of the sphere; by symmetry the other five, cut at the
 * horizon, share the rest. */
TEST("weights of the icosahedron")
{
	struct dome dome = dome_of(1);

	for (int i = 0; i < 6; i++)
		expect_below(fabs(dome.solid_angle_sr[i] - M_PI / 3), 1e-14, "i=%d", i);
	dome_free(&dome);
}

static int brute_force(const struct dome *dome, const double dir[3])
{
	double best = -INFINITY;
	int found = -1;

	for (int i = 0; i < dome->count; i++) {
		const double near = vec_dot(dome->direction[i], dir);

		if (near > best) {
			best = near;
			found = i;
		}
	}
	return found;
}

TEST("weights against counting")
{
	const int samples = 2000000;
	struct chance chance = chance_begin("dome");

	struct dome dome = dome_of(4);
	double *hits = calloc((size_t)dome.count, sizeof(*hits));
	double *cosines = calloc((size_t)dome.count, sizeof(*cosines));

	assert_non_null(hits);
	assert_non_null(cosines);
	for (int n = 0; n < samples; n++) {
		double dir[3];
		int i;

		chance_direction(&chance, 0, dir);
		i = brute_force(&dome, dir);
		hits[i]++;
		cosines[i] += dir[2];
	}
	for (int i = 0; i < dome.count; i++) {
		const double unit = 2 * M_PI / samples;
		const double slack = 6 * sqrt(hits[i]) * unit;

		expect_below(fabs(hits[i] * unit - dome.solid_angle_sr[i]), slack, "i=%d", i);
		expect_below(fabs(cosines[i] * unit - dome.projected_sr[i]), slack, "i=%d", i);
	}
	free(hits);
	free(cosines);
	dome_free(&dome);
}

/* Turned by a fifth of a turn, or mirrored in y = 0, the dome is the same, weights included. */
TEST("five fold symmetry")
{
	static const int frequency[] = {2, 5, 9, 18};
	const double c = cos(2 * M_PI / 5), s = sin(2 * M_PI / 5);

	for (int n = 0; n < 4; n++) {
		struct dome dome = dome_of(frequency[n]);

		for (int i = 0; i < dome.count; i++) {
			const double *d = dome.direction[i];
			const double turned[3] = {c * d[0] - s * d[1], s * d[0] + c * d[1], d[2]};
			const double mirrored[3] = {d[0], -d[1], d[2]};
			int a = -1, b = -1;

			expect_below(nearest_node(&dome, turned, &a), 1e-14, "n=%d, i=%d", n, i);
			expect_below(nearest_node(&dome, mirrored, &b), 1e-14, "n=%d, i=%d", n, i);
			expect_below(fabs(dome.solid_angle_sr[i] - dome.solid_angle_sr[a]), 1e-14,
				     "n=%d, i=%d", n, i);
			expect_below(fabs(dome.solid_angle_sr[i] - dome.solid_angle_sr[b]), 1e-14,
				     "n=%d, i=%d", n, i);
			expect_below(fabs(dome.projected_sr[i] - dome.projected_sr[a]), 1e-14,
				     "n=%d, i=%d", n, i);
		}
		dome_free(&dome);
	}
}

/* A corner is as far from its own node as from the nearest of all nodes, and lies on the horizon
 * unless three nodes are that near. */
TEST("corners lie between nodes")
{
	for (int n = 0; n < 12; n++) {
		struct dome dome = dome_of(1 + n);

		for (int i = 0; i < dome.count; i++) {
			double corner[32][3], normal[3];
			const int count = dome_cell_corners(&dome, i, corner, 32);

			assert_in_range(count, 3, 8);
			for (int k = 0; k < count; k++) {
				const double own = vec_dot(dome.direction[i], corner[k]);
				int near = 0;

				expect_below(fabs(vec_length(corner[k]) - 1), 1e-15,
					     "n=%d, i=%d, k=%d", n, i, k);
				expect_at_least(corner[k][2], 0, "n=%d, i=%d, k=%d", n, i, k);
				for (int j = 0; j < dome.count; j++) {
					const double other = vec_dot(dome.direction[j], corner[k]);

					expect_at_most(other, own + 1e-14, "n=%d, i=%d, k=%d, j=%d",
						       n, i, k, j);
					near += other > own - 1e-13;
				}
				expect_that(near >= 3 || corner[k][2] == 0, "n=%d, i=%d, k=%d", n,
					    i, k);
				/* counter-clockwise seen from outside */
				vec_cross(corner[k], corner[(k + 1) % count], normal);
				expect_above(vec_dot(normal, dome.direction[i]), -1e-15,
					     "n=%d, i=%d, k=%d", n, i, k);
			}
			expect_equal(dome_cell_corners(&dome, i, NULL, 0), count, "n=%d, i=%d", n,
				     i);
		}
		dome_free(&dome);
	}
}

/* ---- the cell of a direction ---- */

static void check_cell_of(const struct dome *dome, const double dir[3])
{
	assert_int_equal(dome_cell_of(dome, dir), dir[2] >= 0 ? brute_force(dome, dir) : -1);
}

TEST("cell of any direction")
{
	static const int frequency[] = {1, 2, 3, 4, 7, 9, 18, 36, 72};
	const int most = thorough() ? 100000 : 20000;
	struct chance chance = chance_begin("dome");

	for (int n = 0; n < (thorough() ? 9 : 8); n++) {
		const int f = frequency[n];
		struct dome dome = dome_of(f);

		for (int k = 0; k < (f > 32 ? most / 10 : most); k++) {
			const double size = pow(10, chance_real(&chance, -100, 100));
			double dir[3];

			chance_direction(&chance, -0.1, dir);
			for (int c = 0; c < 3; c++)
				dir[c] *= size;
			check_cell_of(&dome, dir);
		}
		dome_free(&dome);
	}
}

/* Directions where cells, cells of the lookup grid, quadrants and the horizon meet. */
TEST("cell of borders")
{
	struct chance chance = chance_begin("dome");

	for (int n = 0; n < 10; n++) {
		struct dome dome = dome_of(1 + n);

		for (int i = 0; i < dome.count; i++) {
			double corner[32][3];
			const int count = dome_cell_corners(&dome, i, corner, 32);

			expect_equal(dome_cell_of(&dome, dome.direction[i]), i, "n=%d, i=%d", n, i);
			for (int k = 0; k < count; k++) {
				const double *a = corner[k], *b = corner[(k + 1) % count];
				const double t = chance_real(&chance, 0, 1);
				const double edge[3] = {a[0] + t * (b[0] - a[0]),
							a[1] + t * (b[1] - a[1]),
							a[2] + t * (b[2] - a[2])};

				check_cell_of(&dome, a);
				check_cell_of(&dome, edge);
				for (int c = 0; c < 3; c++) {
					double shifted[3] = {a[0], a[1], a[2]};

					shifted[c] = nextafter(shifted[c], 2);
					check_cell_of(&dome, shifted);
					shifted[c] = nextafter(nextafter(a[c], -2), -2);
					check_cell_of(&dome, shifted);
				}
			}
			for (int j = 0; j < i; j++) { /* half way between any two nodes */
				double half[3];

				for (int c = 0; c < 3; c++)
					half[c] = dome.direction[i][c] + dome.direction[j][c];
				if (vec_length(half) > 1e-9)
					check_cell_of(&dome, half);
			}
		}
		for (int a = -8; a <= 8; a++)
			for (int b = -8; b <= 8; b++)
				for (int c = 0; c <= 8; c++)
					if (a || b || c)
						check_cell_of(&dome, (double[]){a, b, c});
		dome_free(&dome);
	}
}

TEST("cell of no direction")
{
	struct dome dome = dome_of(4);

	assert_int_equal(dome_cell_of(&dome, (double[]){0, 0, 0}), -1);
	assert_int_equal(dome_cell_of(&dome, (double[]){NAN, 0, 1}), -1);
	assert_int_equal(dome_cell_of(&dome, (double[]){0, 0, NAN}), -1);
	assert_int_equal(dome_cell_of(&dome, (double[]){INFINITY, 0, 1}), -1);
	assert_int_equal(dome_cell_of(&dome, (double[]){1, 0, -1e-300}), -1);
	assert_true(dome_cell_of(&dome, (double[]){1, 0, -0.0}) >= 0);
	dome_free(&dome);
}

/* ---- samples ---- */

#define SECTORS 8
#define BINS (2 * SECTORS)

/* Part of the cell that a direction lies in: angle around the node, and near or far. */
static int bin_of(const double node[3], const double dir[3], double near)
{
	const double axis[3] = {0.3, 0.5, 0.8};
	double e1[3], e2[3], angle;

	vec_cross(axis, node, e1);
	vec_normalize(e1);
	vec_cross(node, e1, e2);
	angle = atan2(vec_dot(dir, e2), vec_dot(dir, e1));
	return (int)fmin(SECTORS - 1, (angle + M_PI) / (2 * M_PI) * SECTORS) +
	       (vec_dot(dir, node) > near ? SECTORS : 0);
}

/* Each part of the cell holds as large a share of its samples as of uniform directions in the cell.
 */
static void check_samples(const struct dome *dome, int light, struct chance *chance)
{
	const double radius = sqrt(dome->solid_angle_sr[light] / (2 * M_PI));
	const double near = cos(radius);
	double ours[BINS] = {0}, theirs[BINS] = {0}, chi = 0;
	const int samples = 20000;
	int accepted = 0;

	for (int k = 0; k < samples; k++) {
		double dir[3];

		dome_cell_sample(dome, light, chance_real(chance, 0, 1), chance_real(chance, 0, 1),
				 dir);
		expect_that(fabs(vec_length(dir) - 1) < 1e-14 && dir[2] >= 0, "k=%d", k);
		expect_at_least(vec_dot(dome->direction[light], dir),
				vec_dot(dome->direction[brute_force(dome, dir)], dir) - 1e-14,
				"k=%d", k);
		ours[bin_of(dome->direction[light], dir, near)]++;
	}
	while (accepted < samples) {
		double dir[3];

		chance_direction(chance, 0, dir);
		if (vec_dot(dir, dome->direction[light]) < cos(4 * radius) ||
		    brute_force(dome, dir) != light)
			continue;
		theirs[bin_of(dome->direction[light], dir, near)]++;
		accepted++;
	}
	for (int b = 0; b < BINS; b++)
		if (ours[b] + theirs[b] > 0)
			chi += pow(ours[b] - theirs[b], 2) / (ours[b] + theirs[b]);
	/* Chi squared has mean BINS and this deviation. */
	assert_true(chi < BINS + 8 * sqrt(2.0 * BINS));
}

TEST("samples are uniform")
{
	static const int lights[] = {0, 1, 5, 20, 40, 60, 76, 80, 85};
	struct chance chance = chance_begin("dome");

	struct dome dome = dome_of(4);

	for (unsigned i = 0; i < sizeof(lights) / sizeof(*lights); i += thorough() ? 1 : 4)
		check_samples(&dome, lights[i], &chance);
	dome_free(&dome);
}

/* Samples on a grid integrate smooth functions far better than random ones: the mean direction of a
 * cell, against its exact vector area. */
TEST("samples keep their order")
{
	struct dome dome = dome_of(9);
	const int side = 32;

	for (int i = 0; i < dome.count; i++) {
		double sum = 0;

		for (int k = 0; k < side * side; k++) {
			double dir[3];

			dome_cell_sample(&dome, i, (k % side + 0.5) / side, (k / side + 0.5) / side,
					 dir);
			sum += dir[2];
		}
		sum *= dome.solid_angle_sr[i] / (side * side);
		expect_below(fabs(sum - dome.projected_sr[i]), 2e-4 * dome.solid_angle_sr[i],
			     "i=%d", i);
	}
	dome_free(&dome);
}

TEST("samples at the limits")
{
	static const double limits[] = {0, 5e-324, 1e-17, 0.5, 0.9999999999999999};
	struct dome dome = dome_of(12);

	for (int i = 0; i < dome.count; i++)
		for (int k = 0; k < 25; k++) {
			double dir[3];

			dome_cell_sample(&dome, i, limits[k % 5], limits[k / 5], dir);
			expect_below(fabs(vec_length(dir) - 1), 1e-14, "i=%d, k=%d", i, k);
			expect_above(vec_dot(dir, dome.direction[i]), 0.98, "i=%d, k=%d", i, k);
		}
	dome_free(&dome);
}

TEST("refused")
{
	struct fault fault = {""};
	struct dome dome;

	assert_int_equal(dome_create(&dome, 0, &fault), -EINVAL);
	assert_true(strlen(fault.text) > 0);
	assert_int_equal(dome_create(&dome, 73, NULL), -EINVAL);
	assert_null(dome.direction);
	dome_free(&dome);
	dome_free(&dome);
}
