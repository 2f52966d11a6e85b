/* SPDX-License-Identifier: MIT */
/* Lamps at places in the path tracer, against closed forms. */
#include <math.h>

#include "bake/scene/scene.h"
#include "bake/truth/truth.h"
#include "bake/truth/truth_views.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define ALBEDO 0.5
/* A camera that sees some millimetres around the origin. */
#define SPOT_VIEW                                                                                  \
	"[camera]\nposition = 0 -2 1\nlook_at = 0 0 0\nfield_deg = 0.1\nwidth = 3\nheight = 3\n"

static const struct truth_settings settings = {
	.samples = 64, .bounces = 32, .seed = 3, .threads = 1, .quiet = true};

static struct truth_lamp white_lamp(double x, double y, double z, double radius)
{
	return (struct truth_lamp){
		v3_make((float)x, (float)y, (float)z), (float)radius, {{1, 1, 1}}};
}

/* The composite over a background of this radiance. */
static struct image traced(const char *name, const struct sky *sky, float background)
{
	struct scene *scene = small_scene_open(name);
	const int width = scene->camera.width, height = scene->camera.height;
	struct image behind, out;
	struct truth_report report;
	struct fault fault = {.text = ""};

	assert_int_equal(image_create_f32(&behind, width, height), 0);
	for (int k = 0; k < 3 * width * height; k++)
		behind.f32[k] = background;
	expect_success(truth_run(scene, sky, &behind, &settings, &out, &report, &fault), &fault);
	image_free(&behind);
	scene_close(scene);
	return out;
}

/* The mean of a picture, which is freed. */
static double mean_of(struct image *picture)
{
	const int pixels = picture->width * picture->height;
	double sum = 0;

	for (int k = 0; k < pixels; k++)
		sum += (double)picture->f32[3 * k] / pixels;
	image_free(picture);
	return sum;
}

/* The mean under one lamp. */
static double traced_mean(const char *name, struct truth_lamp lamp, float background)
{
	const struct sky sky = {.lamps = &lamp, .lamp_count = 1};
	struct image out = traced(name, &sky, background);

	return mean_of(&out);
}

/* The real scene, as an eye or the camera sees it. */
static struct image seen(const char *name, struct truth_lamp lamp, const struct truth_eye *eye)
{
	const struct sky sky = {.lamps = &lamp, .lamp_count = 1};
	struct scene *scene = small_scene_open(name);
	struct image out;

	assert_int_equal(truth_see(scene, &sky, eye, &settings, &out), 0);
	scene_close(scene);
	return out;
}

/* ---- irradiance ---- */

/* Irradiance / (pi L) of a level plane at the origin under a sphere: (R / d)^2 cos(beta), or if a
 * part is below the horizon, with H = d / R, x = sqrt(H^2 - 1) and y = -x cot(beta),
 *
 *     ((cos(beta) acos(y) - x w) / H^2 + atan(w / x)) / pi,      w = sin(beta) sqrt(1 - y^2)
 */
static double level_irradiance(struct truth_lamp lamp)
{
	const double d = (double)v3_length(lamp.centre), h = d / (double)lamp.radius;
	const double cosine = (double)lamp.centre.z / d, sine = sqrt(1 - cosine * cosine);
	const double x = sqrt(h * h - 1), y = -x * cosine / sine, w = sine * sqrt(1 - y * y);

	if (h * cosine >= 1)
		return cosine / (h * h);
	return ((cosine * acos(y) - x * w) / (h * h) + atan(w / x)) / M_PI;
}

/* Flat ground, a stand-in and an object take three different ways through the tracer. */
TEST("irradiance")
{
	const struct truth_lamp lamps[] = {white_lamp(0, 0, 2, 0.3), white_lamp(1.5, 0.8, 1, 0.2),
					   white_lamp(1, 0, 0.1, 0.3),
					   white_lamp(0.6, 0.1, 0, 0.3)};
	static const char *const floors[] = {
		"[ground]\nmaterial = half\n",
		"[standin floor]\nfile = plane.obj\nup = z\nmaterial = half\n",
		"[object floor]\nfile = plane.obj\nup = z\nmaterial = half\n"};

	small_scene_write("plane.obj", "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\n");
	for (int k = 0; k < 3; k++) {
		small_scene_write("plane.ini",
				  SPOT_VIEW
				  "%s[object away]\nfile = plane.obj\nup = z\nscale = 0.001\n"
				  "position = 9 9 -9\n[material half]\ncolour = %g %g %g\n",
				  floors[k], ALBEDO, ALBEDO, ALBEDO);
		for (int i = 0; i < 4; i++) {
			const double want = ALBEDO * level_irradiance(lamps[i]);
			struct image out =
				k == 2 ? traced("plane.ini",
						&(struct sky){.lamps = &lamps[i], .lamp_count = 1},
						0)
				       : seen("plane.ini", lamps[i], NULL);

			expect_below(fabs(mean_of(&out) / want - 1), 0.01, "floor %d, lamp %d", k,
				     i);
		}
	}
}

