/* SPDX-License-Identifier: MIT */
/* The baked transport against closed forms, and against path-traced truth. */
#include <math.h>

#include "bake/base/random.h"
#include "bake/scene/scene.h"
#include "bake/truth/truth.h"
#include "bake/truth/truth_views.h"
#include "hal/optics/dome.h"
#include "hal/optics/fisheye.h"
#include "tests/support/bake/baked_rows.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define VIEW                                                                                       \
	"[camera]\nposition = 0 -6 2\nlook_at = 0 0 0.8\nfield_deg = 30\nwidth = 48\nheight = "    \
	"48\n"

/* ---- furnaces ---- */

static void check_furnace(const char *what, double rms_limit, double mean_limit)
{
	struct basis basis = small_scene_bake("furnace.ini");
	double worst = 0, square = 0, sum[2] = {0, 0};
	int inside = 0, outside = 0;

	for (int y = 0; y < 48; y++)
		for (int x = 0; x < 48; x++) {
			const double a = baked_coverage(&basis, x, y);

			/* object and ground together give 1, wherever the edge lies */
			for (int c = 0; c < 3; c++) {
				const double object = baked_object(&basis, x, y, c, NULL);
				const double ratio = baked_ratio(&basis, x, y, c, NULL);
				const double through = baked_through(&basis, x, y, c);
				const double off = object + (1 - a + through) * ratio - 1;

				worst = fmax(worst, fabs(off));
				square += off * off / (3 * 48 * 48);
				if (a == 1) {
					sum[0] += off;
					inside++;
				} else if (a == 0) {
					sum[1] += ratio - 1;
					outside++;
				}
			}
		}
	basis_close(&basis);
	print_message("# %s: object %+.5f, ground %+.5f, RMS %.5f, worst pixel %.4f\n", what,
		      sum[0] / inside, sum[1] / outside, sqrt(square), worst);
	assert_true(inside > 300 && outside > 300);
	assert_true(fabs(sum[0] / inside) < mean_limit);
	assert_true(fabs(sum[1] / outside) < mean_limit);
	assert_true(sqrt(square) < rms_limit);
}

/* A white ball on white ground. */
TEST("white furnace")
{
	small_scene_write_sphere("ball.obj", 0.8, 32);
	small_scene_write(
		"furnace.ini",
		VIEW "[dome]\nfrequency = 4\n[render]\nsamples = 16\n"
		     "[ground]\nmaterial = white\n[object ball]\nfile = ball.obj\n"
		     "up = z\nmaterial = white\nstand = yes\n[material white]\ncolour = 1 1 1\n");
	check_furnace("white", 0.005, 0.001);
}

/* What a polished floor mirrors comes out of the light of its base. */
TEST("polished furnace")
{
	small_scene_write_sphere("ball.obj", 0.8, 32);
	small_scene_write(
		"furnace.ini",
		VIEW "[dome]\nfrequency = 4\n[render]\nsamples = 16\n"
		     "[ground]\nmaterial = floor\n[object ball]\nfile = ball.obj\n"
		     "up = z\nmaterial = white\nstand = yes\n[material white]\ncolour = 1 1 1\n"
		     "[material floor]\nkind = glossy\ncolour = 1 1 1\n"
		     "specular = 0.3 0.3 0.3\nroughness = 0.2\n");
	check_furnace("polished", 0.01, 0.003);
}

/* What mirrors the sky live came out of T, and only that. */
TEST("mirror furnace")
{
	static const char *const roughness[] = {"0", "0.1", "0.2"};

	small_scene_write_sphere("ball.obj", 0.8, 32);
	for (size_t k = 0; k < 3; k++) {
		small_scene_write(
			"furnace.ini",
			VIEW "[dome]\nfrequency = 4\n[render]\nsamples = 16\n"
			     "[ground]\nmaterial = white\n[object ball]\nfile = ball.obj\n"
			     "up = z\nmaterial = metal\nstand = yes\n[material white]\n"
			     "colour = 1 1 1\n[material metal]\nkind = glossy\ncolour = 0 0 0\n"
			     "specular = 1 1 1\nroughness = %s\n",
			roughness[k]);
		check_furnace(roughness[k], 0.01, 0.003);
	}
}

