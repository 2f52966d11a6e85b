/* SPDX-License-Identifier: MIT */
/* Tsai's camera: the equations of the thesis, their inverse, and invalid arguments. */
#include <errno.h>
#include <float.h>
#include <math.h>
#include <string.h>

#include "hal/ini/ini.h"
#include "hal/optics/tsai.h"
#include "hal/optics/vec.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static const double eye[3] = {3, -4, 2}, target[3] = {0.2, 0.1, 0.5};

static struct tsai_camera example(double kappa1)
{
	struct tsai_camera c;

	assert_int_equal(tsai_look_at(&c, 640, 480, eye, target, 40, NULL), 0);
	c.kappa1 = kappa1;
	c.aspect = 1.03;
	c.centre_px[0] = 311.5;
	c.centre_px[1] = 250.25;
	c.pixel[1] *= 0.97;
	return c;
}

/* Equations 2.1 to 2.7 as printed; Y up from the lower left corner. */
static void printed_equations(const struct tsai_camera *c, const double w[3], double px[2])
{
	const double *r = c->rotation;
	const double x = r[0] * w[0] + r[1] * w[1] + r[2] * w[2] + c->translation[0];
	const double y = r[3] * w[0] + r[4] * w[1] + r[5] * w[2] + c->translation[1];
	const double z = r[6] * w[0] + r[7] * w[1] + r[8] * w[2] + c->translation[2];
	const double ux = c->focal * x / z, uy = c->focal * y / z;
	const double bend = 1 + c->kappa1 * (ux * ux + uy * uy);

	px[0] = c->centre_px[0] + c->aspect * ux * bend / c->pixel[0];
	px[1] = c->height - (c->centre_px[1] - uy * bend / c->pixel[1]);
}

TEST("projects as printed")
{
	const struct tsai_camera c = example(2e-4);
	struct chance chance = chance_begin("tsai");

	for (int k = 0; k < 10000; k++) {
		double w[3], px[2], want[2];

		for (int i = 0; i < 3; i++)
			w[i] = chance_real(&chance, -1, 1);
		assert_int_equal(tsai_project(&c, w, px), 0);
		printed_equations(&c, w, want);
		expect_below(hypot(px[0] - want[0], px[1] - want[1]), 1e-10, "k=%d", k);
	}
}

TEST("looks at its target")
{
	const double above[3] = {0.2, 0.1, 1}, right[3] = {0.2 + 0.4, 0.1 + 0.3, 0.5};
	struct tsai_camera c;
	double px[2], origin[3], dir[3];

	assert_int_equal(tsai_look_at(&c, 640, 480, eye, target, 40, NULL), 0);
	assert_int_equal(tsai_project(&c, target, px), 0);
	assert_true(hypot(px[0] - 320, px[1] - 240) < 1e-9);
	assert_int_equal(tsai_project(&c, above, px), 0);
	assert_true(fabs(px[0] - 320) < 1e-9 && px[1] < 230);
	assert_int_equal(tsai_project(&c, right, px), 0); /* seen from -Y, +X is on the right */
	assert_true(px[0] > 330);
	/* between the left and right edges lies the field of view */
	assert_int_equal(tsai_ray(&c, (double[]){0, 240}, origin, dir), 0);
	assert_true(fabs(acos(vec_dot(dir, c.rotation + 6)) - 20 * M_PI / 180) < 1e-9);
	for (int i = 0; i < 3; i++)
		expect_below(fabs(origin[i] - eye[i]), 1e-12, "i=%d", i);
}

TEST("round trip")
{
	static const double kappas[] = {0, 1e-300, 1e-9, 1e-4, 0.1, 100, -1e-300, -1e-9, -2e-4};
	struct chance chance = chance_begin("tsai");

	for (unsigned k = 0; k < 2 * sizeof(kappas) / sizeof(*kappas); k++) {
		struct tsai_camera c = example(kappas[k / 2]);

		c.distortion = k & 1;
		for (int n = 0; n < 5000; n++) {
			const double px[2] = {chance_real(&chance, -50, 700),
					      chance_real(&chance, -50, 530)};
			const double far = pow(10, chance_real(&chance, -2, 3));
			double origin[3], dir[3], point[3], back[2];

			assert_int_equal(tsai_ray(&c, px, origin, dir), 0);
			expect_below(fabs(vec_length(dir) - 1), 1e-14, "k=%u, n=%d", k, n);
			for (int i = 0; i < 3; i++)
				point[i] = origin[i] + far * dir[i];
			assert_int_equal(tsai_project(&c, point, back), 0);
			/* At a camera 5 away from the origin, a point at distance 1e-2 keeps 13
			 * digits, fewer where the ray is nearly perpendicular to the axis. */
			expect_below(hypot(back[0] - px[0], back[1] - px[1]),
				     1e-9 / fmin(far, 1) / vec_dot(dir, c.rotation + 6),
				     "k=%u, n=%d", k, n);
		}
	}
}

