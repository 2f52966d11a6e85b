/* SPDX-License-Identifier: MIT */
/* The fisheye lens: projection and its inverse, and solid angles against triangles on the sphere.
 */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "hal/optics/fisheye.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static struct fisheye lens_of(const struct fisheye_settings *settings, int width, int height)
{
	struct fisheye lens;

	assert_int_equal(fisheye_prepare(&lens, settings, width, height, NULL), 0);
	return lens;
}

TEST("unrotated lies on its back")
{
	const struct fisheye lens = lens_of(&(struct fisheye_settings){.field_deg = 90}, 640, 480);
	const double along_x[3] = {1, 0, 1}, along_y[3] = {0, 2, 2}, up[3] = {0, 0, 5};
	const double horizon[3] = {-1, 0, 0}, below[3] = {1, 0, -0.01}, none[3] = {0, 0, 0};
	double px[2];

	assert_true(fisheye_project(&lens, up, px));
	assert_true(px[0] == 320 && px[1] == 240);
	assert_true(fisheye_project(&lens, along_x, px)); /* 45 degrees: half way to the rim */
	assert_true(fabs(px[0] - 440) < 1e-12 && fabs(px[1] - 240) < 1e-12);
	assert_true(fisheye_project(&lens, along_y, px));
	assert_true(fabs(px[0] - 320) < 1e-12 && fabs(px[1] - 360) < 1e-12);
	assert_true(fisheye_project(&lens, horizon, px));
	assert_true(fabs(px[0] - 80) < 1e-12 && fabs(px[1] - 240) < 1e-12);
	assert_false(fisheye_project(&lens, below, px));
	assert_false(fisheye_project(&lens, none, px));
	assert_false(fisheye_project(&lens, (double[]){NAN, 0, 1}, px));
}

TEST("separate focal lengths")
{
	const struct fisheye_settings settings = {
		.focal_px = {150, 75}, .centre_px = {100, 60}, .field_deg = 90};
	const struct fisheye lens = lens_of(&settings, 320, 240);
	const double theta = 0.7, phi = 2.1;
	const double dir[3] = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
	double px[2];

	assert_true(fisheye_project(&lens, dir, px));
	assert_true(fabs(px[0] - (100 + 150 * theta * cos(phi))) < 1e-12);
	assert_true(fabs(px[1] - (60 + 75 * theta * sin(phi))) < 1e-12);
}

/* Turns v about axis 0, 1 or 2, counter-clockwise as seen from the tip of the axis. */
static void test_fisheye_turn(double v[3], int axis, double deg)
{
	const double c = cos(deg * M_PI / 180), s = sin(deg * M_PI / 180);
	const int a = (axis + 1) % 3, b = (axis + 2) % 3;
	const double x = v[a], y = v[b];

	v[a] = c * x - s * y;
	v[b] = s * x + c * y;
}

TEST("rotates about x then y then z")
{
	const struct fisheye_settings settings = {.rotation_deg = {20, -35, 110}, .field_deg = 180};
	const struct fisheye lens = lens_of(&settings, 400, 400);
	const struct fisheye plain = lens_of(&(struct fisheye_settings){.field_deg = 180}, 400,
					     400);
	struct chance chance = chance_begin("fisheye");

	for (int k = 0; k < 1000; k++) {
		double dir[3], turned[3], px[2], want[2];

		chance_direction(&chance, -0.999, dir);
		memcpy(turned, dir, sizeof(dir));
		for (int axis = 0; axis < 3; axis++)
			test_fisheye_turn(turned, axis, settings.rotation_deg[axis]);
		expect_that(fisheye_project(&lens, dir, px), "k=%d", k);
		expect_that(fisheye_project(&plain, turned, want), "k=%d", k);
		expect_below(hypot(px[0] - want[0], px[1] - want[1]), 1e-9, "k=%d", k);
	}
}

