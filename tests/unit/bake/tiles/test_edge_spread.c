/* SPDX-License-Identifier: MIT */
/* Edges of a bake, and of truth, are as soft as the camera's, against the closed form of a straight
 * edge. */
#include <math.h>
#include <string.h>

#include "bake/base/pixel_filter.h"
#include "bake/scene/scene.h"
#include "bake/truth/truth.h"
#include "hal/optics/dome.h"
#include "tests/support/bake/baked_rows.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { WIDTH = 32, HEIGHT = 32, MIDDLE = 16 };

/* Share of a pixel's weight that lies left of t, summed over slices of its square. */
static double share_left(double sigma, double t)
{
	enum { SLICES = 4000 };
	double sum = 0;

	for (int i = 0; i < SLICES; i++) {
		const double off = t - (i + 0.5) / SLICES;

		sum += sigma > 0 ? 0.5 * erfc(-off / sigma * M_SQRT1_2) : off > 0;
	}
	return sum / SLICES;
}

TEST("samples have the filters distribution")
{
	static const double sigmas[] = {0, 1e-3, 0.1, 0.5, 0.8, 2, TSAI_EDGE_SPREAD_MAX};
	enum { SAMPLES = 4096 };

	for (size_t k = 0; k < sizeof(sigmas) / sizeof(*sigmas); k++) {
		const double s = sigmas[k];
		double mean = 0, square = 0, last = -INFINITY;

		for (int i = 0; i < SAMPLES; i++) {
			const double unit = (i + 0.5) / SAMPLES;
			const double t = pixel_filter_place(s, unit);

			if (i % 256 == 7)
				expect_that(fabs(share_left(s, t) - unit) < 3e-4,
					    "sigma %g: %g at %g", s, unit, t);
			assert_true(t > last);
			last = t;
			mean += t / SAMPLES;
			square += (t - 0.5) * (t - 0.5) / SAMPLES;
		}
		expect_that(fabs(mean - 0.5) < 1e-6, "sigma %g: mean %g", s, mean);
		expect_that(fabs(square / (s * s + 1 / 12.0) - 1) < 2e-3, "sigma %g: variance %g",
			    s, square);
		assert_true(isfinite(pixel_filter_place(s, 0)));
	}
	assert_true(pixel_filter_place(0, 0.3) == 0.3);
}

/* A wall that ends at x = 0.05 m, seen straight on: the edge is a column of the picture. */
static struct scene *wall_open(double sigma)
{
	small_scene_write("wall.obj", "v -9 0 -9\nv 0.05 0 -9\nv 0.05 0 9\nv -9 0 9\n"
				      "f 1 2 3 4\n");
	small_scene_write("edge.ini",
			  "[camera]\nposition = 0 -4 0\nlook_at = 0 0 0\nfield_deg = 40\n"
			  "width = %d\nheight = %d\nedge_spread = %g\n[dome]\nfrequency = 1\n"
			  "[render]\nsamples = 256\nbounces = 0\n[object a]\nfile = wall.obj\n"
			  "up = z\nmaterial = m\n[material m]\ncolour = 1 1 1\n",
			  WIDTH, HEIGHT, sigma);
	return small_scene_open("edge.ini");
}

static double wall_edge(const struct scene *scene)
{
	static const double point[3] = {0.05, 0, 0};
	double px[2];

	assert_int_equal(tsai_project(&scene->camera, point, px), 0);
	return px[0];
}

TEST("an edge of the bake is that soft")
{
	static const double sigmas[] = {0, 0.5, 1.2};

	for (size_t k = 0; k < sizeof(sigmas) / sizeof(*sigmas); k++) {
		struct scene *scene = wall_open(sigmas[k]);
		const double edge = wall_edge(scene);
		struct fault fault;
		struct basis basis;

		small_scene_render(scene, "edge.inlay", 1);
		scene_close(scene);
		assert_int_equal(basis_open(&basis, small_scene_path("edge.inlay"),
					    BASIS_WITH_EXACT, &fault),
				 0);
		for (int x = 0; x < WIDTH; x++)
			expect_that(fabs(baked_coverage(&basis, x, MIDDLE) -
					 share_left(sigmas[k], edge - x)) < 0.006,
				    "sigma %g x %d: %g, expected %g", sigmas[k], x,
				    baked_coverage(&basis, x, MIDDLE),
				    share_left(sigmas[k], edge - x));
		assert_true(!strstr(basis.camera, "edge_spread") == (sigmas[k] == 0));
		basis_close(&basis);
	}
}

TEST("an edge of truth is that soft")
{
	const struct truth_settings settings = {.samples = 256, .threads = 1, .quiet = true};
	struct scene *scene = wall_open(0.8);
	const double edge = wall_edge(scene);
	struct truth_pictures pictures;
	struct dome dome;
	struct sky sky;
	struct fault fault;

	assert_int_equal(dome_create(&dome, 1, &fault), 0);
	sky_of_light(&sky, &dome, 0);
	assert_int_equal(truth_pictures(scene, &sky, &settings, &pictures, &fault), 0);
	for (int x = 0; x < WIDTH; x++)
		expect_that(fabs((double)pictures.coverage.f32[3 * (MIDDLE * WIDTH + x)] -
				 share_left(0.8, edge - x)) < 0.006,
			    "x %d", x);
	truth_pictures_free(&pictures);
	sky_free(&sky);
	dome_free(&dome);
	scene_close(scene);
}

/* The same view in half as many pixels has half the spread; a camera file's is kept. */
TEST("the spread is of the pictures pixels")
{
	struct fault fault;
	struct scene *scene = wall_open(1.2), *small, *filed;
	char text[4096];

	assert_int_equal(
		scene_open(&small, small_scene_path("edge.ini"), WIDTH / 2, HEIGHT / 2, &fault), 0);
	assert_true(fabs(small->camera.edge_spread_px - 0.6) < 1e-12);
	assert_true(scene->hash != small->hash);
	assert_int_equal(scene_camera_text(scene, text, sizeof(text)), 0);
	small_scene_write("cam.ini", "%s", text);
	small_scene_write("filed.ini", "[camera]\nfile = cam.ini\n[object a]\nfile = wall.obj\n");
	filed = small_scene_open("filed.ini");
	assert_true(filed->camera.edge_spread_px == 1.2);
	scene_close(filed);
	scene_close(small);
	scene_close(scene);
}

TEST_GROUP(small_scene_begin, small_scene_end);
