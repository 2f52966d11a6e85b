/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/camera/camera_parts.h"
#include "bake/calibrate/estimate/rotation.h"
#include "hal/optics/vec.h"

struct camera_task camera_task_default(void)
{
	return (struct camera_task){.centre_deviation_px = -1,
				    .aspect = 1,
				    .aspect_deviation = -1,
				    .distortion = TSAI_DISTORTS,
				    .tolerance_px = 1,
				    .unit_mm = 1000};
}

/* ---- before solving ---- */

/* Returns half the longest side of a box, and computes its middle. */
static double half_of(const double *low, const double *high, int sides, double *middle)
{
	double longest = 0;

	for (int k = 0; k < sides; k++) {
		middle[k] = (low[k] + high[k]) / 2;
		longest = fmax(longest, (high[k] - low[k]) / 2);
	}
	return longest;
}

static void box_widen(const double *point, int sides, double *low, double *high)
{
	for (int k = 0; k < sides; k++) {
		low[k] = fmin(low[k], point[k]);
		high[k] = fmax(high[k], point[k]);
	}
}

static void place_task_object(struct camera_private *own)
{
	const struct observed_view *view = &own->seen->view[own->task.reference];
	double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};

	if (own->task.object_given) {
		memcpy(own->object, own->task.object, sizeof(own->object));
		own->radius = own->task.object_radius;
		return;
	}
	for (int i = view->first; i < view->first + view->count; i++)
		box_widen(own->seen->point[i].world, 3, low, high);
	if (view->count)
		own->radius = half_of(low, high, 3, own->object);
}

static void place_centre(struct camera_private *own)
{
	const struct camera_task *task = &own->task;
	double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};

	for (int i = 0; i < own->seen->count; i++)
		box_widen(own->seen->point[i].px, 2, low, high);
	own->diagonal = 2 * M_SQRT2 * half_of(low, high, 2, own->guess.centre);
	if (task->width && task->height) {
		own->diagonal = hypot(task->width, task->height);
		own->guess.centre[0] = task->width / 2.0;
		own->guess.centre[1] = task->height / 2.0;
	}
	if (task->centre_given)
		memcpy(own->guess.centre, task->centre_px, sizeof(own->guess.centre));
	if (task->intrinsics) {
		own->guess.centre[0] = task->intrinsics->centre_px[0];
		own->guess.centre[1] = task->intrinsics->height - task->intrinsics->centre_px[1];
	}
}

/* A known lens counts as exact. */
static void place_deviation(struct camera_private *own)
{
	const double given = own->task.centre_deviation_px;

	for (int k = 0; k < 2; k++)
		own->guess.centre_deviation[k] = own->task.intrinsics ? 0
						 : given < 0
							 ? CAMERA_CENTRE_DEVIATION * own->diagonal
							 : given;
}

static void place_aspect(struct camera_private *own)
{
	const struct camera_task *task = &own->task;
	const bool known = task->intrinsics || (task->aspect_given && task->aspect_deviation < 0);

	own->guess.aspect = task->intrinsics ? task->intrinsics->aspect : task->aspect;
	own->guess.aspect_deviation = known			   ? 0
				      : task->aspect_deviation < 0 ? CAMERA_ASPECT_DEVIATION
								   : task->aspect_deviation;
}

/* Known intrinsics determine picture size and direction of distortion. */
static void take_intrinsics(struct camera_task *task)
{
	if (!task->intrinsics)
		return;
	task->width = task->intrinsics->width;
	task->height = task->intrinsics->height;
	task->distortion = task->intrinsics->distortion;
}

static int calibration_prepare(struct camera_private *own, const struct observations *seen,
			       const struct camera_task *task)
{
	struct camera_model model = {.pixel = {1, 1}}; /* f is in pixels */
	size_t n;
	int err;

	own->seen = seen;
	own->task = *task;
	take_intrinsics(&own->task);
	place_centre(own);
	place_deviation(own);
	place_aspect(own);
	place_task_object(own);
	model.distortion = own->task.distortion;
	if (task->intrinsics) {
		memcpy(model.pixel, task->intrinsics->pixel, sizeof(model.pixel));
		memcpy(model.tangential, task->intrinsics->tangential, sizeof(model.tangential));
	}
	err = problem_create(&own->problem, seen, &model, own->guess.centre);
	if (err)
		return err;
	n = (size_t)problem_unknowns(&own->problem);
	own->x = calloc(n, sizeof(*own->x));
	own->fixed = calloc(n, sizeof(*own->fixed));
	own->uncertainty.held = calloc(n * n, sizeof(*own->uncertainty.held));
	own->uncertainty.held_aspect = calloc(n * n, sizeof(*own->uncertainty.held_aspect));
	own->uncertainty.covariance = calloc(n * n, sizeof(*own->uncertainty.covariance));
	own->uncertainty.cautious = calloc(n * n, sizeof(*own->uncertainty.cautious));
	if (!own->x || !own->fixed || !own->uncertainty.held || !own->uncertainty.held_aspect ||
	    !own->uncertainty.covariance || !own->uncertainty.cautious)
		return -ENOMEM;
	return 0;
}

