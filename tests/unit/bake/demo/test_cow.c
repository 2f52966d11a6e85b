/* SPDX-License-Identifier: MIT */
/* The demo's toy cow: is its mesh closed, outward and well shaped, and is its texture its coat? */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/demo/atlas.h"
#include "bake/demo/cow_coat.h"
#include "bake/demo/cow_shape.h"
#include "hal/optics/vec.h"
#include "tests/support/expect.h"

#define SEED 20240607u

static struct trimesh parts[COW_PARTS];

static double uniform(uint32_t *state)
{
	*state = *state * 1664525u + 1013904223u;
	return (*state >> 8) / 16777216.0;
}

static int make_parts(void **state)
{
	(void)state;
	for (int k = 0; k < COW_PARTS; k++)
		if (polygonise(&parts[k], &cow_parts[k].solid, cow_parts[k].step))
			return -1;
	return 0;
}

static int free_parts(void **state)
{
	(void)state;
	for (int k = 0; k < COW_PARTS; k++)
		trimesh_free(&parts[k]);
	return 0;
}

/* ---- the functions of space ---- */

typedef struct implicit (*implicit_at)(const double p[3]);

static struct implicit turned_ellipsoid(const double p[3])
{
	const struct ellipsoid shape = {{0.1, -0.2, 0.3}, {0.5, 0.2, 0.3}, {20, -35, 50}};

	return implicit_ellipsoid(&shape, p);
}

static struct implicit some_cone(const double p[3])
{
	const struct round_cone shape = {{{-0.3, 0.1, 0}, {0.4, -0.2, 0.3}}, {0.2, 0.05}};

	return implicit_round_cone(&shape, p);
}

static struct implicit some_ring(const double p[3])
{
	const struct ring shape = {{0.1, 0, -0.1}, {0.5, 0.3}, {0.08, 0.15}, 25};

	return implicit_ring(&shape, p);
}

static struct implicit joined(const double p[3])
{
	const struct implicit cut = implicit_difference(turned_ellipsoid(p), some_ring(p), 0.3);

	return implicit_intersection(implicit_union(cut, some_cone(p), 0.4),
				     implicit_above(-0.2, p), 0.1);
}

static void gradients_match_differences(void **state)
{
	static const implicit_at shapes[] = {turned_ellipsoid, some_cone, some_ring, joined};
	uint32_t seed = SEED;

	(void)state;
	print_message("# seed %u\n", seed);
	for (size_t s = 0; s < sizeof(shapes) / sizeof(*shapes); s++) {
		for (int k = 0; k < 2000; k++) {
			const double h = 1e-5;
			double p[3];
			struct implicit f;

			for (int i = 0; i < 3; i++)
				p[i] = 2 * uniform(&seed) - 1;
			f = shapes[s](p);
			for (int i = 0; i < 3; i++) {
				double up[3] = {p[0], p[1], p[2]}, down[3] = {p[0], p[1], p[2]};
				double slope;

				up[i] += h;
				down[i] -= h;
				slope = (shapes[s](up).value - shapes[s](down).value) / (2 * h);
				/* The pseudo-distances bend sharply near their centres, hence the
				 * tolerance. */
				expect_below(fabs(slope - f.gradient[i]), 2e-3, "s=%zu, k=%d, i=%d",
					     s, k, i);
			}
		}
	}
}

/* Distance to a cone: the smallest distance to any of the balls along its axis, by brute force. */
static void cone_is_the_distance(void **state)
{
	uint32_t seed = SEED;

	(void)state;
	for (int k = 0; k < 200; k++) {
		double p[3], least = 1e9;

		for (int i = 0; i < 3; i++)
			p[i] = 2 * uniform(&seed) - 1;
		for (int n = 0; n <= 20000; n++) {
			const double t = n / 20000.0;
			const double away[3] = {p[0] - (-0.3 + 0.7 * t), p[1] - (0.1 - 0.3 * t),
						p[2] - 0.3 * t};

			least = fmin(least, vec_length(away) - (0.2 - 0.15 * t));
		}
		expect_below(fabs(some_cone(p).value - least), 1e-6, "k=%d", k);
	}
}

static struct implicit ball_at(const void *context, const double p[3])
{
	const struct ellipsoid ball = {.radius = {0.5, 0.5, 0.5}};

	(void)context;
	return implicit_ellipsoid(&ball, p);
}

static double volume(const struct trimesh *mesh)
{
	double sum = 0;

	for (int t = 0; t < mesh->triangle_count; t++) {
		const int *corner = mesh->triangle[t];
		double cross[3];

		vec_cross(mesh->position[corner[1]], mesh->position[corner[2]], cross);
		sum += vec_dot(mesh->position[corner[0]], cross) / 6;
	}
	return sum;
}

