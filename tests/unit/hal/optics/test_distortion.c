/* SPDX-License-Identifier: MIT */
/* The radial polynomial with tangential terms: formula, inverse, fold. */
#include <errno.h>
#include <math.h>

#include "hal/optics/tsai.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

/* As OpenCV prints its formula, with x, y in units of the focal length, which is 1 here. */
static void printed_formula(const struct distortion *d, const double p[2], double bent[2])
{
	const double x = p[0], y = p[1], r2 = x * x + y * y;
	const double p1 = d->tangential[1], p2 = d->tangential[0];
	const double radial = 1 + d->radial[0] * r2 + d->radial[1] * r2 * r2 +
			      d->radial[2] * r2 * r2 * r2;

	bent[0] = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
	bent[1] = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
}

static struct distortion some_distortion(struct chance *chance, double tangential)
{
	struct distortion d = {.reach = 1};

	for (int k = 0; k < DISTORTION_RADIAL; k++)
		d.radial[k] = chance_real(chance, -0.5, 0.5);
	for (int i = 0; i < 2; i++)
		d.tangential[i] = chance_real(chance, -tangential, tangential);
	return d;
}

TEST("bends as printed")
{
	struct chance chance = chance_begin("distortion");

	for (int n = 0; n < 5000; n++) {
		const struct distortion d = some_distortion(&chance, n % 2 ? 0.01 : 0);
		const double p[2] = {chance_real(&chance, -0.6, 0.6),
				     chance_real(&chance, -0.6, 0.6)};
		double bent[2], want[2], slope[3];

		if (distortion_bend(&d, p, bent, slope)) {
			expect_above(hypot(p[0], p[1]), distortion_fold(&d), "n=%d", n);
			continue;
		}
		printed_formula(&d, p, want);
		expect_below(hypot(bent[0] - want[0], bent[1] - want[1]), 1e-14, "n=%d", n);
		for (int i = 0; i < 2; i++) { /* the Jacobian, by central differences */
			const double h = 1e-5;
			const double ahead[2] = {p[0] + (i ? 0 : h), p[1] + (i ? h : 0)};
			const double behind[2] = {p[0] - (i ? 0 : h), p[1] - (i ? h : 0)};
			double a[2], b[2];

			printed_formula(&d, ahead, a);
			printed_formula(&d, behind, b);
			for (int k = 0; k < 2; k++)
				expect_below(fabs((a[k] - b[k]) / (2 * h) - slope[i + k]), 1e-8,
					     "n=%d", n);
		}
	}
}

/* Each point inside of the circle comes back, and each point of the circle that is covered has an
 * inverse. */
TEST("straightens")
{
	struct chance chance = chance_begin("distortion");
	int folded = 0;

	for (int n = 0; n < 20000; n++) {
		const struct distortion d = some_distortion(&chance, n % 2 ? 0.02 : 0);
		const double fold = distortion_fold(&d), covers = distortion_covers(&d);
		const double angle = chance_real(&chance, 0, 2 * M_PI);
		const double r = chance_real(&chance, 0, 0.999) * fmin(fold, 3);
		const double most = chance_real(&chance, 0, 0.999) * fmin(covers, 3);
		const double p[2] = {r * cos(angle), r * sin(angle)};
		const double covered[2] = {most * cos(angle), most * sin(angle)};
		double bent[2], back[2];

		folded += isfinite(fold);
		assert_int_equal(distortion_bend(&d, p, bent, NULL), 0);
		expect_equal(distortion_straighten(&d, bent, back), 0, "n=%d", n);
		/* near the fold the slope is nearly 0 */
		expect_below(hypot(back[0] - p[0], back[1] - p[1]), 1e-9, "n=%d, r=%g", n, r);
		expect_equal(distortion_straighten(&d, covered, back), 0, "n=%d", n);
		printed_formula(&d, back, bent);
		expect_below(hypot(bent[0] - covered[0], bent[1] - covered[1]), 1e-11, "n=%d", n);
	}
	assert_in_range(folded, 5000, 19000);
}

/* The fold is where the radius first stops growing, found here by small steps. */
TEST("folds where it stops growing")
{
	struct chance chance = chance_begin("distortion");

	for (int n = 0; n < 2000; n++) {
		const struct distortion d = some_distortion(&chance, 0);
		const double fold = distortion_fold(&d), step = 1e-3;
		double r = 0, slope = 1;

		while (r < 5 && slope > 0) {
			double s;

			r += step;
			s = r * r;
			slope = 1 +
				s * (3 * d.radial[0] + s * (5 * d.radial[1] + s * 7 * d.radial[2]));
		}
		if (slope > 0)
			expect_above(fold, 5, "n=%d", n);
		else
			expect_at_most(fabs(fold - r), 2 * step, "n=%d, fold=%g", n, fold);
	}
}

/* With tangential terms the circle is smaller: the Jacobian's determinant is positive in it. */
TEST("circle of tangential terms")
{
	struct chance chance = chance_begin("distortion");

	for (int n = 0; n < 300; n++) {
		const struct distortion d = some_distortion(&chance, 0.05);
		const double fold = fmin(distortion_fold(&d), 3);

		for (int k = 0; k < 300; k++) {
			const double angle = chance_real(&chance, 0, 2 * M_PI);
			const double r = fold * sqrt(chance_real(&chance, 0, 1)) * 0.9999;
			const double p[2] = {r * cos(angle), r * sin(angle)};
			double bent[2], slope[3];

			assert_int_equal(distortion_bend(&d, p, bent, slope), 0);
			expect_above(slope[0] * slope[2] - slope[1] * slope[1], 0, "n=%d", n);
			expect_above(slope[0] + slope[2], 0, "n=%d", n);
		}
	}
}

TEST("extremes")
{
	static const double values[] = {0, -1e-300, 1e300, -1e300, INFINITY, NAN, 1, -1, 1e6, -1e6};
	enum { COUNT = sizeof(values) / sizeof(*values) };

	for (int a = 0; a < COUNT; a++)
		for (int b = 0; b < COUNT; b++)
			for (int c = 0; c < COUNT; c++)
				for (int e = 0; e < COUNT; e++) {
					const struct distortion d = {
						.radial = {values[a], values[b], values[c]},
						.tangential = {0, e % 2 ? 1e-3 : 0},
						.reach = 1};
					const double point[2] = {values[e], 1};
					double there[2] = {0, 0};

					if (!distortion_bend(&d, point, there, NULL))
						assert_true(isfinite(there[0] + there[1]));
					if (!distortion_straighten(&d, point, there))
						assert_true(isfinite(there[0] + there[1]));
				}
}