/* ---- after solving ---- */

static void make_camera(const struct camera_private *own, int view, struct tsai_camera *camera)
{
	const double *x = own->x, *pose = x + model_of_view(view);
	double slope[3][9], moved[3];

	*camera = (struct tsai_camera){
		.width = own->task.width,
		.height = own->task.height,
		.focal = x[MODEL_FOCAL],
		.kappa1 = x[MODEL_KAPPA1],
		.kappa2 = x[MODEL_KAPPA1 + 1],
		.kappa3 = x[MODEL_KAPPA1 + 2],
		.tangential = {own->problem.model.tangential[0], own->problem.model.tangential[1]},
		.distortion = own->task.distortion,
		.centre_px = {x[MODEL_CENTRE_X], own->task.height - x[MODEL_CENTRE_Y]},
		.pixel = {own->problem.model.pixel[0], own->problem.model.pixel[1]},
		.aspect = x[MODEL_ASPECT],
	};
	rotation_from_vector(pose + MODEL_ROTATION, camera->rotation, slope);
	mat_apply(camera->rotation, own->problem.shape[view].middle, moved);
	for (int k = 0; k < 3; k++)
		camera->translation[k] = pose[MODEL_TRANSLATION + k] - moved[k];
}

/*
 * Derivative of T by the rotation vector of a view:
 *     T = T' - R middle
 */
static void translation_by_rotation(const struct camera_private *own, int view, double by[3][3])
{
	double rotation[9], slope[3][9];

	rotation_from_vector(own->x + model_of_view(view) + MODEL_ROTATION, rotation, slope);
	for (int d = 0; d < 3; d++) {
		double moved[3];

		mat_apply(slope[d], own->problem.shape[view].middle, moved);
		for (int k = 0; k < 3; k++)
			by[k][d] = -moved[k];
	}
}

/* Adds the influence of the rotation to the rows of one view's T, in a matrix of n columns; the
 * strides row and column also allow its transpose. */
static void carry_over_translation(double *matrix, int n, size_t row, size_t column, int at,
				   double by[3][3])
{
	for (int j = 0; j < n; j++)
		for (int k = 0; k < 3; k++)
			for (int d = 0; d < 3; d++) {
				const double c = matrix[(size_t)(at + MODEL_ROTATION + d) * row +
							(size_t)j * column];

				if (by[k][d] != 0)
					matrix[(size_t)(at + MODEL_TRANSLATION + k) * row +
					       (size_t)j * column] += by[k][d] * c;
			}
}

/* Fills the estimate with the unknowns as parameters of the world: T instead of T'. */
static int report_estimate(const struct camera_private *own, struct camera_solution *solution)
{
	static const char *const unit[] = {"", "", "", "", "px", "px", ""};
	struct estimate *estimate = &solution->finding.estimate;
	const int n = problem_unknowns(&own->problem);
	const int err = estimate_create(estimate, n);

	if (err)
		return err;
	memcpy(estimate->covariance, own->uncertainty.covariance,
	       (size_t)n * (size_t)n * sizeof(*estimate->covariance));
	for (int v = 0; v < own->problem.views; v++) {
		double by[3][3];

		translation_by_rotation(own, v, by);
		carry_over_translation(estimate->covariance, n, (size_t)n, 1, model_of_view(v), by);
		carry_over_translation(estimate->covariance, n, 1, (size_t)n, model_of_view(v), by);
	}
	/* parameters that are not known at all have no correlations */
	for (int k = 0; k < n * n; k++)
		if (!isfinite(estimate->covariance[k]))
			estimate->covariance[k] = k % (n + 1) ? 0 : INFINITY;
	for (int k = 0; k < n; k++) {
		struct parameter *p = &estimate->parameter[k];
		const int part = (k - MODEL_SHARED) % MODEL_OF_VIEW;
		const int view = (k - MODEL_SHARED) / MODEL_OF_VIEW;

		problem_name(&own->problem, k, p->name, sizeof(p->name));
		snprintf(p->unit, sizeof(p->unit), "%s",
			 k < MODEL_SHARED	    ? unit[k]
			 : part < MODEL_TRANSLATION ? "rad"
						    : "");
		p->value = own->x[k];
		p->fixed = own->fixed[k];
		if (k >= MODEL_SHARED && part >= MODEL_TRANSLATION)
			p->value = solution->view[view].translation[part - MODEL_TRANSLATION];
	}
	estimate->residuals = 2 * own->problem.count;
	estimate->freedom = own->fit.freedom;
	estimate->sigma = own->fit.sigma;
	return 0;
}

/* Computes the covariances. own->uncertainty.covariance: noise of the points, held centre and held
 * s. own->uncertainty.cautious, for verdicts: noise at least that of the best corners, and widened
 * where few residuals, or few views, determine it (Student's t for one deviation, to 2 %). */
