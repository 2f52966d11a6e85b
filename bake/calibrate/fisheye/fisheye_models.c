/* SPDX-License-Identifier: MIT */

#include <errno.h>
#include <math.h>
#include <string.h>

#include "bake/calibrate/fisheye/fisheye_parts.h"

/* Finest residual that a camera resolves, px. */
#define FINEST_PX 1e-5

/* Residuals are capped at so many deviations of the best model, for every model alike. */
#define FAR 4

/* Outliers are searched only in models whose deviation is at most so many times the best one's: in
 * others most points would be outliers. */
#define NEAR 2.0

static int count_free(const struct lens_solution *solution)
{
	const int fixed = solution->optics.model == FISHEYE_POLYNOMIAL ? 0 : FISHEYE_TERMS;

	return solution->parameters - fixed;
}

/* Akaike's criterion, corrected for few points (Hurvich and Tsai 1989): without the correction as
 * many terms as residuals would be best. */
static double akaike(double mean, int residuals, int free)
{
	const double spare = fmax(residuals - free - 1, 0.5);

	return residuals * log(mean + FINEST_PX * FINEST_PX) + 2 * free +
	       2.0 * free * (free + 1) / spare;
}

static double capped_squares(const struct lens_solution *solution, int residuals, double most)
{
	double squares = 0;

	for (int n = 0; n < residuals; n++) {
		const double r = solution->fit.residual[n];

		squares += fmin(r * r, most * most);
	}
	return squares;
}

static void compare_squares(struct model_trials *trials, const struct lens_problem *problem)
{
	const int residuals = 2 * problem->seen->count;
	double least = INFINITY;

	for (int m = 0; m < FISHEYE_MODEL_COUNT; m++)
		if (trials->solved[m])
			least = fmin(least, lens_deviation(problem, &trials->solution[m]));
	for (int m = 0; m < FISHEYE_MODEL_COUNT; m++) {
		double mean;

		trials->aic[m] = INFINITY;
		if (!trials->solved[m])
			continue;
		mean = capped_squares(&trials->solution[m], residuals,
				      fmax(FAR * least, FINEST_PX)) /
		       residuals;
		trials->rms_px[m] = sqrt(2 * mean);
		trials->aic[m] = akaike(mean, residuals, count_free(&trials->solution[m]));
		/* The polynomial comes last and contains the equidistant model: it must gain more
		 * than its terms cost. */
		if (trials->aic[m] < trials->aic[trials->best] || !trials->solved[trials->best])
			trials->best = (enum fisheye_model)m;
	}
}

static double squares_of(const struct lens_solution *solution, int err)
{
	return err ? INFINITY : solution->fit.squares;
}

/* Solves once more from a first guess by this model itself, because no single start avoids every
 * wrong minimum; above all with an orthographic lens, where points get stuck at the rim. Keeps the
 * better solution. */
static int try_afresh(struct lens_solution *solution, const struct lens_problem *problem, int *err)
{
	struct lens_solution own;
	struct fault ignored;
	bool mirrored;
	int own_err = lens_solution_copy(&own, solution);

	if (own_err)
		return own_err;
	own_err = lens_start(problem, &own, &mirrored, &ignored);
	if (!own_err)
		own_err = lens_solve(problem, &own, &ignored);
	if (squares_of(&own, own_err) < squares_of(solution, *err)) {
		const struct lens_solution worse = *solution;

		*solution = own;
		own = worse;
		*err = 0;
	}
	lens_solution_free(&own);
	return own_err == -ENOMEM ? own_err : 0;
}

/* Fits one model, from another model's solution and afresh. */
static int try_model(struct model_trials *trials, const struct lens_problem *problem,
		     const struct lens_solution *start, enum fisheye_model model)
{
	struct lens_solution *solution = &trials->solution[model];
	struct fault *fault = &trials->fault[model];
	int err = lens_solution_copy(solution, start);
	int again = 0;

	if (err)
		return err;
	solution->optics.model = model;
	if (model != FISHEYE_POLYNOMIAL)
		memset(solution->optics.number + OPTICS_TERMS, 0, FISHEYE_TERMS * sizeof(double));
	err = lens_solve(problem, solution, fault);
	if (err != -ENOMEM && model != FISHEYE_EQUIDISTANT && model != FISHEYE_POLYNOMIAL)
		again = try_afresh(solution, problem, &err);
	trials->err[model] = err;
	trials->solved[model] = !err;
	return err == -ENOMEM ? err : again;
}

static int leave_out_outliers(struct model_trials *trials, const struct lens_problem *problem)
{
	double deviation[FISHEYE_MODEL_COUNT], least = INFINITY;

	for (int m = 0; m < FISHEYE_MODEL_COUNT; m++) {
		deviation[m] = trials->solved[m] ? lens_deviation(problem, &trials->solution[m])
						 : INFINITY;
		least = fmin(least, deviation[m]);
	}
	for (int m = 0; m < FISHEYE_MODEL_COUNT; m++) {
		int err;

		if (!trials->solved[m] || deviation[m] > NEAR * least)
			continue;
		err = lens_solve(problem, &trials->solution[m], &trials->fault[m]);
		trials->err[m] = err;
		trials->solved[m] = !err;
		if (err == -ENOMEM)
			return err;
	}
	return 0;
}

int models_try(struct model_trials *trials, const struct lens_problem *problem,
	       const struct lens_solution *start, int wanted)
{
	/* The polynomial starts from the equidistant solution, which is a special case of it; it is
	 * then near every other model, and its slope on the axis is their focal length. */
	static const enum fisheye_model order[FISHEYE_MODEL_COUNT] = {
		FISHEYE_EQUIDISTANT, FISHEYE_POLYNOMIAL, FISHEYE_EQUISOLID, FISHEYE_STEREOGRAPHIC,
		FISHEYE_ORTHOGRAPHIC};
	const struct lens_solution *from = start;
	struct lens_problem plain = *problem;
	int err = 0;

	*trials = (struct model_trials){.best = FISHEYE_EQUIDISTANT};
	plain.plain = true;
	for (int k = 0; !err && k < FISHEYE_MODEL_COUNT; k++) {
		const int m = order[k];

		if (wanted != FISHEYE_MODEL_COUNT && m != wanted && m != FISHEYE_EQUIDISTANT &&
		    m != FISHEYE_POLYNOMIAL)
			continue;
		err = try_model(trials, &plain, from, (enum fisheye_model)m);
		if (k < 2 && trials->solved[m])
			from = &trials->solution[m];
	}
	if (!err)
		err = leave_out_outliers(trials, problem);
	if (err)
		models_free(trials);
	else
		compare_squares(trials, problem);
	return err;
}

void models_free(struct model_trials *trials)
{
	for (int m = 0; m < FISHEYE_MODEL_COUNT; m++)
		lens_solution_free(&trials->solution[m]);
	memset(trials, 0, sizeof(*trials));
}