TEST("glass furnace")
{
	small_scene_write_sphere("ball.obj", 0.8, 32);
	small_scene_write(
		"furnace.ini",
		VIEW "[dome]\nfrequency = 4\n[render]\nsamples = 16\n"
		     "[ground]\nmaterial = white\n[object ball]\nfile = ball.obj\n"
		     "up = z\nmaterial = glass\nstand = yes\n[material white]\ncolour = 1 1 1\n"
		     "[material glass]\nkind = glass\ncolour = 1 1 1\n");
	check_furnace("glass", 0.01, 0.001);
}

/* Panes send back what they do not let through: to the ground, to themselves, and to metal. */
static void check_pane_furnace(const char *what, const char *glass, const char *other, double limit)
{
	small_scene_write("furnace.ini",
			  VIEW "[dome]\nfrequency = 4\n[render]\nsamples = 16\n"
			       "[ground]\nmaterial = white\n[object ball]\nfile = ball.obj\n"
			       "up = z\nmaterial = glass\nstand = yes\n%s[material white]\n"
			       "colour = 1 1 1\n[material glass]\nkind = glass\n"
			       "colour = 1 1 1\n%s\n[material metal]\nkind = glossy\n"
			       "colour = 0 0 0\nspecular = 1 1 1\nroughness = 0.5\n",
			  other, glass);
	check_furnace(what, limit, limit / 10);
}

TEST("pane furnace")
{
	const char *const metal = "[object metal]\nfile = small.obj\nup = z\nmaterial = metal\n"
				  "position = 0 0 0.8\n";

	small_scene_write_sphere("ball.obj", 0.8, 32);
	small_scene_write_sphere("small.obj", 0.5, 32);
	check_pane_furnace("metal behind panes", "thin = yes", metal, 0.03);
	if (!thorough())
		return;
	check_pane_furnace("panes", "thin = yes", "", 0.01);
	check_pane_furnace("metal behind ior 1", "ior = 1", metal, 0.03);
}

/* A convex object over nothing has radiance albedo * (1 + n_z) / 2, with n_z from geometry. */
TEST("half sky")
{
	struct basis basis;

	small_scene_write_sphere("ball.obj", 1, 64);
	small_scene_write(
		"half.ini",
		"[camera]\nposition = 0 -50 0\nlook_at = 0 0 0\nfield_deg = 2.4\nwidth = 24\n"
		"height = 24\n[dome]\nfrequency = 6\n[render]\nsamples = 64\n[object ball]\n"
		"file = ball.obj\nup = z\nmaterial = m\n[material m]\ncolour = 0.2 0.5 0.8\n");
	basis = small_scene_bake("half.ini");
	assert_int_equal(basis.info.grounds, 0);
	for (int y = 4; y < 20; y++) {
		/* the middle column: n = (0, -cos, z), where z is the height of the pixel on the
		 * ball */
		const double half = 50 * tan(1.2 * M_PI / 180);
		const double z = half * (1 - (y + 0.5) / 12);
		static const double albedo[3] = {0.2, 0.5, 0.8};

		for (int c = 0; c < 3; c++) {
			const double want = albedo[c] * (1 + z) / 2;
			const double got = baked_object(&basis, 12, y, c, NULL);

			if (fabs(got - want) > 0.01 * albedo[c])
				fail_msg("row %d channel %d: %.4f, expected %.4f", y, c, got, want);
		}
	}
	basis_close(&basis);
}

/* ---- ground ---- */