TEST("round trip")
{
	struct chance chance = chance_begin("fisheye");

	for (int k = 0; k < 100; k++) {
		struct fisheye_settings settings = {.model = FISHEYE_EQUIDISTANT};
		struct fisheye lens;

		for (int i = 0; i < 3; i++)
			settings.rotation_deg[i] = chance_real(&chance, -360, 360);
		for (int i = 0; i < 2; i++) {
			settings.focal_px[i] = chance_real(&chance, 20, 900);
			settings.centre_px[i] = chance_real(&chance, 1, 900);
		}
		settings.field_deg = chance_real(&chance, 1, 180);
		lens = lens_of(&settings, 640, 480);
		for (int n = 0; n < 200; n++) {
			const double theta = chance_real(&chance, 0, lens.field_rad * 0.999999);
			const double phi = chance_real(&chance, 0, 2 * M_PI);
			const double px[2] = {
				settings.centre_px[0] + settings.focal_px[0] * theta * cos(phi),
				settings.centre_px[1] + settings.focal_px[1] * theta * sin(phi)};
			double dir[3], back[2];

			expect_that(fisheye_ray(&lens, px, dir), "k=%d, n=%d", k, n);
			expect_below(fabs(vec_length(dir) - 1), 1e-15, "k=%d, n=%d", k, n);
			/* the angle from the axis is the picture's */
			expect_below(fabs(atan2(hypot(vec_dot(lens.rotation, dir),
						      vec_dot(lens.rotation + 3, dir)),
						vec_dot(lens.rotation + 6, dir)) -
					  theta),
				     1e-12, "k=%d, n=%d", k, n);
			expect_that(fisheye_project(&lens, dir, back), "k=%d, n=%d", k, n);
			/* near straight behind, sin(theta) has few digits */
			expect_below(hypot(back[0] - px[0], back[1] - px[1]),
				     1e-9 / fmax(1e-3, fmin(1, M_PI - theta)), "k=%d, n=%d", k, n);
		}
	}
}

TEST("nothing outside the field")
{
	const struct fisheye_settings settings = {.focal_px = {100, 100}, .field_deg = 60};
	const struct fisheye lens = lens_of(&settings, 400, 400);
	const double rim = 100 * M_PI / 3;
	double dir[3], px[2];

	for (int k = 0; k < 360; k++) {
		const double c = cos(k * M_PI / 180), s = sin(k * M_PI / 180);
		const double inside[2] = {200 + c * (rim - 1e-6), 200 + s * (rim - 1e-6)};
		const double outside[2] = {200 + c * (rim + 1e-6), 200 + s * (rim + 1e-6)};
		const double at_61[3] = {sin(61 * M_PI / 180) * c, sin(61 * M_PI / 180) * s,
					 cos(61 * M_PI / 180)};

		expect_that(fisheye_ray(&lens, inside, dir), "k=%d", k);
		expect_above(fisheye_pixel_sr(&lens, inside), 0, "k=%d", k);
		assert_false(fisheye_ray(&lens, outside, dir));
		expect_equal(fisheye_pixel_sr(&lens, outside), 0, "k=%d", k);
		assert_false(fisheye_project(&lens, at_61, px));
	}
}

/* A light on the horizon is on the rim of a lens of 90 degrees, not beyond it. */
TEST("the horizon is in the field")
{
	struct fisheye_settings settings = {.field_deg = 90};

	for (int turned = 0; turned < 360; turned += 7) {
		struct fisheye lens;

		settings.rotation_deg[2] = turned;
		lens = lens_of(&settings, 480, 480);
		for (int k = 0; k < 3600; k++) {
			const double dir[3] = {cos(k * M_PI / 1800), sin(k * M_PI / 1800), 0};
			double px[2];

			expect_that(fisheye_project(&lens, dir, px), "turned=%d, k=%d", turned, k);
		}
	}
}