/* More terms, in both directions; the thesis's is OpenCV's formula. */
TEST("more terms")
{
	struct chance chance = chance_begin("tsai terms");

	for (int n = 0; n < 2000; n++) {
		struct tsai_camera c = example(chance_real(&chance, -3e-4, 3e-4));
		const double px[2] = {chance_real(&chance, 0, 640), chance_real(&chance, 0, 480)};
		double origin[3], dir[3], point[3], back[2], camera[3], straight[2], bent[2];
		struct distortion d;

		c.kappa2 = chance_real(&chance, -3e-7, 3e-7);
		c.kappa3 = n & 2 ? chance_real(&chance, 0, 1e-9) : 0;
		c.tangential[0] = n & 4 ? 1e-5 : 0;
		c.tangential[1] = n & 4 ? -2e-5 : 0;
		c.distortion = n & 1;
		if (tsai_check(&c, NULL)) /* it folds over */
			continue;
		assert_int_equal(tsai_ray(&c, px, origin, dir), 0);
		for (int i = 0; i < 3; i++)
			point[i] = origin[i] + dir[i];
		assert_int_equal(tsai_project(&c, point, back), 0);
		expect_below(hypot(back[0] - px[0], back[1] - px[1]), 1e-8, "n=%d", n);
		if (c.distortion != TSAI_DISTORTS)
			continue;
		mat_apply(c.rotation, dir, camera);
		d = tsai_distortion_of(&c);
		for (int i = 0; i < 2; i++)
			straight[i] = c.focal * camera[i] / camera[2];
		assert_int_equal(distortion_bend(&d, straight, bent, NULL), 0);
		expect_below(fabs(c.centre_px[0] + c.aspect * bent[0] / c.pixel[0] - px[0]), 1e-8,
			     "n=%d", n);
		expect_below(fabs(c.height - c.centre_px[1] + bent[1] / c.pixel[1] - px[1]), 1e-8,
			     "n=%d", n);
	}
}

/* Several terms that fold over inside of the picture are refused, in either direction. */
TEST("refuses what folds")
{
	struct tsai_camera c = example(0);
	const struct distortion d = tsai_distortion_of(&c);
	const double corner = d.reach;
	struct fault fault = {.text = ""};

	for (int way = 0; way < 2; way++) {
		c.distortion = way;
		c.kappa2 = -1 / (5 * pow(corner * (way ? 1.01 : 1.26), 4)); /* 1.26 covers 1.008 */
		assert_int_equal(tsai_check(&c, &fault), 0);
		c.kappa2 = -1 / (5 * pow(corner * (way ? 0.99 : 1.24), 4));
		assert_int_equal(tsai_check(&c, &fault), -EINVAL);
		assert_non_null(strstr(fault.text, "fold the picture over"));
	}
}

TEST("has no image")
{
	const double behind[3] = {6, -8, 3};
	struct tsai_camera c = example(0);
	double px[2] = {-1, -1}, origin[3], dir[3], w[3];

	assert_int_equal(tsai_project(&c, behind, px), -ERANGE);
	assert_int_equal(tsai_project(&c, eye, px), -ERANGE);
	w[0] = w[1] = w[2] = NAN;
	assert_int_equal(tsai_project(&c, w, px), -ERANGE);
	w[0] = w[1] = w[2] = INFINITY;
	assert_int_equal(tsai_project(&c, w, px), -ERANGE);
	assert_true(px[0] == -1 && px[1] == -1);

	/* A fold at radius 10: points beyond it would appear twice, and have no image. */
	c.kappa1 = -1 / (3 * 10.0 * 10.0);
	for (int k = 0; k < 200; k++) {
		const double radius = k * 0.1;
		double camera[3] = {radius, 0, c.focal};

		for (int i = 0; i < 3; i++)
			camera[i] -= c.translation[i];
		mat_apply_transposed(c.rotation, camera, w);
		if (fabs(radius - 10) > 1e-9)
			expect_equal(tsai_project(&c, w, px), radius < 10 ? 0 : -ERANGE, "k=%d", k);
	}
	/* the distorted radius is at most 2/3 of the fold's */
	for (int k = 0; k < 200; k++) {
		const double radius = k * 0.05;

		px[0] = c.centre_px[0];
		px[1] = c.height - c.centre_px[1] + radius / c.pixel[1];
		if (fabs(radius - 20.0 / 3) > 1e-9)
			expect_equal(tsai_ray(&c, px, origin, dir), radius < 20.0 / 3 ? 0 : -ERANGE,
				     "k=%d", k);
	}
	assert_int_equal(tsai_ray(&c, (double[]){NAN, 0}, origin, dir), -ERANGE);
	assert_int_equal(tsai_ray(&c, (double[]){0, INFINITY}, origin, dir), -ERANGE);
}

