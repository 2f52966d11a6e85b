/* SPDX-License-Identifier: MIT */
/* Views whose errors go together. */
#include <math.h>

#include "bake/calibrate/camera/camera.h"
#include "bake/calibrate/camera/camera_model.h"
#include "bake/calibrate/camera/camera_parts.h"
#include "hal/optics/tsai.h"
#include "tests/support/calibrate/known_camera.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

#define VIEWS 10
#define BEND 0.02 /* m at 1 m from the middle of a board: half a millimetre at its corner */

static const double middle[3] = {0.01, 0.005, 0};

/* Sees flat boards, or boards that are bent by what nobody knows of; in every second view the axis
 * is moved. */
static void see_boards(struct observations *seen, struct tsai_camera *truth, double noise,
		       double bend, double moved_px, struct chance *chance)
{
	*seen = (struct observations){.width = KNOWN_CAMERA_WIDTH, .height = KNOWN_CAMERA_HEIGHT};
	for (int v = 0; v < VIEWS; v++) {
		const int first = seen->count;
		double at[3], by[3];

		chance_direction(chance, 0.5, at);
		for (int k = 0; k < 3; k++) {
			at[k] *= 0.45;
			by[k] = bend * chance_normal(chance);
		}
		*truth = known_camera_roll(known_camera(at, middle, -0.1, TSAI_DISTORTS),
					   chance_real(chance, -3, 3));
		truth->centre_px[0] += 9;
		truth->centre_px[0] += v % 2 ? moved_px : 0;
		assert_int_equal(observations_begin_view(seen, "board"), 0);
		for (int i = 0; i < 9 * 6; i++) {
			const double x = KNOWN_CAMERA_STEP * (i % 9 - 4);
			const double y = KNOWN_CAMERA_STEP * (i / 9 - 2.5);
			const double world[3] = {x, y,
						 by[0] * x * x + by[1] * x * y + by[2] * y * y};

			known_camera_see(seen, truth, world, noise, chance);
		}
		for (int i = first; i < seen->count; i++)
			seen->point[i].world[2] = 0;
		truth->centre_px[0] -= v % 2 ? moved_px : 0;
	}
}

/* Sums over sets of the squared error less the declared variance. */
struct excess {
	int sets;
	double sum, squares, variance;
};

static void excess_add(struct excess *excess, const struct estimate *estimate, int k, double truth)
{
	const double off = estimate->parameter[k].value - truth;
	const double variance = estimate->covariance[k * (estimate->count + 1)];
	const double by = off * off - variance;

	excess->sets++;
	excess->sum += by;
	excess->squares += by * by;
	excess->variance += variance;
}

/*
 * The declared variances are the mean squared errors, to four deviations of that mean, whether
 * points are independent or boards are bent.
 */
TEST("declared is the spread")
{
	const int sets = thorough() ? 200 : 8;
	struct chance chance = chance_begin("camera views");

	for (int bent = 0; bent < 2; bent++) {
		struct excess excess[MODEL_SHARED] = {{0}};

		for (int set = 0; set < sets; set++) {
			struct tsai_camera truth;
			struct observations seen;
			struct camera_task task;
			struct camera_solution solution;

			see_boards(&seen, &truth, 0.2, bent ? BEND : 0, 0, &chance);
			task = known_camera_task(&truth);
			task.radial = 1;
			assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
			for (int k = 0; k < MODEL_SHARED; k++) {
				const double is[MODEL_SHARED] = {truth.focal,
								 truth.kappa1,
								 0,
								 0,
								 truth.centre_px[0],
								 truth.height - truth.centre_px[1],
								 truth.aspect};

				if (!solution.finding.estimate.parameter[k].fixed)
					excess_add(&excess[k], &solution.finding.estimate, k,
						   is[k]);
			}
			camera_solution_free(&solution);
			observations_free(&seen);
		}
		for (int k = 0; k < MODEL_SHARED; k++) {
			const struct excess *e = &excess[k];

			if (e->sets < sets / 2)
				continue;
			print_message(
				"# bent %d, unknown %d: %d sets, errors are %.3f of what is declared\n",
				bent, k, e->sets, sqrt(1 + e->sum / e->variance));
			expect_below(fabs(e->sum), 4 * sqrt(e->squares), "bent=%d, unknown=%d",
				     bent, k);
		}
	}
}

/* A stabiliser: half of the pictures have another axis, and deviations by view show it. */
TEST("moved axis widens deviations")
{
	const int sets = thorough() ? 40 : 4;
	struct chance chance = chance_begin("camera moved axis");

	for (int set = 0; set < sets; set++) {
		struct tsai_camera truth;
		struct observations seen;
		struct camera_task task;
		struct camera_solution solution;

		see_boards(&seen, &truth, 0.05, 0, set % 2 ? 4 : -8, &chance);
		task = known_camera_task(&truth);
		assert_int_equal(camera_calibrate(&seen, &task, &solution, NULL), 0);
		expect_that(solution.own->fit.dispersion > 1.5, "set=%d: %g", set,
			    solution.own->fit.dispersion);
		camera_solution_free(&solution);
		observations_free(&seen);
	}
}