/* Solid angle of a triangle by L'Huilier's theorem, which the code does not use. */
static double triangle_sr(const double a[3], const double b[3], const double c[3])
{
	const double *v[3] = {a, b, c};
	double side[3], s = 0, t;

	for (int i = 0; i < 3; i++) {
		double d[3];

		for (int k = 0; k < 3; k++)
			d[k] = v[(i + 1) % 3][k] - v[(i + 2) % 3][k];
		side[i] = 2 * asin(fmin(1, vec_length(d) / 2));
		s += side[i] / 2;
	}
	t = tan(s / 2) * tan((s - side[0]) / 2) * tan((s - side[1]) / 2) * tan((s - side[2]) / 2);
	return 4 * atan(sqrt(fmax(t, 0)));
}

TEST("pixel solid angle")
{
	const struct fisheye_settings settings = {
		.focal_px = {200, 130}, .rotation_deg = {10, 20, 30}, .field_deg = 170};
	const struct fisheye lens = lens_of(&settings, 1400, 1000);
	struct chance chance = chance_begin("fisheye");

	for (int n = 0; n < 5000; n++) {
		const double px[2] = {700 + chance_real(&chance, -380, 380),
				      500 + chance_real(&chance, -240, 240)};
		double corner[4][3], sr;

		for (int k = 0; k < 4; k++)
			expect_that(fisheye_ray(&lens,
						(double[]){px[0] + (k & 1) - 0.5,
							   px[1] + (k >> 1) - 0.5},
						corner[k]),
				    "n=%d, k=%d", n, k);
		sr = triangle_sr(corner[0], corner[1], corner[3]) +
		     triangle_sr(corner[0], corner[3], corner[2]);
		expect_below(fabs(fisheye_pixel_sr(&lens, px) / sr - 1), 1e-3, "n=%d", n);
	}
	/* the limit on the axis */
	assert_true(fabs(fisheye_pixel_sr(&lens, lens.centre_px) - 1 / (200.0 * 130)) < 1e-18);
}

TEST("a hemisphere is two pi")
{
	const struct fisheye_settings settings = {.focal_px = {140, 90}, .field_deg = 90};
	const struct fisheye lens = lens_of(&settings, 480, 320);
	const int parts = 4;
	double sum = 0;

	for (int y = 0; y < 320 * parts; y++)
		for (int x = 0; x < 480 * parts; x++)
			sum += fisheye_pixel_sr(&lens,
						(double[]){(x + 0.5) / parts, (y + 0.5) / parts});
	assert_true(fabs(sum / (parts * parts) - 2 * M_PI) < 1e-4 * 2 * M_PI);
}

/* A lens of each model, with its widest possible field. */
static const struct fisheye_settings of_models[] = {
	{.focal_px = {210, 140}, .field_deg = 175, .model = FISHEYE_EQUIDISTANT},
	{.focal_px = {210, 140}, .field_deg = 175, .model = FISHEYE_EQUISOLID},
	{.focal_px = {210, 140}, .field_deg = 150, .model = FISHEYE_STEREOGRAPHIC},
	{.focal_px = {410, 340}, .field_deg = 90, .model = FISHEYE_ORTHOGRAPHIC},
	{.focal_px = {210, 140},
	 .field_deg = 120,
	 .model = FISHEYE_POLYNOMIAL,
	 .polynomial = {0.12, -0.05, 0.012, -0.0009}},
};
#define MODELS (sizeof(of_models) / sizeof(*of_models))

/* Radius in the picture, by the formulas of the header. */
static double printed_radius(const struct fisheye_settings *s, double t)
{
	const double *k = s->polynomial;

	switch (s->model) {
	case FISHEYE_EQUISOLID:
		return 2 * sin(t / 2);
	case FISHEYE_STEREOGRAPHIC:
		return 2 * tan(t / 2);
	case FISHEYE_ORTHOGRAPHIC:
		return sin(t);
	case FISHEYE_POLYNOMIAL:
		return t + k[0] * pow(t, 3) + k[1] * pow(t, 5) + k[2] * pow(t, 7) +
		       k[3] * pow(t, 9);
	default:
		return t;
	}
}