/* Tsai's own direction: the equation gives the undistorted point from the distorted one. */
TEST("projects as tsai printed")
{
	static const double kappas[] = {0, 2e-4, 0.1, -2e-4};
	struct chance chance = chance_begin("tsai");

	for (int k = 0; k < 4; k++)
		for (int n = 0; n < 5000; n++) {
			struct tsai_camera c = example(kappas[k]);
			double w[3], px[2], x, y, back, seen[3];

			c.distortion = TSAI_UNDISTORTS;
			for (int i = 0; i < 3; i++)
				w[i] = chance_real(&chance, -1, 1);
			assert_int_equal(tsai_project(&c, w, px), 0);
			x = (px[0] - c.centre_px[0]) * c.pixel[0] / c.aspect;
			y = (px[1] - (c.height - c.centre_px[1])) * c.pixel[1];
			back = 1 + kappas[k] * (x * x + y * y);
			mat_apply(c.rotation, w, seen);
			for (int i = 0; i < 3; i++)
				seen[i] += c.translation[i];
			expect_below(fabs(x * back - c.focal * seen[0] / seen[2]), 1e-12,
				     "k=%d, n=%d", k, n);
			expect_below(fabs(y * back - c.focal * seen[1] / seen[2]), 1e-12,
				     "k=%d, n=%d", k, n);
		}
}

/* A fold at radius 10 of the distorted picture: no ray beyond it, and points whose image would lie
 * beyond it have none. */
TEST("has no image as tsai printed")
{
	struct tsai_camera c = example(-1 / (3 * 10.0 * 10.0));
	double px[2], origin[3], dir[3], w[3];

	c.distortion = TSAI_UNDISTORTS;
	for (int k = 0; k < 200; k++) {
		const double radius = k * 0.1;
		double camera[3] = {radius, 0, c.focal};

		px[0] = c.centre_px[0];
		px[1] = c.height - c.centre_px[1] + radius / c.pixel[1];
		if (fabs(radius - 10) > 1e-9)
			expect_equal(tsai_ray(&c, px, origin, dir), radius < 10 ? 0 : -ERANGE,
				     "k=%d", k);
		for (int i = 0; i < 3; i++)
			camera[i] -= c.translation[i];
		mat_apply_transposed(c.rotation, camera, w);
		if (fabs(radius - 20.0 / 3) > 1e-9)
			expect_equal(tsai_project(&c, w, px), radius < 20.0 / 3 ? 0 : -ERANGE,
				     "k=%d", k);
	}
	assert_int_equal(tsai_ray(&c, (double[]){NAN, 0}, origin, dir), -ERANGE);
	assert_int_equal(tsai_ray(&c, (double[]){0, INFINITY}, origin, dir), -ERANGE);
	c.kappa1 = 1;
	assert_int_equal(tsai_ray(&c, (double[]){0, INFINITY}, origin, dir), -ERANGE);
	assert_int_equal(tsai_ray(&c, (double[]){NAN, 0}, origin, dir), -ERANGE);
}

/* Smallest root by bisection in long double, on the rising branch. */
static long double bisected(double kappa1, double distorted)
{
	long double low = 0, high = distorted;

	if (kappa1 < 0)
		high = 1 / sqrtl(-3 * (long double)kappa1);
	for (int k = 0; k < 20000 && low < high; k++) {
		const long double middle = low + (high - low) / 2;

		if (middle == low || middle == high)
			break;
		if (middle * (1 + kappa1 * middle * middle) < distorted)
			low = middle;
		else
			high = middle;
	}
	return low;
}

