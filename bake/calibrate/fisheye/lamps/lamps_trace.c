/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/lamps/lamps_trace.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/fisheye/fisheye_models.h"

#define ROUNDS 8
#define FIRST_SHARE 0.16  /* of the focal length: error of a guess */
#define FAR 6.0		  /* largest distance of a spot, in deviations */
#define FINEST_PX 1.0	  /* least deviation of spots */
#define LAMPS_FOR_MODEL 9 /* with fewer lamps the guess's model stays */
#define FEWEST 4

void lamps_trace_free(struct lamp_trace *trace)
{
	free(trace->spot);
	*trace = (struct lamp_trace){.spot = NULL};
}

/* ---- which spot is near ---- */

struct lamp_expected {
	bool seen;
	double px[2];
};

static double px_away(const struct lamp_scene *scene, const struct lamp_trace *trace,
		      const struct lamp_expected *lamp, int spot)
{
	double px[2];

	lamp_spot_px(scene, trace->lens.mirrored, spot, px);
	return hypot(px[0] - lamp->px[0], px[1] - lamp->px[1]);
}

static int nearest_lamp(const struct lamp_scene *scene, const struct lamp_trace *trace,
			const struct lamp_expected *expected, int spot)
{
	int nearest = -1;
	double least = INFINITY;

	for (int n = 0; n < scene->lamps->count; n++)
		if (expected[n].seen && px_away(scene, trace, &expected[n], spot) < least) {
			least = px_away(scene, trace, &expected[n], spot);
			nearest = n;
		}
	return nearest;
}

static int nearest_spot(const struct lamp_scene *scene, const struct lamp_trace *trace,
			const struct lamp_expected *lamp, double reach_px)
{
	int nearest = SPOT_NONE;
	double least = reach_px;

	for (int k = 0; k < scene->spots->count; k++)
		if (px_away(scene, trace, lamp, k) < least) {
			least = px_away(scene, trace, lamp, k);
			nearest = k;
		}
	return nearest;
}

/* Marks lamps so near to each other that one spot holds several. */
static void part_merged(const struct lamp_scene *scene, struct lamp_trace *trace,
			const struct lamp_expected *expected)
{
	for (int k = 0; k < scene->spots->count; k++) {
		const double within = scene->spots->spot[k].radius_px + 2 * FINEST_PX;
		int inside = 0;

		for (int n = 0; n < scene->lamps->count; n++)
			inside += expected[n].seen && (trace->spot[n] == k || trace->spot[n] < 0) &&
				  px_away(scene, trace, &expected[n], k) < within;
		for (int n = 0; n < scene->lamps->count && inside > 1; n++)
			if (expected[n].seen && (trace->spot[n] == k || trace->spot[n] < 0) &&
			    px_away(scene, trace, &expected[n], k) < within)
				trace->spot[n] = SPOT_MERGED;
	}
}

/* Assigns each lamp the spot that is nearest to it, if the lamp is also nearest to that spot.
 * Returns 1 if nothing changed. */
static int assign_spots(const struct lamp_scene *scene, struct lamp_trace *trace)
{
	const int lamps = scene->lamps->count;
	struct lamp_expected *expected = calloc((size_t)lamps, sizeof(*expected));
	int changed = 0;

	if (!expected)
		return -ENOMEM;
	trace->found = 0;
	for (int n = 0; n < lamps; n++)
		expected[n].seen = lamp_expect(scene, &trace->lens, n, M_PI, expected[n].px);
	for (int n = 0; n < lamps; n++) {
		int spot = SPOT_NONE;

		if (expected[n].seen)
			spot = nearest_spot(scene, trace, &expected[n], trace->reach_px);
		if (spot >= 0 && nearest_lamp(scene, trace, expected, spot) != n)
			spot = SPOT_NONE;
		changed += trace->spot[n] != spot && trace->spot[n] != SPOT_MERGED;
		trace->spot[n] = spot;
	}
	part_merged(scene, trace, expected);
	for (int n = 0; n < lamps; n++)
		trace->found += trace->spot[n] >= 0;
	free(expected);
	return !changed;
}