TEST("every model there and back")
{
	struct chance chance = chance_begin("fisheye");

	for (unsigned m = 0; m < MODELS; m++) {
		const struct fisheye_settings *s = &of_models[m];
		const struct fisheye lens = lens_of(s, 1400, 1000);

		for (int n = 0; n < 20000; n++) {
			const double t = chance_real(&chance, 0, n % 2 ? lens.field_rad : 0.01);
			const double phi = chance_real(&chance, 0, 2 * M_PI);
			const double dir[3] = {sin(t) * cos(phi), sin(t) * sin(phi), cos(t)};
			const double r = printed_radius(s, t);
			double px[2], back[3];

			expect_that(fisheye_project(&lens, dir, px), "m=%u, n=%d", m, n);
			expect_below(hypot(px[0] - (700 + s->focal_px[0] * r * cos(phi)),
					   px[1] - (500 + s->focal_px[1] * r * sin(phi))),
				     1e-9, "m=%u, n=%d", m, n);
			expect_that(fisheye_ray(&lens, px, back), "m=%u, n=%d", m, n);
			for (int i = 0; i < 3; i++)
				back[i] -= dir[i];
			/* near its rim sin(t) tells little about t */
			expect_below(vec_length(back),
				     (s->model == FISHEYE_ORTHOGRAPHIC ? 1e-13 / fmax(cos(t), 1e-6)
								       : 1e-12),
				     "m=%u, n=%d", m, n);
		}
	}
}

static double quad_sr(const struct fisheye *lens, const double px[2], double side)
{
	double corner[4][3];

	for (int k = 0; k < 4; k++)
		expect_that(fisheye_ray(lens,
					(double[]){px[0] + side * ((k & 1) - 0.5),
						   px[1] + side * ((k >> 1) - 0.5)},
					corner[k]),
			    "k=%d", k);
	return (triangle_sr(corner[0], corner[1], corner[3]) +
		triangle_sr(corner[0], corner[3], corner[2])) /
	       (side * side);
}

TEST("every model has its solid angles")
{
	struct chance chance = chance_begin("fisheye");

	for (unsigned m = 0; m < MODELS; m++) {
		const struct fisheye lens = lens_of(&of_models[m], 2400, 1800);
		const double span = lens.rim * fmin(lens.focal_px[0], lens.focal_px[1]) * 0.95;

		for (int n = 0; n < 3000; n++) {
			const double r = span * sqrt(chance_real(&chance, 0, 1));
			const double phi = chance_real(&chance, 0, 2 * M_PI);
			const double px[2] = {1200 + r * cos(phi), 900 + r * sin(phi)};

			expect_below(
				fabs(fisheye_pixel_sr(&lens, px) / quad_sr(&lens, px, 0.5) - 1),
				2e-3, "m=%u, n=%d", m, n);
		}
		expect_below(fabs(fisheye_pixel_sr(&lens, lens.centre_px) * lens.focal_px[0] *
					  lens.focal_px[1] -
				  1),
			     1e-12, "m=%u", m);
	}
}

TEST("every model sees a hemisphere")
{
	for (int model = 0; model < FISHEYE_MODEL_COUNT; model++) {
		const struct fisheye_settings settings = {
			.field_deg = 90, .model = model, .polynomial = {0.05, -0.01, 0.001, 0}};
		const struct fisheye lens = lens_of(&settings, 480, 480);
		const int parts = 4;
		double sum = 0;

		/* the image circle fits the picture */
		expect_below(fabs(lens.focal_px[0] * lens.rim - 240), 1e-9, "model=%d", model);
		for (int y = 0; y < 480 * parts; y++)
			for (int x = 0; x < 480 * parts; x++)
				sum += fisheye_pixel_sr(
					&lens, (double[]){(x + 0.5) / parts, (y + 0.5) / parts});
		/* The last half pixel before an orthographic rim holds more than a degree. */
		expect_below(fabs(sum / (parts * parts) / (2 * M_PI) - 1),
			     (model == FISHEYE_ORTHOGRAPHIC ? 0.04 : 1e-4), "model=%d", model);
		expect_that(isfinite(fisheye_pixel_sr(&lens, (double[]){480, 240})), "model=%d",
			    model);
	}
}