TEST("undistorts as bisection does")
{
	struct chance chance = chance_begin("undistort");

	for (int n = 0; n < 20000; n++) {
		const double size = pow(10, chance_real(&chance, -30, 30));
		const double kappa1 = n & 1 ? size : -size;
		const double fold = 1 / sqrt(3 * size);
		const double distorted = kappa1 > 0 ? fold * pow(10, chance_real(&chance, -9, 9))
						    : fold * chance_real(&chance, 0, 0.6666);
		double r;

		assert_int_equal(tsai_straight_radius(kappa1, distorted, &r), 0);
		expect_at_most(fabsl(r - bisected(kappa1, distorted)),
			       1e-12L * bisected(kappa1, distorted), "n=%d", n);
	}
}

TEST("undistorts extremes")
{
	static const double values[] = {0,   5e-324, 2.3e-308, 1e-300, 1e-150,	1e-16,	  1e-3, 1,
					1e3, 1e16,   1e150,    1e300,  1.7e308, INFINITY, NAN};
	const int count = sizeof(values) / sizeof(*values);

	for (int i = 0; i < 2 * count; i++)
		for (int j = 0; j < 2 * count; j++) {
			const double kappa1 = i < count ? values[i] : -values[i - count];
			const double distorted = j < count ? values[j] : -values[j - count];
			double r = -1;
			const int ret = tsai_straight_radius(kappa1, distorted, &r);

			if (!isfinite(kappa1) || !isfinite(distorted) || distorted < 0) {
				expect_equal(ret, -ERANGE, "i=%d, j=%d", i, j);
			} else if (ret == 0) {
				const long double k = kappa1, x = r;

				expect_that(isfinite(r) && r >= 0, "i=%d, j=%d", i, j);
				expect_at_most(fabsl(x + k * x * x * x - distorted),
					       1e-14L * distorted, "i=%d, j=%d", i, j);
			} else {
				expect_equal(ret, -ERANGE, "i=%d, j=%d", i, j);
				expect_below(kappa1, 0, "i=%d, j=%d", i,
					     j); /* a rising cubic always has a root */
				expect_above(distorted * sqrt(-kappa1), 0.3848, "i=%d, j=%d", i, j);
			}
		}
}

TEST("at the fold")
{
	for (int e = -200; e <= 200; e += 7) {
		const double kappa1 = -pow(10, e), fold = 1 / sqrt(-3 * kappa1);
		double r;

		assert_int_equal(tsai_straight_radius(kappa1, fold * 2 / 3, &r), 0);
		expect_that(fabs(r / fold - 1) < 1e-7 && r <= fold * (1 + 1e-15), "e=%d", e);
		expect_equal(tsai_straight_radius(kappa1, fold * 0.66667, &r), -ERANGE, "e=%d", e);
	}
}

TEST("checks its fields")
{
	const struct tsai_camera good = example(1e-4);
	struct tsai_camera c = good;

	assert_int_equal(tsai_check(&c, NULL), 0);
#define REFUSES(field, value)                                                                      \
	do {                                                                                       \
		struct fault fault = {""};                                                         \
		c = good;                                                                          \
		c.field = value;                                                                   \
		assert_int_equal(tsai_check(&c, &fault), -EINVAL);                                 \
		assert_true(strlen(fault.text) > 0);                                               \
	} while (0)
	REFUSES(width, 0);
	REFUSES(height, TSAI_SIDE_MAX + 1);
	REFUSES(distortion, 2);
	REFUSES(distortion, -1);
	REFUSES(focal, 0);
	REFUSES(focal, NAN);
	REFUSES(kappa1, INFINITY);
	REFUSES(kappa2, NAN);
	REFUSES(kappa3, INFINITY);
	REFUSES(tangential[1], NAN);
	REFUSES(aspect, -1);
	REFUSES(pixel[1], 0);
	REFUSES(centre_px[0], NAN);
	REFUSES(translation[2], INFINITY);
	REFUSES(rotation[4], good.rotation[4] + 1e-5);
	REFUSES(rotation[0], NAN);
#undef REFUSES
	c = good; /* a mirror is no rotation */
	for (int i = 0; i < 3; i++)
		c.rotation[i] = -c.rotation[i];
	assert_int_equal(tsai_check(&c, NULL), -EINVAL);
	c = good; /* rounded to seven digits, it is made orthonormal again */
	for (int i = 0; i < 9; i++)
		c.rotation[i] = rint(c.rotation[i] * 1e7) / 1e7;
	assert_int_equal(tsai_check(&c, NULL), 0);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			expect_below(
				fabs(vec_dot(c.rotation + 3 * i, c.rotation + 3 * j) - (i == j)),
				1e-15, "i=%d, j=%d", i, j);
	for (int i = 0; i < 9; i++)
		expect_below(fabs(c.rotation[i] - good.rotation[i]), 1e-7, "i=%d", i);
}