TEST("ground term")
{
	struct basis basis;

	small_scene_write_sphere("ball.obj", 0.5, 8);
	/* The ground's share of each light does not depend on pixels: the smallest possible
	 * picture, and the finest dome. */
	small_scene_write(
		"g.ini",
		"[camera]\nposition = 0 -6 2\nlook_at = 0 0 0.8\nfield_deg = 30\nwidth = 8\n"
		"height = 8\n[dome]\nfrequency = 9\n[render]\nsamples = 1\n[ground]\nmaterial = m\n"
		"[object ball]\nfile = ball.obj\nup = z\n[material m]\ncolour = 0.1 0.35 1\n");
	basis = small_scene_bake("g.ini");
	for (int c = 0; c < 3; c++) {
		static const double albedo[3] = {0.1, 0.35, 1};
		double sum = 0;

		for (uint32_t i = 0; i < basis.info.lights; i++)
			sum += basis_ground(&basis, 0, c)[i];
		expect_below(fabs(sum - albedo[c]), 1e-9, "c=%d", c);
	}
	basis_close(&basis);
}

/* Ground right below a black sphere sees the sphere with form factor (R / h)^2. */
TEST("form factor")
{
	const double radius = 0.5, height = 1.25;
	struct basis basis;
	double v[512];

	small_scene_write_sphere("ball.obj", radius, 64);
	small_scene_write(
		"f.ini",
		"[camera]\nposition = 0 -10 1\nlook_at = 0 0 0\nfield_deg = 0.05\nwidth = 3\n"
		"height = 3\n[dome]\nfrequency = 9\n[render]\nsamples = 256\n"
		"[ground]\n[object ball]\nfile = ball.obj\nup = z\nposition = 0 0 %g\n"
		"material = black\n[material black]\ncolour = 0 0 0\n",
		height);
	basis = small_scene_bake("f.ini");
	assert_true(fabs(1 - baked_ratio(&basis, 1, 1, 0, NULL) -
			 radius * radius / height / height) < 0.001);
	assert_true(baked_row(&basis, 1, 1, BASIS_KIND_V, 0, v));
	assert_true(fabs(v[0] - 1) < 1e-4); /* the zenith's cell is behind the sphere */
	assert_true(fabs(v[405]) < 1e-4);   /* a cell on the horizon is not */
	basis_close(&basis);
}

/* Where light from the middle of the ground ends, by independent paths: ground of albedo 1/2, and
 * above it a square plate that faces straight down. */
static double below_a_plate(double half_side, double height, double albedo)
{
	struct random random = {5};
	const int paths = 400000;
	double sum = 0;

	for (int k = 0; k < paths; k++) {
		double at[2] = {0, 0}, weight = 1;

		for (int bounce = 0; weight > 1e-6; bounce++) {
			const double r = sqrt((double)random_next(&random));
			const double phi = 2 * M_PI * (double)random_next(&random);

			at[0] += height * r * cos(phi) / sqrt(fmax(1 - r * r, 1e-12));
			at[1] += height * r * sin(phi) / sqrt(fmax(1 - r * r, 1e-12));
			if (bounce % 2 == 0 && fmax(fabs(at[0]), fabs(at[1])) > half_side) {
				sum += weight;
				break;
			}
			weight *= bounce % 2 ? 0.5 : albedo;
		}
	}
	return sum / paths;
}

/* A surface that faces straight down has no downhill direction. Tilted by next to nothing it must
 * give the same light. */
TEST("looks straight down")
{
	static const char *const tilts[] = {"0 0 0", "0.01 0 0", "0 0.00001 0"};
	const double want = below_a_plate(0.8, 0.5, 0.8);

	small_scene_write("plate.obj", "v -0.8 -0.8 0\nv 0.8 -0.8 0\nv 0.8 0.8 0\nv -0.8 0.8 0\n"
				       "f 4 3 2 1\n");
	for (int k = 0; k < 3; k++) {
		struct basis basis;
		double got = 0;

		small_scene_write(
			"plate.ini",
			"[camera]\nposition = 0 -0.9 0.25\nlook_at = 0 0 0\nfield_deg = 2\n"
			"width = 4\nheight = 4\n[dome]\nfrequency = 4\n[render]\n"
			"samples = 256\nbounces = 32\n[ground]\nmaterial = half\n"
			"[object plate]\nfile = plate.obj\nup = z\nposition = 0 0 0.5\n"
			"rotate = %s\nmaterial = bright\n[material bright]\n"
			"colour = 0.8 0.8 0.8\n[material half]\ncolour = 0.5 0.5 0.5\n",
			tilts[k]);
		basis = small_scene_bake("plate.ini");
		for (int p = 0; p < 16; p++)
			got += baked_ratio(&basis, p % 4, p / 4, 1, NULL) / 16;
		basis_close(&basis);
		print_message("# below a plate turned by %s: %.4f, expected %.4f\n", tilts[k], got,
			      want);
		expect_below(fabs(got - want), 0.006, "k=%d", k);
	}
}