/* What is said of a pixel at once is what is said one by one, and directions of two points are
 * never farther apart than the bound of the turn says, but for some steps nearly as far. */
TEST("pixels at once and their turn")
{
	struct chance chance = chance_begin("fisheye");

	for (int model = 0; model < FISHEYE_MODEL_COUNT; model++) {
		const struct fisheye_settings settings = {
			.focal_px = {150, 130},
			.field_deg = model == FISHEYE_ORTHOGRAPHIC ? 70 : 90,
			.model = model,
			.rotation_deg = {5, -8, 30},
			.polynomial = {0.06, -0.02, 0.004, -0.0003},
			.falloff = {-0.3, 0.05}};
		const struct fisheye lens = lens_of(&settings, 480, 480);
		const double turn = fisheye_turn_per_pixel(&lens);
		double most = 0;

		for (int k = 0; k < 20000; k++) {
			const double px[2] = {chance_real(&chance, -5, 485),
					      chance_real(&chance, -5, 485)};
			const double step[2] = {chance_real(&chance, -1, 1),
						chance_real(&chance, -1, 1)};
			const double there[2] = {px[0] + step[0], px[1] + step[1]};
			struct fisheye_pixel pixel;
			double dir[3], beside[3];
			const bool seen = fisheye_ray(&lens, px, dir);

			expect_equal(fisheye_pixel_of(&lens, px, &pixel), seen, "k=%d", k);
			if (!seen)
				continue;
			expect_that(vec_angle(pixel.dir, dir) < 1e-15 &&
					    fabs(pixel.sr / fisheye_pixel_sr(&lens, px) - 1) <
						    1e-14 &&
					    pixel.falloff == fisheye_falloff(&lens, px),
				    "model %d, k=%d", model, k);
			if (fisheye_ray(&lens, there, beside))
				most = fmax(most, vec_angle(dir, beside) / hypot(step[0], step[1]));
		}
		expect_that(most <= turn && most > 0.8 * turn, "model %d: %g of %g", model, most,
			    turn);
	}
}

TEST("folds are named")
{
	/* 1 + 3 k1 u = 0 at u = 1: 57.3 degrees */
	const struct fisheye_settings fold = {
		.field_deg = 90, .model = FISHEYE_POLYNOMIAL, .polynomial = {-1 / 3.0, 0, 0, 0}};
	struct fisheye_settings before = fold;
	const struct fisheye_settings ortho = {.field_deg = 90.1, .model = FISHEYE_ORTHOGRAPHIC};
	const struct fisheye_settings stereo = {.field_deg = 180, .model = FISHEYE_STEREOGRAPHIC};
	/* r(theta) rises at 90 degrees again, but not in between */
	const struct fisheye_settings between = {
		.field_deg = 90, .model = FISHEYE_POLYNOMIAL, .polynomial = {-0.45, 0.08, 0, 0}};
	const struct fisheye_settings dark = {.field_deg = 90, .falloff = {-1, 0, 0}};
	struct fault fault = {""};
	struct fisheye lens;

	before.field_deg = 57.2;
	assert_int_equal(fisheye_prepare(&lens, &before, 480, 480, &fault), 0);
	assert_int_equal(fisheye_prepare(&lens, &fold, 480, 480, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "folds over at 57.3"));
	assert_int_equal(fisheye_prepare(&lens, &between, 480, 480, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "folds over at"));
	assert_int_equal(fisheye_prepare(&lens, &ortho, 480, 480, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "orthographic model folds over at 90"));
	assert_int_equal(fisheye_prepare(&lens, &stereo, 480, 480, &fault), -EINVAL);
	assert_int_equal(fisheye_prepare(&lens, &dark, 480, 480, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "no light 57.3 degrees"));
}