/* A shell around a white scene is a furnace: all has its radiance. */
TEST("furnace")
{
	static const char *const kinds[] = {"diffuse", "glass"};

	small_scene_write_sphere("ball.obj", 0.8, 16);
	for (int k = 0; k < 2; k++) {
		double mean;

		small_scene_write(
			"furnace.ini",
			"[camera]\nposition = 0 -6 2\nlook_at = 0 0 0.8\nfield_deg = 22\n"
			"width = 14\nheight = 14\n[ground]\nmaterial = white\n"
			"[object ball]\nfile = ball.obj\nup = z\nmaterial = m\nstand = yes\n"
			"[material white]\ncolour = 1 1 1\n[material m]\nkind = %s\n"
			"colour = 1 1 1\n",
			kinds[k]);
		mean = traced_mean("furnace.ini", white_lamp(0, 0, 0, 50), 1);
		print_message("# furnace of a lamp, %s: %.4f\n", kinds[k], mean);
		expect_below(fabs(mean - 1), 0.01, "%s", kinds[k]);
	}
}

/* ---- shadows ---- */

/* Similar triangles: the edge of a box throws its shadow where the line from the lamp meets the
 * ground, which is farther away than from a lamp far away in the same direction. */
TEST("shadow edge")
{
	const double side = 0.3, lamp_x = -1, lamp_z = 1.2;
	const double want = side / 2 + (side / 2 - lamp_x) * side / (lamp_z - side);
	const struct truth_lamp lamp = white_lamp(lamp_x, 0, lamp_z, 0.02);
	const struct sky sky = {.lamps = &lamp, .lamp_count = 1};
	struct scene *scene;
	struct image out;
	double edge = 0.3; /* in the shadow */

	small_scene_write("box.obj",
			  "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nv -1 -1 2\nv 1 -1 2\n"
			  "v 1 1 2\nv -1 1 2\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\n"
			  "f 3 4 8 7\nf 4 1 5 8\n");
	small_scene_write("shadow.ini",
			  "[camera]\nposition = 0.5 -3 3\nlook_at = 0.5 0 0\nfield_deg = 10\n"
			  "width = 65\nheight = 3\n[ground]\n[object box]\nfile = box.obj\n"
			  "up = z\nscale = %g\nmaterial = black\n"
			  "[material black]\ncolour = 0 0 0\n",
			  side / 2);
	scene = small_scene_open("shadow.ini");
	out = traced("shadow.ini", &sky, 1);
	for (int x = 0; x < out.width; x++) {
		double at[2];

		for (int k = 0; k < 2; k++) {
			const double px[2] = {x + k, 1.5};
			double origin[3], d[3];

			assert_int_equal(tsai_ray(&scene->camera, px, origin, d), 0);
			at[k] = fmax(origin[0] - origin[2] / d[2] * d[0], 0.3);
		}
		edge += (at[1] - at[0]) * (1 - (double)out.f32[3 * (out.width + x)]);
	}
	print_message("# the shadow ends at %.4f, expected %.4f\n", edge, want);
	assert_true(fabs(edge - want) < 0.003);
	image_free(&out);
	scene_close(scene);
}

/* What is behind a lamp shades nothing, and panes shade what is before it as they shade the sky. */
TEST("before and behind")
{
	static const char *const plates[] = {"kind = diffuse\ncolour = 0 0 0\n",
					     "kind = glass\nthin = yes\ncolour = 0.3 0.6 0.9\n"};
	static const char *const floors[] = {"[ground]\n",
					     "[standin floor]\nfile = plane.obj\nup = z\n"};

	small_scene_write("plane.obj", "v -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\n");
	for (int k = 0; k < 2 * 2; k++) {
		const bool pane = k % 2;
		double behind, before;

		small_scene_write("plate.ini",
				  SPOT_VIEW "%smaterial = dark\n[object plate]\nfile = plane.obj\n"
					    "up = z\nposition = 0 0 1.1\nmaterial = m\n"
					    "[material dark]\ncolour = 0.001 0.001 0.001\n"
					    "[material m]\n%s",
				  floors[k / 2], plates[k % 2]);
		behind = traced_mean("plate.ini", white_lamp(0, 0, 0.6, 0.1), 1);
		before = traced_mean("plate.ini", white_lamp(0, 0, 1.8, 0.1), 1);
		/* a pane mirrors some of the lamp */
		expect_below(fabs(behind - 1), pane ? 0.1 : 1e-3, "k=%d", k);
		if (!pane) {
			expect_equal(before, 0, "k=%d", k);
			continue;
		}
		expect_below(before, 0.7, "k=%d", k);
		expect_below(
			fabs(before / traced_mean("plate.ini", white_lamp(0, 0, 999, 50), 1) - 1),
			0.02, "k=%d", k);
	}
}

/* ---- a panorama ---- */