/* ---- directions ---- */

/* Each pixel of a mirroring sphere shows the cell that the law of reflection gives. */
TEST("mirror")
{
	struct fault fault = {.text = ""};
	struct basis basis;
	struct dome dome;
	double all = 0;
	int checked = 0, strays = 0;

	assert_int_equal(dome_create(&dome, 6, &fault), 0);
	small_scene_write_sphere("ball.obj", 1, 128);
	small_scene_write(
		"m.ini",
		"[camera]\nposition = 0 -40 0\nlook_at = 0 0 0\nfield_deg = 3\nwidth = 40\n"
		"height = 40\n[dome]\nfrequency = 6\n[render]\nsamples = 16\nreflect = cells\n"
		"[object ball]\n"
		"file = ball.obj\nup = z\nmaterial = mirror\n[material mirror]\nkind = glossy\n"
		"colour = 0 0 0\nspecular = 1 1 1\nroughness = 0\n");
	basis = small_scene_bake("m.ini");
	for (int y = 4; y < 36; y++)
		for (int x = 4; x < 36; x++) {
			const double half = 40 * tan(1.5 * M_PI / 180);
			/* seen from -Y: world +X is right, +Z is up */
			const double px = half * ((x + 0.5) / 20 - 1),
				     pz = half * (1 - (y + 0.5) / 20);
			const double r2 = px * px + pz * pz;
			double n[3] = {px, 0, pz}, mirrored[3], t[512], view[3], dot;
			double sum = 0, near = 0;

			if (r2 > 0.6)
				continue;
			n[1] = -sqrt(1 - r2);
			for (int k = 0; k < 3; k++)
				view[k] = n[k] - (k == 1 ? -40 : 0);
			dot = sqrt(view[0] * view[0] + view[1] * view[1] + view[2] * view[2]);
			for (int k = 0; k < 3; k++)
				view[k] /= dot;
			dot = view[0] * n[0] + view[1] * n[1] + view[2] * n[2];
			for (int k = 0; k < 3; k++)
				mirrored[k] = view[k] - 2 * dot * n[k];
			if (mirrored[2] < 0.3)
				continue;
			baked_row(&basis, x, y, BASIS_KIND_T, 1, t);
			for (int i = 0; i < dome.count; i++) {
				const double *d = dome.direction[i];
				const double c = d[0] * mirrored[0] + d[1] * mirrored[1] +
						 d[2] * mirrored[2];

				sum += t[i];
				near += c > cos(0.45) ? t[i] : 0;
			}
			expect_below(fabs(sum - 1), 0.02, "y=%d, x=%d", y, x);
			all += sum - 1;
			strays += near < 0.97 * sum; /* a sample in the far tail of the lobe */
			checked++;
		}
	assert_true(checked > 200 && strays < 4 && fabs(all / checked) < 0.002);
	basis_close(&basis);
	dome_free(&dome);
}