TEST("look at refuses")
{
	const double up[3] = {3, -4, 9}, nowhere[3] = {NAN, 0, 0};
	struct tsai_camera c;

	assert_int_equal(tsai_look_at(&c, 640, 480, eye, eye, 40, NULL), -EINVAL);
	assert_int_equal(tsai_look_at(&c, 640, 480, eye, up, 40, NULL), -EINVAL);
	assert_int_equal(tsai_look_at(&c, 640, 480, eye, nowhere, 40, NULL), -EINVAL);
	assert_int_equal(tsai_look_at(&c, 640, 480, eye, target, 180, NULL), -EINVAL);
	assert_int_equal(tsai_look_at(&c, 640, 480, eye, target, 0, NULL), -EINVAL);
	assert_int_equal(tsai_look_at(&c, 0, 480, eye, target, 40, NULL), -EINVAL);
}

static void *place(void *root, const char *instance)
{
	(void)instance;
	return root;
}

/* Each key of a file sets the field that it names. */
TEST("keys fill every field")
{
	static const char text[] =
		"[camera]\n"
		"width = 320\nheight = 200\n"
		"rotation = 0 -1 0  1 0 0  0 0 1\n"
		"translation = 1 2 3\nfocal = 8.5\nkappa1 = -0.001\n"
		"kappa2 = 1e-5\nkappa3 = 2e-8\ntangential = 1e-4 -2e-4\n"
		"distortion = undistorts\n"
		"centre = 161 99\npixel = 0.01 0.02\naspect = 1.05\nedge_spread = 0.7\n";
	const struct ini_table tables[] = {{.section = "camera", .keys = tsai_keys, .place = place},
					   INI_TABLES_END};
	const struct tsai_camera want = {.width = 320,
					 .height = 200,
					 .rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1},
					 .translation = {1, 2, 3},
					 .focal = 8.5,
					 .kappa1 = -0.001,
					 .kappa2 = 1e-5,
					 .kappa3 = 2e-8,
					 .tangential = {1e-4, -2e-4},
					 .distortion = TSAI_UNDISTORTS,
					 .centre_px = {161, 99},
					 .pixel = {0.01, 0.02},
					 .aspect = 1.05,
					 .edge_spread_px = 0.7};
	struct ini_report report = {.count = 0};
	struct tsai_camera c;

	memset(&c, 0, sizeof(c));
	ini_defaults(tsai_keys, &c);
	/* older files give no direction of distortion, and mean the thesis's */
	assert_true(c.aspect == 1 && c.kappa1 == 0 && c.distortion == TSAI_DISTORTS);
	assert_true(tsai_is_plain(&c));
	/* and files of one kappa are written as they were */
	for (const struct ini_key *key = tsai_keys; key->name; key++)
		assert_int_equal(ini_left_out(key, &c), !strcmp(key->name, "kappa2") ||
								!strcmp(key->name, "kappa3") ||
								!strcmp(key->name, "tangential") ||
								!strcmp(key->name, "edge_spread"));
	assert_int_equal(
		ini_read_memory(text, strlen(text), "camera.ini", ".", tables, &c, &report), 0);
	assert_int_equal(c.width, want.width);
	assert_int_equal(c.height, want.height);
	assert_memory_equal(c.rotation, want.rotation, sizeof(c.rotation));
	assert_memory_equal(c.translation, want.translation, sizeof(c.translation));
	assert_memory_equal(c.centre_px, want.centre_px, sizeof(c.centre_px));
	assert_memory_equal(c.pixel, want.pixel, sizeof(c.pixel));
	assert_int_equal(c.distortion, want.distortion);
	assert_true(c.kappa2 == want.kappa2 && c.kappa3 == want.kappa3);
	assert_memory_equal(c.tangential, want.tangential, sizeof(c.tangential));
	for (const struct ini_key *key = tsai_keys; key->name; key++)
		assert_false(ini_left_out(key, &c));
	assert_true(c.focal == want.focal && c.kappa1 == want.kappa1 && c.aspect == want.aspect);
	assert_true(c.edge_spread_px == want.edge_spread_px);
	assert_int_equal(tsai_check(&c, NULL), 0);
}