static void spread_errors(struct camera_private *own)
{
	const struct by_view *by_view = &own->fit.by_view;
	const int n = problem_unknowns(&own->problem);
	const int freedom = by_view->views > 1 ? by_view->shared * (by_view->views - 1)
					       : own->fit.freedom;
	const double few = freedom > 0 ? 1 + 0.55 / freedom + 0.28 / (freedom * (double)freedom)
				       : 10;
	/* what noise lacks of that of the best corners */
	const double lacking =
		fmax(0, CAMERA_NOISE_LEAST * CAMERA_NOISE_LEAST - own->fit.sigma * own->fit.sigma);

	for (int k = 0; k < n * n; k++) {
		own->uncertainty.covariance[k] = own->fit.covariance[k] + own->uncertainty.held[k] +
						 own->uncertainty.held_aspect[k];
		own->uncertainty.cautious[k] = few * few *
					       (own->fit.covariance[k] +
						(lacking > 0 ? lacking * own->fit.inverse[k] : 0));
	}
	own->uncertainty.noise_error = camera_object_error(own, own->uncertainty.cautious);
	for (int k = 0; k < n * n; k++)
		own->uncertainty.cautious[k] += own->uncertainty.held[k] +
						own->uncertainty.held_aspect[k];
	own->uncertainty.object_error = camera_object_error(own, own->uncertainty.cautious);
}

static void mean_depth(struct camera_private *own)
{
	const int v = own->task.reference;
	struct model_view turned;

	model_turn(&turned, own->x + model_of_view(v));
	own->depth = turned.translation[2]; /* places are relative to their middle */
}

static int solution_finish(struct camera_solution *solution)
{
	struct camera_private *own = solution->own;
	struct finding *finding = &solution->finding;
	int err;

	for (int v = 0; v < own->problem.views; v++)
		make_camera(own, v, &solution->view[v]);
	solution->camera = solution->view[own->task.reference];
	problem_expect(&own->problem, own->x, finding->expected);
	memcpy(finding->weight, own->fit.weight,
	       (size_t)own->problem.count * sizeof(*finding->weight));
	err = camera_hold(own);
	if (err)
		return err;
	spread_errors(own);
	err = report_estimate(own, solution);
	if (err)
		return err;
	mean_depth(own);
	camera_figures(solution);
	finding->uncertainty = camera_uncertainty;
	finding->project = camera_project_view;
	finding->context = own;
	return 0;
}

static int calibration_run(struct camera_solution *solution)
{
	struct camera_private *own = solution->own;
	int err;

	err = camera_solve(own);
	if (err)
		return err;
	solution->solved = !own->guess_error && own->fit_error != -EDOM &&
			   own->fit_error != -EINVAL &&
			   isfinite(problem_rms(&own->problem, own->x));
	if (solution->solved)
		err = solution_finish(solution);
	if (!err)
		camera_judge(solution);
	return err;
}

static void name_model(const struct camera_private *own, struct finding *finding)
{
	static const char *const terms[] = {"", "", ", 2 radial terms", ", 3 radial terms"};

	snprintf(finding->model, sizeof(finding->model), "Tsai, %s%s",
		 own->task.distortion == TSAI_DISTORTS ? "distorted from undistorted"
						       : "undistorted from distorted",
		 own->task.intrinsics ? ", pose alone" : terms[own->radial]);
}

int camera_calibrate(const struct observations *seen, const struct camera_task *task,
		     struct camera_solution *solution, struct fault *fault)
{
	struct finding *finding = &solution->finding;
	int err;

	*solution = (struct camera_solution){0};
	if (seen->views < 1 || task->reference < 0 || task->reference >= seen->views)
		return fault_say(fault, -EINVAL, "view %d is the reference, but there are %d",
				 task->reference + 1, seen->views);
	err = finding_create(finding, "camera", seen);
	solution->own = calloc(1, sizeof(*solution->own));
	solution->view = calloc((size_t)seen->views, sizeof(*solution->view));
	if (!err && (!solution->own || !solution->view))
		err = -ENOMEM;
	if (!err && !seen->count) {
		verdict_doubt(&finding->verdict, "give points, or photographs of a board",
			      "there are no points");
		return 0;
	}
	if (!err)
		err = calibration_prepare(solution->own, seen, task);
	if (!err) {
		finding->width = solution->own->task.width;
		finding->height = solution->own->task.height;
		for (int i = 0; i < seen->count; i++)
			finding->expected[i][0] = finding->expected[i][1] = NAN;
		err = calibration_run(solution);
		name_model(solution->own, finding);
	}
	if (err) {
		camera_solution_free(solution);
		return fault_say(fault, err, "out of memory");
	}
	return 0;
}

void camera_solution_free(struct camera_solution *solution)
{
	struct camera_private *own = solution->own;

	if (own) {
		problem_free(&own->problem);
		least_squares_free(&own->fit);
		free(own->x);
		free(own->fixed);
		free(own->uncertainty.held);
		free(own->uncertainty.held_aspect);
		free(own->uncertainty.covariance);
		free(own->uncertainty.cautious);
		free(own);
	}
	free(solution->view);
	finding_free(&solution->finding);
	*solution = (struct camera_solution){0};
}