/* What is mirrored live is what cells would get: the same light, from the same directions. */
TEST("live mirror")
{
	double even[2] = {0, 0}, sky[2] = {0, 0}, live = 0, light[512];
	struct basis basis;

	small_scene_write_sphere("ball.obj", 1, 128);
	for (int k = 0; k < 2; k++) {
		small_scene_write(
			"m.ini",
			"[camera]\nposition = 0 -6 2\nlook_at = 0 0 0.8\nfield_deg = 30\n"
			"width = 40\nheight = 40\n[dome]\nfrequency = 6\n[render]\nsamples = 32\n"
			"reflect = %s\n[ground]\n[object ball]\nfile = ball.obj\nup = z\nstand = yes\n"
			"material = mirror\n[material mirror]\nkind = glossy\n"
			"colour = 0.3 0.2 0.1\nspecular = 0.4 0.5 0.6\nroughness = 0.1\n",
			k ? "live" : "cells");
		basis = small_scene_bake("m.ini");
		assert_int_equal(basis.poses[0].mirror_count > 0, k);
		for (uint32_t i = 0; i < basis.info.lights; i++)
			light[i] = 1 + basis.lights[i].direction[0] +
				   0.5 * basis.lights[i].direction[1];
		for (int at = 0; at < 3 * 40 * 40; at++) {
			const int c = at % 3, x = at / 3 % 40, y = at / 3 / 40;

			even[k] += baked_object(&basis, x, y, c, NULL);
			sky[k] += baked_object(&basis, x, y, c, light);
			live += baked_mirrored(&basis, x, y, c, NULL);
		}
		basis_close(&basis);
	}
	print_message("# live: %.3f of the light, which changes by %+.5f; in an uneven sky %+.5f\n",
		      live / even[1], even[1] / even[0] - 1, sky[1] / sky[0] - 1);
	assert_true(live > 0.2 * even[1]);
	assert_true(fabs(even[1] / even[0] - 1) < 0.002);
	assert_true(fabs(sky[1] / sky[0] - 1) < 0.005);
}

/* ---- stand-ins ---- */

/* A stand-in in place of the ground receives the same shadow, through D and U instead of V. */
TEST("standin is ground")
{
	static double of_ground[32][32];
	struct basis basis;
	double worst = 0, sum = 0;
	int count = 0;

	small_scene_write_sphere("ball.obj", 0.8, 24);
	small_scene_write("plane.obj",
			  "v -40 -40 0\nv 40 -40 0\nv 40 40 0\nv -40 40 0\nf 1 2 3 4\n");
	for (int k = 0; k < 2; k++) {
		small_scene_write(
			"s.ini",
			"[camera]\nposition = 0 -6 4\nlook_at = 0 0 0\nfield_deg = 40\n"
			"width = 32\nheight = 32\n[dome]\nfrequency = 4\n[render]\nsamples = 64\n"
			"%s[object ball]\nfile = ball.obj\nup = z\nmaterial = m\n"
			"position = 0 0 1.2\n[material m]\ncolour = 0.5 0.5 0.5\n",
			k ? "[standin floor]\nfile = plane.obj\nup = z\nmaterial = m\n"
			  : "[ground]\nmaterial = m\n");
		basis = small_scene_bake("s.ini");
		for (int y = 0; y < 32; y++)
			for (int x = 0; x < 32; x++) {
				const double ratio = baked_ratio(&basis, x, y, 0, NULL);

				if (k && baked_coverage(&basis, x, y) < 0.5) {
					worst = fmax(worst, fabs(ratio - of_ground[y][x]));
					sum += ratio - of_ground[y][x];
					count++;
				}
				of_ground[y][x] = ratio;
			}
		basis_close(&basis);
	}
	print_message("# stand-in against ground: mean %+.5f, worst %.4f\n", sum / count, worst);
	assert_true(count > 500 && fabs(sum / count) < 0.002 && worst < 0.03);
}

TEST("standin hides")
{
	struct basis basis;
	int seen = 0;

	small_scene_write_sphere("ball.obj", 0.8, 12);
	/* a wall before the right half */
	small_scene_write("wall.obj", "v 0 -3 0\nv 9 -3 0\nv 9 -3 9\nv 0 -3 9\nf 1 2 3 4\n");
	small_scene_write("h.ini", VIEW "[dome]\nfrequency = 1\n[render]\nsamples = 4\n[ground]\n"
					"[standin wall]\nfile = wall.obj\nup = z\n[object ball]\n"
					"file = ball.obj\nup = z\nstand = yes\n");
	basis = small_scene_bake("h.ini");
	for (int y = 0; y < 48; y++)
		for (int x = 0; x < 48; x++) {
			seen += baked_coverage(&basis, x, y) > 0;
			if (x >= 24)
				expect_equal(baked_coverage(&basis, x, y), 0, "y=%d, x=%d", y, x);
		}
	assert_true(seen > 100);
	basis_close(&basis);
}