/* A lamp far away is the same light as a disc in a panorama. */
TEST("far away")
{
	const int width = 360, parts = 8;
	const double height_rad = 40 * M_PI / 180, angle = 6 * M_PI / 180, far = 1000;
	const struct truth_lamp lamp = white_lamp(-far * cos(height_rad), 0, far * sin(height_rad),
						  far * sin(angle));
	const struct sky lamps = {.lamps = &lamp, .lamp_count = 1};
	struct image image, out[2];
	const struct panorama panorama = {.image = &image, .scale = 1};
	struct fault fault = {.text = ""};
	double square = 0, sum = 0;
	struct sky sky;

	assert_int_equal(image_create_f32(&image, width, width / 2), 0);
	for (int k = 0; k < width * (width / 4) * parts * parts; k++) {
		const int p = k / (parts * parts), part = k % (parts * parts);
		double d[3];

		panorama_direction(&panorama, p % width + (part % parts + 0.5) / parts,
				   p / width + (part / parts + 0.5) / parts, d);
		if (d[2] * sin(height_rad) - d[0] * cos(height_rad) > cos(angle))
			for (int c = 0; c < 3; c++)
				image.f32[3 * p + c] += 1.0f / (float)(parts * parts);
	}
	small_scene_write_sphere("ball.obj", 0.5, 16);
	small_scene_write("far.ini",
			  "[camera]\nposition = 1 -6 2.5\nlook_at = 0.3 0 0.3\nfield_deg = 30\n"
			  "width = 24\nheight = 18\n[ground]\n[object ball]\nfile = ball.obj\n"
			  "up = z\nstand = yes\n");
	expect_success(sky_create(&sky, &panorama, "made", &fault), &fault);
	out[0] = traced("far.ini", &sky, 0.02f);
	out[1] = traced("far.ini", &lamps, 0.02f);
	for (int k = 0; k < 3 * 24 * 18; k++) {
		square += pow((double)(out[0].f32[k] - out[1].f32[k]), 2) / (3 * 24 * 18);
		sum += (double)out[0].f32[k] / (3 * 24 * 18);
	}
	print_message("# far away: RMS %.3f %% of the mean\n", 100 * sqrt(square) / sum);
	assert_true(sqrt(square) < 0.02 * sum);
	for (int k = 0; k < 2; k++)
		image_free(&out[k]);
	sky_free(&sky);
	image_free(&image);
}

/* ---- the fisheye ---- */

/* A fisheye sees the lamp where it is, as large as it is from its place, unless a wall hides it. */
TEST("fisheye")
{
	const int side = 40;
	const struct truth_lamp lamp = white_lamp(1, 0.5, 1.3, 0.05);
	static const struct fisheye_settings lenses[] = {
		{.field_deg = 90},
		{.field_deg = 95, .rotation_deg = {10, -20, 70}, .falloff = {-0.2}}};
	static const struct v3 places[] = {{0, 0, 0}, {0.3, 0, 0.15f}, {-0.3f, 0, 0.3f}};

	small_scene_write("wall.obj",
			  "v 0.5 -9 0\nv 0.5 9 0\nv 0.5 9 0.8\nv 0.5 -9 0.8\nf 1 2 3 4\n");
	for (int k = 0; k < 3 * 2 * 2; k++) {
		const struct v3 way = v3_sub(lamp.centre, places[k % 3]);
		const double d2 = (double)v3_dot(way, way), to[3] = {way.x, way.y, way.z};
		const bool wall = k >= 3 * 2;
		double sum = 0, place[2] = {0, 0}, want[2];
		struct truth_eye eye = {.place = places[k % 3], .side = side};
		struct image out;

		assert_int_equal(fisheye_prepare(&eye.lens, &lenses[k / 3 % 2], side, side, NULL),
				 0);
		small_scene_write("eye.ini",
				  SPOT_VIEW "[object away]\nfile = wall.obj\nup = z\n"
					    "scale = 0.01\n%s[material black]\ncolour = 0 0 0\n",
				  wall ? "[standin wall]\nfile = wall.obj\nup = z\n"
					 "material = black\n"
				       : "");
		out = seen("eye.ini", lamp, &eye);
		for (int p = 0; p < side * side; p++) {
			const double px[2] = {p % side + 0.5, p / side + 0.5};
			const double light = (double)out.f32[3 * p] *
					     fisheye_pixel_sr(&eye.lens, px) /
					     fisheye_falloff(&eye.lens, px);

			sum += light;
			for (int c = 0; c < 2; c++)
				place[c] += light * px[c];
		}
		image_free(&out);
		if (wall) { /* its top hides the lamp from the lower two places */
			expect_that((sum == 0) == (k % 3 < 2), "place %d", k % 3);
			continue;
		}
		assert_true(fisheye_project(&eye.lens, to, want));
		expect_below(fabs(sum / (2 * M_PI * (1 - sqrt(1 - 0.05 * 0.05 / d2))) - 1), 0.02,
			     "eye %d", k);
		for (int c = 0; c < 2; c++)
			expect_below(fabs(place[c] / sum - want[c]), 0.25, "eye %d", k);
	}
}

TEST_GROUP(small_scene_begin, small_scene_end);