/* ---- the lens ---- */

int lamps_observe(struct observations *seen, const struct lamp_scene *scene,
		  const struct lamp_trace *trace, bool mirrored, const char *lamps_name,
		  const char *picture_name)
{
	const char *slash = strrchr(lamps_name, '/');
	int err;

	*seen = (struct observations){.width = scene->width, .height = scene->height};
	err = observations_begin_view(seen, picture_name);
	for (int n = 0; n < scene->lamps->count && !err; n++) {
		double px[2];

		if (trace->spot[n] < 0)
			continue;
		lamp_spot_px(scene, mirrored, trace->spot[n], px);
		err = observations_add(seen, scene->lamps->lamp[n].dir, px, "%s:%d",
				       slash ? slash + 1 : lamps_name, scene->lamps->lamp[n].line);
	}
	return err;
}

static void take_solution(struct lamp_trace *trace, const struct lens_problem *problem,
			  const struct lens_solution *solution)
{
	trace->lens.optics = solution->optics;
	memcpy(trace->lens.rotation, solution->pose[0].rotation, sizeof(trace->lens.rotation));
	trace->deviation_px = lens_deviation(problem, solution);
}

/* Solves the lens; the points choose the model once there are enough of them and they are the right
 * ones. */
static int solve_lens(struct lamp_trace *trace, const struct lens_problem *problem,
		      struct lens_solution *start, int wanted, bool rough)
{
	struct model_trials trials;
	struct fault ignored;
	int err;

	if (rough || wanted < FISHEYE_MODEL_COUNT || problem->seen->count < LAMPS_FOR_MODEL) {
		if (!rough && wanted < FISHEYE_MODEL_COUNT)
			start->optics.model = (enum fisheye_model)wanted;
		err = lens_solve(problem, start, &ignored);
		if (!err)
			take_solution(trace, problem, start);
		return err;
	}
	err = models_try(&trials, problem, start, FISHEYE_MODEL_COUNT);
	if (err)
		return err;
	if (trials.solved[trials.best])
		take_solution(trace, problem, &trials.solution[trials.best]);
	else
		err = -ERANGE;
	models_free(&trials);
	return err;
}

static int fit_lens(struct lamp_trace *trace, const struct lamp_scene *scene, int wanted,
		    bool rough)
{
	struct observations seen;
	const struct lens_problem problem = {.seen = &seen, .directions = true, .step = 1};
	struct lens_solution start = {.poses = 0};
	int err = lamps_observe(&seen, scene, trace, trace->lens.mirrored, "", "");

	if (!err)
		err = lens_solution_create(&start, &problem);
	if (!err) {
		start.optics = trace->lens.optics;
		memcpy(start.pose[0].rotation, trace->lens.rotation, sizeof(trace->lens.rotation));
		err = solve_lens(trace, &problem, &start, wanted, rough);
	}
	lens_solution_free(&start);
	observations_free(&seen);
	return err;
}

int lamps_trace(struct lamp_trace *trace, const struct lamp_scene *scene,
		const struct lamp_guess *guess, int wanted)
{
	double reach_px = FIRST_SHARE * guess->optics.number[OPTICS_FOCAL];

	*trace = (struct lamp_trace){.lens = *guess};
	trace->spot = calloc((size_t)scene->lamps->count, sizeof(*trace->spot));
	if (!trace->spot)
		return -ENOMEM;
	for (int round = 0; round < ROUNDS; round++) {
		int same, err;

		trace->reach_px = reach_px;
		same = assign_spots(scene, trace);
		if (same < 0 || trace->found < FEWEST || (same && round > 3))
			return same < 0 ? same : 0;
		err = fit_lens(trace, scene, wanted, round < 2);
		if (err) {
			trace->found = 0;
			return err == -ENOMEM ? err : 0;
		}
		reach_px = fmin(reach_px, fmax(FAR * trace->deviation_px, 2 * FINEST_PX));
	}
	return 0;
}