/* ---- the whole against another code path ---- */

/* Makes a panorama of light that is constant over each cell, so that cells approximate nothing. */
static void make_cells(const struct panorama *panorama, const struct dome *dome,
		       const double *light, struct image *image)
{
	assert_int_equal(image_create_f32(image, 1024, 512), 0);
	for (int y = 0; y <= 256; y++)
		for (int x = 0; x < 1024; x++) {
			double d[3];

			/* texels above the horizon must not take light from black ones below */
			panorama_direction(panorama, x + 0.5, fmin(y, 255) + 0.5, d);
			for (int c = 0; c < 3; c++)
				image->f32[3 * (y * 1024 + x) + c] =
					(float)(light[dome_cell_of(dome, d)] / panorama->scale);
		}
}

/* In an even sky each sample of a mirror is the sky; a base that is black gets none of them. */
TEST("truth of metal has no noise")
{
	const struct truth_settings settings = {
		.samples = 4, .bounces = 2, .seed = 3, .threads = 2, .quiet = true};
	struct image image, grey, out;
	const struct panorama panorama = {.image = &image, .scale = 1};
	struct fault fault = {.text = ""};
	const double light[6] = {0.5, 0.5, 0.5, 0.5, 0.5, 0.5};
	struct truth_report report;
	struct scene *scene;
	struct dome dome;
	struct sky sky;
	int strays = 0;

	assert_int_equal(dome_create(&dome, 1, &fault), 0);
	make_cells(&panorama, &dome, light, &image);
	assert_int_equal(image_create_f32(&grey, 16, 16), 0);
	small_scene_write_sphere("ball.obj", 1, 64);
	small_scene_write("m.ini",
			  "[camera]\nposition = 0 -1 8\nlook_at = 0 0 0\nfield_deg = 6\n"
			  "width = 16\nheight = 16\n[object ball]\nfile = ball.obj\nup = z\n"
			  "material = metal\n[material metal]\nkind = glossy\n"
			  "colour = 0 0 0\nspecular = 1 1 1\nroughness = 0\n");
	scene = small_scene_open("m.ini");
	assert_int_equal(sky_create(&sky, &panorama, "made", &fault), 0);
	assert_int_equal(truth_run(scene, &sky, &grey, &settings, &out, &report, &fault), 0);
	for (int k = 0; k < 3 * 16 * 16; k++)
		strays += fabs((double)out.f32[k] - 0.5) > 0.05;
	assert_true(strays < 40); /* microfacets in the far tail */
	scene_close(scene);
	sky_free(&sky);
	image_free(&image);
	image_free(&grey);
	image_free(&out);
	dome_free(&dome);
}