static void ball_is_a_ball(void **state)
{
	const struct solid solid = {ball_at, NULL, {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
	struct trimesh mesh;

	(void)state;
	assert_int_equal(polygonise(&mesh, &solid, 0.05), 0);
	for (int v = 0; v < mesh.vertex_count; v++) {
		expect_below(fabs(vec_length(mesh.position[v]) - 0.5), 1e-8, "v=%d", v);
		expect_below(fabs(vec_dot(mesh.position[v], mesh.normal[v]) - 0.5), 1e-8, "v=%d",
			     v);
	}
	/* Euler's formula for a sphere, and a volume a little below the ball's. */
	assert_int_equal(2 * (mesh.vertex_count - 2), mesh.triangle_count);
	assert_true(volume(&mesh) < M_PI / 6);
	assert_true(volume(&mesh) > 0.99 * M_PI / 6);
	trimesh_free(&mesh);
	trimesh_free(&mesh);
}

/* ---- the meshes ---- */

struct cow_edge {
	int from, to;
};

static int edge_compare(const void *a, const void *b)
{
	return memcmp(a, b, sizeof(struct cow_edge));
}

/* Each directed edge occurs exactly once, and so does its opposite. */
static void meshes_are_closed(void **state)
{
	(void)state;
	for (int k = 0; k < COW_PARTS; k++) {
		const int count = 3 * parts[k].triangle_count;
		struct cow_edge *edge = malloc(count * sizeof(*edge));

		assert_non_null(edge);
		for (int e = 0; e < count; e++)
			edge[e] = (struct cow_edge){parts[k].triangle[e / 3][e % 3],
						    parts[k].triangle[e / 3][(e + 1) % 3]};
		qsort(edge, count, sizeof(*edge), edge_compare);
		for (int e = 0; e < count; e++) {
			const struct cow_edge back = {edge[e].to, edge[e].from};

			if (e)
				assert_int_not_equal(edge_compare(&edge[e - 1], &edge[e]), 0);
			assert_non_null(bsearch(&back, edge, count, sizeof(*edge), edge_compare));
		}
		free(edge);
		/* Solids without handles; only the collar is a ring. */
		expect_equal(parts[k].vertex_count - parts[k].triangle_count / 2,
			     strcmp(cow_parts[k].name, "collar") ? 2 : 0, "k=%d", k);
	}
}

static void triangles_are_sound_and_outward(void **state)
{
	(void)state;
	for (int k = 0; k < COW_PARTS; k++) {
		const double step = cow_parts[k].step;

		expect_above(volume(&parts[k]), 0, "k=%d", k);
		for (int t = 0; t < parts[k].triangle_count; t++) {
			const int *corner = parts[k].triangle[t];
			double a[3], b[3], normal[3], longest = 0, area;

			for (int i = 0; i < 3; i++) {
				a[i] = parts[k].position[corner[1]][i] -
				       parts[k].position[corner[0]][i];
				b[i] = parts[k].position[corner[2]][i] -
				       parts[k].position[corner[0]][i];
			}
			vec_cross(a, b, normal);
			area = vec_normalize(normal) / 2;
			longest = fmax(vec_length(a), vec_length(b));
			/* Neither specks nor slivers: heights are a tenth of the longest side or
			 * more. */
			expect_above(area, 0.01 * step * step, "k=%d, t=%d", k, t);
			expect_above(2 * area / longest, 0.05 * longest, "k=%d, t=%d", k, t);
			for (int i = 0; i < 3; i++)
				expect_above(vec_dot(normal, parts[k].normal[corner[i]]), 0.2,
					     "k=%d, t=%d, i=%d", k, t, i);
		}
		for (int v = 0; v < parts[k].vertex_count; v++)
			expect_below(fabs(vec_length(parts[k].normal[v]) - 1), 1e-9, "k=%d, v=%d",
				     k, v);
	}
}

static void vertices_lie_on_the_surface(void **state)
{
	(void)state;
	for (int k = 0; k < COW_PARTS; k++) {
		const struct solid *solid = &cow_parts[k].solid;

		for (int v = 0; v < parts[k].vertex_count; v++) {
			const struct implicit f = solid->at(solid->context, parts[k].position[v]);

			expect_below(fabs(f.value), 1e-6, "k=%d, v=%d", k, v);
			for (int i = 0; i < 3; i++) {
				expect_above(parts[k].position[v][i], solid->low[i] - 1e-3,
					     "k=%d, v=%d, i=%d", k, v, i);
				expect_below(parts[k].position[v][i], solid->high[i] + 1e-3,
					     "k=%d, v=%d, i=%d", k, v, i);
			}
		}
	}
}

/* Nothing is below the floor, and under each corner of the body a flat sole stands on it. */
static void four_hooves_stand_on_the_floor(void **state)
{
	int touching[4] = {0, 0, 0, 0};

	(void)state;
	for (int k = 0; k < COW_PARTS; k++) {
		for (int v = 0; v < parts[k].vertex_count; v++) {
			const double *p = parts[k].position[v];

			expect_above(p[1], -1e-6, "k=%d, v=%d", k, v);
			if (p[1] < 1e-5)
				touching[(p[0] > 0) + 2 * (p[2] > 0)]++;
		}
	}
	for (int i = 0; i < 4; i++)
		expect_above(touching[i], 30, "i=%d", i);
}

static void budget_and_size(void **state)
{
	double low = 1, high = -1;
	int triangles = 0;

	(void)state;
	for (int k = 0; k < COW_PARTS; k++) {
		triangles += parts[k].triangle_count;
		for (int v = 0; v < parts[k].vertex_count; v++) {
			low = fmin(low, parts[k].position[v][2]);
			high = fmax(high, parts[k].position[v][2]);
		}
	}
	assert_in_range(triangles, 20000, 65000);
	assert_true(high - low > 0.38 && high - low < 0.46);
}

static void same_every_time(void **state)
{
	struct trimesh again;

	(void)state;
	assert_int_equal(polygonise(&again, &cow_parts[0].solid, cow_parts[0].step), 0);
	assert_int_equal(again.vertex_count, parts[0].vertex_count);
	assert_int_equal(again.triangle_count, parts[0].triangle_count);
	assert_memory_equal(again.position, parts[0].position,
			    again.vertex_count * sizeof(*again.position));
	assert_memory_equal(again.triangle, parts[0].triangle,
			    again.triangle_count * sizeof(*again.triangle));
	trimesh_free(&again);
}

/* ---- the texture ---- */

static void look_up(const struct image *picture, const double uv[2], double rgb[3])
{
	const double x = uv[0] * picture->width - 0.5, y = uv[1] * picture->height - 0.5;
	const int x0 = (int)floor(x), y0 = (int)floor(y);

	for (int c = 0; c < 3; c++)
		rgb[c] = 0;
	for (int k = 0; k < 4; k++) {
		const int column = x0 + (k & 1), row = y0 + (k >> 1);
		const double weight = (k & 1 ? x - x0 : 1 - x + x0) *
				      (k >> 1 ? y - y0 : 1 - y + y0);

		assert_in_range(column, 0, picture->width - 1);
		assert_in_range(row, 0, picture->height - 1);
		for (int c = 0; c < 3; c++)
			rgb[c] += weight *
				  picture->u8[3 * ((size_t)row * picture->width + column) + c] /
				  255.0;
	}
}

/* Points all over the coat, at borders of its pieces too, find their colour in the texture. Only
 * where colours change within a texel may it differ. */
static void texture_is_the_coat(void **state)
{
	const int points = 100000;
	struct atlas atlas;
	uint32_t seed = SEED;
	double sum = 0;
	int off = 0;

	(void)state;
	assert_int_equal(atlas_create(&atlas, &parts[0], 1024, cow_colour), 0);
	assert_true(atlas.texel < 0.001);
	for (int k = 0; k < points; k++) {
		const int t = (int)(uniform(&seed) * parts[0].triangle_count);
		double weight[3], p[3] = {0, 0, 0}, uv[2] = {0, 0}, want[3], got[3];
		double most = 0;

		weight[0] = k % 4 ? uniform(&seed) : 0;
		weight[1] = (1 - weight[0]) * uniform(&seed);
		weight[2] = 1 - weight[0] - weight[1];
		for (int i = 0; i < 3; i++) {
			for (int c = 0; c < 3; c++)
				p[c] += weight[i] * parts[0].position[parts[0].triangle[t][i]][c];
			for (int c = 0; c < 2; c++)
				uv[c] += weight[i] * atlas.point[atlas.corner[t][i]][c];
		}
		cow_colour(p, want);
		look_up(&atlas.picture, uv, got);
		for (int c = 0; c < 3; c++)
			most = fmax(most, fabs(want[c] - got[c]));
		sum += most;
		off += most > 0.1;
	}
	assert_true(off < points / 100);
	assert_true(sum / points < 0.005);
	atlas_free(&atlas);
	atlas_free(&atlas);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gradients_match_differences),
		cmocka_unit_test(cone_is_the_distance),
		cmocka_unit_test(ball_is_a_ball),
		cmocka_unit_test(meshes_are_closed),
		cmocka_unit_test(triangles_are_sound_and_outward),
		cmocka_unit_test(vertices_lie_on_the_surface),
		cmocka_unit_test(four_hooves_stand_on_the_floor),
		cmocka_unit_test(budget_and_size),
		cmocka_unit_test(same_every_time),
		cmocka_unit_test(texture_is_the_coat),
	};

	return cmocka_run_group_tests(tests, make_parts, free_parts);
}