TEST("falloff is of the angle")
{
	const struct fisheye_settings settings = {.focal_px = {200, 100},
						  .field_deg = 90,
						  .model = FISHEYE_EQUISOLID,
						  .falloff = {-0.2, 0.03, -0.004}};
	const struct fisheye lens = lens_of(&settings, 640, 320);
	const double t = 0.9, u = t * t, r = 2 * sin(t / 2);
	const double px[2] = {320 + 200 * r * cos(0.4), 160 + 100 * r * sin(0.4)};

	assert_true(fisheye_falloff(&lens, lens.centre_px) == 1);
	assert_true(fabs(fisheye_falloff(&lens, px) -
			 (1 - 0.2 * u + 0.03 * u * u - 0.004 * u * u * u)) < 1e-12);
	assert_true(fisheye_falloff(&lens, (double[]){0, 0}) == 1);
}

TEST("refused")
{
	const struct fisheye_settings bad[] = {
		{.field_deg = 0},
		{.field_deg = 180.1},
		{.field_deg = NAN},
		{.field_deg = 90, .focal_px = {100, 0}},
		{.field_deg = 90, .focal_px = {-1, -1}},
		{.field_deg = 90, .focal_px = {NAN, 1}},
		{.field_deg = 90, .centre_px = {INFINITY, 1}},
		{.field_deg = 90, .rotation_deg = {0, NAN, 0}},
		{.field_deg = 90, .model = FISHEYE_MODEL_COUNT},
		{.field_deg = 90, .model = -1},
		{.field_deg = 90, .polynomial = {0, 0, NAN, 0}},
		{.field_deg = 90, .falloff = {0, INFINITY, 0}},
	};
	struct fisheye lens;

	for (unsigned i = 0; i < sizeof(bad) / sizeof(*bad); i++) {
		struct fault fault = {""};

		expect_equal(fisheye_prepare(&lens, &bad[i], 480, 480, &fault), -EINVAL, "i=%u", i);
		expect_above(strlen(fault.text), 0, "i=%u", i);
	}
	assert_int_equal(
		fisheye_prepare(&lens, &(struct fisheye_settings){.field_deg = 90}, 0, 480, NULL),
		-EINVAL);
}

static void *place(void *root, const char *instance)
{
	(void)instance;
	return root;
}

TEST("keys fill every field")
{
	static const char text[] =
		"[fisheye]\nfocal = 150 75\ncentre = 161 99\n"
		"rotation = 1 -2 3\nfield = 92.5\nmodel = polynomial\n"
		"polynomial = 0.1 -0.02 0.003 -0.0004\nfalloff = -0.1 0.01 0.001\n";
	const struct ini_table tables[] = {
		{.section = "fisheye", .keys = fisheye_keys, .place = place}, INI_TABLES_END};
	struct ini_report report = {.count = 0};
	struct fisheye_settings settings = {.field_deg = 1};

	ini_defaults(fisheye_keys, &settings);
	assert_true(settings.field_deg == 90);
	assert_int_equal(settings.model, FISHEYE_EQUIDISTANT);
	assert_true(settings.falloff[0] == 0 && settings.polynomial[3] == 0);
	assert_int_equal(
		ini_read_memory(text, strlen(text), "fisheye.ini", ".", tables, &settings, &report),
		0);
	assert_true(settings.focal_px[0] == 150 && settings.focal_px[1] == 75);
	assert_true(settings.centre_px[0] == 161 && settings.centre_px[1] == 99);
	assert_true(settings.rotation_deg[1] == -2 && settings.field_deg == 92.5);
	assert_int_equal(settings.model, FISHEYE_POLYNOMIAL);
	assert_true(settings.polynomial[0] == 0.1 && settings.polynomial[3] == -0.0004);
	assert_true(settings.falloff[0] == -0.1 && settings.falloff[2] == 0.001);
}