TEST("truth agrees")
{
	const int side = 64;
	const struct truth_settings settings = {
		.samples = 256, .bounces = 32, .seed = 3, .threads = 2, .quiet = true};
	struct image image, grey, out;
	const struct panorama panorama = {.image = &image, .turn_rad = 0.7, .scale = 0.5};
	struct fault fault = {.text = ""};
	struct truth_report report;
	struct scene *scene;
	struct basis basis;
	struct dome dome;
	struct sky sky;
	double light[64] = {0}, square = 0, worst = 0;

	assert_int_equal(dome_create(&dome, 3, &fault), 0);
	for (int i = 0; i < dome.count; i++)
		light[i] = 0.2 + (i * 7 % 11 == 3 ? 4 : 0) + 0.1 * (i % 3);
	make_cells(&panorama, &dome, light, &image);
	assert_int_equal(image_create_f32(&grey, side, side), 0);
	for (int k = 0; k < 3 * side * side; k++)
		grey.f32[k] = 0.3f;
	small_scene_write_sphere("ball.obj", 0.8, 32);
	small_scene_write("cube.obj",
			  "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 1\nv 1 -1 1\n"
			  "v 1 1 1\nv -1 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\n"
			  "f 3 4 8 7\nf 4 1 5 8\n");
	small_scene_write(
		"t.ini",
		"[camera]\nposition = 2 -6 2.5\nlook_at = 0 0 0.7\nfield_deg = 40\nwidth = 64\n"
		"height = 64\n[dome]\nfrequency = 3\n"
		"[render]\nsamples = 128\n[ground]\n"
		"[object ball]\nfile = ball.obj\nup = z\nposition = 0.4 0 0.8\nmaterial = shiny\n"
		"[object cube]\nfile = cube.obj\nup = z\nscale = 0.4\nposition = -1 -0.6 0\n"
		"material = red\n[material red]\ncolour = 0.8 0.2 0.1\n[material shiny]\n"
		"kind = glossy\ncolour = 0.3 0.4 0.6\nspecular = 0.2 0.2 0.2\nroughness = 0.4\n");
	scene = small_scene_open("t.ini");
	basis = small_scene_bake("t.ini");
	assert_int_equal(sky_create(&sky, &panorama, "made", &fault), 0);
	assert_int_equal(truth_run(scene, &sky, &grey, &settings, &out, &report, &fault), 0);
	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++)
			for (int c = 0; c < 3; c++) {
				const double baked = baked_object(&basis, x, y, c, light) +
						     (1 - baked_coverage(&basis, x, y)) *
							     baked_ratio(&basis, x, y, c, light) *
							     0.3;
				const double off = baked - out.f32[3 * (y * side + x) + c];

				square += off * off;
				worst = fmax(worst, fabs(off));
			}
	square = sqrt(square / (3 * side * side));
	print_message(
		"# bake against truth: RMS %.5f, worst %.4f (linear), truth's noise %.2f levels\n",
		square, worst, report.noise_levels);
	assert_true(square < 0.006);
	basis_close(&basis);
	scene_close(scene);
	sky_free(&sky);
	image_free(&image);
	image_free(&grey);
	image_free(&out);
	dome_free(&dome);
}

/* ---- polished floors ---- */

#define FLOOR_SIDE 48

/* A box on a floor of this roughness, baked and traced. */
struct floor {
	struct truth_pictures truth;
	struct basis basis;
	double light[64];
};

static void floor_open(struct floor *f, const char *roughness)
{
	const struct truth_settings settings = {
		.samples = 96, .bounces = 4, .seed = 3, .threads = 2, .quiet = true};
	struct image image;
	const struct panorama panorama = {.image = &image, .scale = 1};
	struct fault fault = {.text = ""};
	struct scene *scene;
	struct dome dome;
	struct sky sky;

	assert_int_equal(dome_create(&dome, 2, &fault), 0);
	for (int i = 0; i < dome.count; i++)
		f->light[i] = 0.3 + 0.2 * (i % 3);
	make_cells(&panorama, &dome, f->light, &image);
	small_scene_write("box.obj", "v -0.4 -0.4 0\nv 0.4 -0.4 0\nv 0.4 0.4 0\nv -0.4 0.4 0\n"
				     "v -0.4 -0.4 0.8\nv 0.4 -0.4 0.8\nv 0.4 0.4 0.8\n"
				     "v -0.4 0.4 0.8\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\n"
				     "f 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
	small_scene_write("floor.ini",
			  "[camera]\nposition = 1 -3.6 1.6\nlook_at = 0 -0.3 0.2\nfield_deg = 36\n"
			  "width = 48\nheight = 48\n[dome]\nfrequency = 2\n[render]\n"
			  "samples = 64\nbounces = 4\n[ground]\nmaterial = floor\n"
			  "[material floor]\nkind = glossy\ncolour = 0.4 0.4 0.4\n"
			  "specular = 0.3 0.3 0.3\nroughness = %s\n[material red]\n"
			  "colour = 0.8 0.1 0.1\n[object box]\nfile = box.obj\nup = z\n"
			  "material = red\n",
			  roughness);
	scene = small_scene_open("floor.ini");
	f->basis = small_scene_bake("floor.ini");
	assert_int_equal(sky_create(&sky, &panorama, "made", &fault), 0);
	assert_int_equal(truth_pictures(scene, &sky, &settings, &f->truth, &fault), 0);
	scene_close(scene);
	sky_free(&sky);
	image_free(&image);
	dome_free(&dome);
}

static void floor_close(struct floor *f)
{
	truth_pictures_free(&f->truth);
	basis_close(&f->basis);
}

/* The composite over the floor's own picture. */
static double floor_shows(const struct floor *f, int x, int y, int c)
{
	return baked_object(&f->basis, x, y, c, f->light) +
	       (1 - baked_coverage(&f->basis, x, y)) * baked_ratio(&f->basis, x, y, c, f->light) *
		       (double)f->truth.without.f32[3 * (y * FLOOR_SIDE + x) + c];
}

/* The floor shows the object as the light does that is traced: below its foot, and less sharply
 * where the floor is rougher. Of it no light is taken elsewhere. */
static double check_floor(const char *roughness)
{
	struct floor f;
	double square = 0, red = 0;
	int mirrored = 0, apart = 0;

	floor_open(&f, roughness);
	for (int y = 0; y < FLOOR_SIDE; y++)
		for (int x = 0; x < FLOOR_SIDE; x++) {
			const size_t at = 3 * (size_t)(y * FLOOR_SIDE + x);
			const double covered = baked_coverage(&f.basis, x, y);
			const bool floor = f.truth.coverage.f32[at] == 0;

			mirrored += floor && covered > 0.9;
			apart += floor && covered == 0;
			for (int c = 0; c < 3; c++) {
				const double off = floor_shows(&f, x, y, c) -
						   (double)f.truth.with.f32[at + (size_t)c];

				square += off * off / (3 * FLOOR_SIDE * FLOOR_SIDE);
			}
			if (floor && covered > 0)
				red = fmax(red,
					   floor_shows(&f, x, y, 0) - floor_shows(&f, x, y, 1));
		}
	print_message("# floor of roughness %s: RMS %.5f, %d pixels mirror, %d do not\n", roughness,
		      sqrt(square), mirrored, apart);
	assert_true(sqrt(square) < 0.006);
	assert_true(apart > 200);
	assert_true(red > 0.05);
	floor_close(&f);
	return mirrored;
}

TEST("polished floor")
{
	const double sharp = check_floor("0.05"), dull = check_floor("0.5");

	assert_true(sharp > 100);
	assert_true(dull < sharp / 2);
}

/* The fisheye picture of a panorama holds the same light as its upper half. */
TEST("fisheye energy")
{
	const int width = 256, height = 128, side = 100;
	const struct fisheye_settings lens_settings = {.field_deg = 90};
	struct image image, out;
	const struct panorama panorama = {.image = &image, .scale = 1};
	struct fault fault = {.text = ""};
	double seen = 0, exact;
	struct fisheye lens;
	struct sky sky;

	assert_int_equal(image_create_f32(&image, width, height), 0);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++)
			for (int c = 0; c < 3; c++)
				image.f32[3 * (y * width + x) + c] =
					(float)(1 + 0.5 * sin(2 * M_PI * x / width));
	image.f32[3 * (30 * width + 77)] = 5000; /* a sun of one texel */
	assert_int_equal(truth_fisheye(&panorama, side, &out), 0);
	assert_int_equal(fisheye_prepare(&lens, &lens_settings, side, side, &fault), 0);
	assert_int_equal(sky_create(&sky, &panorama, "made", &fault), 0);
	exact = sky.ground.c[0] * M_PI;
	for (int y = 0; y < side; y++)
		for (int x = 0; x < side; x++) {
			/* cosine-weighted solid angle of the pixel, by fine sampling */
			for (int k = 0; k < 64; k++) {
				const double px[2] = {x + (k % 8 + 0.5) / 8, y + (k / 8 + 0.5) / 8};
				double d[3];

				if (fisheye_ray(&lens, px, d))
					seen += out.f32[3 * (y * side + x)] * d[2] *
						fisheye_pixel_sr(&lens, px) / 64;
			}
		}
	print_message("# fisheye: irradiance %.4f of %.4f\n", seen, exact);
	assert_true(fabs(seen - exact) < 0.001 * exact);
	image_free(&image);
	image_free(&out);
	sky_free(&sky);
}

TEST_GROUP(small_scene_begin, small_scene_end);
