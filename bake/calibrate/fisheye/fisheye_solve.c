/* SPDX-License-Identifier: MIT */

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/order.h"
#include "bake/calibrate/fisheye/fisheye_parts.h"
#include "hal/optics/vec.h"

/* A point so many deviations off is an outlier (4 in a million points of a normal distribution
 * are), unless it is nearer than any camera resolves. */
#define FAR 5.0
#define FINEST_PX 1e-3
/* In deviations of a point: 95 % of the efficiency of plain squares. */
#define LOSS_SCALE 3.0

/* A pose for one parameter vector. */
struct turned {
	double rotation[9], jacobian[9], translation[3];
};

struct lens_search {
	const struct lens_problem *problem;
	const struct lens_solution *start;
	struct optics optics;
	struct turned *turned; /* [poses] */
	int parameters;
};

int lens_solution_create(struct lens_solution *solution, const struct lens_problem *problem)
{
	*solution = (struct lens_solution){.poses = problem->seen->views};
	solution->parameters = OPTICS_COUNT + solution->poses * LENS_POSE;
	solution->pose = calloc((size_t)solution->poses + 1, sizeof(*solution->pose));
	return solution->pose ? 0 : -ENOMEM;
}

void lens_solution_free(struct lens_solution *solution)
{
	free(solution->pose);
	least_squares_free(&solution->fit);
	*solution = (struct lens_solution){.poses = 0};
}

int lens_solution_copy(struct lens_solution *copy, const struct lens_solution *from)
{
	const size_t bytes = ((size_t)from->poses + 1) * sizeof(*from->pose);

	*copy = *from;
	copy->fit = (struct least_squares_fit){.covariance = NULL};
	copy->pose = malloc(bytes);
	if (!copy->pose) {
		*copy = (struct lens_solution){.poses = 0};
		return -ENOMEM;
	}
	memcpy(copy->pose, from->pose, bytes);
	return 0;
}

static void take_parameters(struct lens_search *search, const double *x)
{
	search->optics.model = search->start->optics.model;
	memcpy(search->optics.number, x, sizeof(search->optics.number));
	for (int k = 0; k < search->start->poses; k++) {
		const double *own = x + OPTICS_COUNT + k * LENS_POSE;
		struct turned *t = &search->turned[k];
		double turn[9];

		turn_matrix(own, turn);
		turn_multiply(turn, search->start->pose[k].rotation, t->rotation);
		turn_jacobian(own, t->jacobian);
		for (int i = 0; i < 3; i++)
			t->translation[i] = own[3 + i];
	}
}

static bool lens_evaluate(void *context, const double *x, double *residual)
{
	struct lens_search *search = context;

	take_parameters(search, x);
	for (int n = 0; n < search->problem->seen->count; n++) {
		const struct observation *point = &search->problem->seen->point[n];
		const struct turned *t = &search->turned[point->view];
		double c[3], px[2];

		mat_apply(t->rotation, point->world, c);
		for (int i = 0; i < 3; i++)
			c[i] += t->translation[i];
		if (!optics_project(&search->optics, c, px, NULL, NULL))
			return false;
		for (int i = 0; i < 2; i++)
			residual[2 * n + i] = px[i] - point->px[i];
	}
	return true;
}

/* Derivatives of one coordinate of a point by its pose's turns and translation. */
static void differentiate_pose(const struct turned *t, const double arm[3],
			       const double (*by_point)[2], int i, double *row)
{
	for (int k = 0; k < 3; k++) {
		const double axis[3] = {t->jacobian[k], t->jacobian[3 + k], t->jacobian[6 + k]};
		double moved[3];

		vec_cross(axis, arm, moved);
		for (int a = 0; a < 3; a++)
			row[k] += by_point[a][i] * moved[a];
	}
	for (int k = 3; k < LENS_POSE; k++)
		row[k] = by_point[k - 3][i];
}

static void lens_differentiate(void *context, const double *x, double *jacobian)
{
	struct lens_search *search = context;
	take_parameters(search, x);
	for (int n = 0; n < search->problem->seen->count; n++) {
		const struct observation *point = &search->problem->seen->point[n];
		const struct turned *t = &search->turned[point->view];
		double by_number[OPTICS_COUNT][2], by_point[3][2], arm[3], c[3], px[2];

		mat_apply(t->rotation, point->world, arm);
		for (int i = 0; i < 3; i++)
			c[i] = arm[i] + t->translation[i];
		if (!optics_project(&search->optics, c, px, by_number, by_point))
			continue;
		for (int i = 0; i < 2; i++) {
			double *row = jacobian + (size_t)(2 * n + i) * (size_t)search->parameters;

			for (int k = 0; k < OPTICS_COUNT; k++)
				row[k] = by_number[k][i];
			differentiate_pose(t, arm, by_point, i,
					   row + OPTICS_COUNT + point->view * LENS_POSE);
		}
	}
}

static int lens_first(const void *context, int view)
{
	const struct observations *seen = ((const struct lens_search *)context)->problem->seen;

	return view < seen->views ? seen->view[view].first : seen->count;
}

/* Buffers of a search. */
struct lens_scratch {
	double *x, *scale;
	bool *fixed;
};

/* Sets the first guess, a typical change of each parameter, and which are fixed. */
static void search_begin(const struct lens_solution *start, const struct lens_scratch *scratch)
{
	double *x = scratch->x, *scale = scratch->scale;
	bool *fixed = scratch->fixed;

	for (int k = 0; k < OPTICS_COUNT; k++) {
		x[k] = start->optics.number[k];
		scale[k] = k < OPTICS_CENTRE ? 0.01 * x[k] : k < OPTICS_TERMS ? 1 : 0.01;
		fixed[k] = k >= OPTICS_TERMS && start->optics.model != FISHEYE_POLYNOMIAL;
	}
	for (int p = 0; p < start->poses; p++) {
		const double *away = start->pose[p].translation;

		for (int k = 0; k < LENS_POSE; k++) {
			const int at = OPTICS_COUNT + p * LENS_POSE + k;

			x[at] = k < 3 ? 0 : away[k - 3];
			scale[at] = k < 3 ? 0.01 : 0.01 * vec_length(away) + 1e-12;
			fixed[at] = false;
		}
	}
}

/* Stores the solution's optics and poses, and turns the covariance into that of turns about the
 * camera's own axes. */
static void search_end(const struct lens_search *search, struct lens_solution *solution)
{
	const int n = solution->parameters;
	double *c = solution->fit.covariance;

	solution->optics = search->optics;
	for (int p = 0; p < solution->poses; p++) {
		const struct turned *t = &search->turned[p];
		const int at = OPTICS_COUNT + p * LENS_POSE;

		memcpy(solution->pose[p].rotation, t->rotation, sizeof(t->rotation));
		memcpy(solution->pose[p].translation, t->translation, sizeof(t->translation));
		for (int k = 0; c && k < n; k++) {
			const double across[3] = {c[at * n + k], c[(at + 1) * n + k],
						  c[(at + 2) * n + k]};
			double turned[3];

			mat_apply(t->jacobian, across, turned);
			for (int i = 0; i < 3; i++)
				c[(at + i) * n + k] = turned[i];
		}
		for (int k = 0; c && k < n; k++)
			mat_apply(t->jacobian, c + k * n + at, c + k * n + at);
	}
}

static int search_once(const struct lens_problem *problem, struct lens_solution *solution,
		       const struct lens_scratch *scratch, double loss_scale, struct fault *fault)
{
	struct lens_search search = {
		.problem = problem, .start = solution, .parameters = solution->parameters};
	const struct by_view_layout layout = {.views = solution->poses,
					      .shared = OPTICS_COUNT,
					      .of_view = LENS_POSE,
					      .first = lens_first};
	const struct least_squares least = {
		.parameters = solution->parameters,
		.residuals = 2 * problem->seen->count,
		.evaluate = lens_evaluate,
		.differentiate = lens_differentiate,
		.context = &search,
		.scale = scratch->scale,
		.fixed = scratch->fixed,
		.loss_scale = loss_scale,
		.group = 2,
		.layout = &layout,
	};
	int err;

	search.turned = calloc((size_t)solution->poses + 1, sizeof(*search.turned));
	if (!search.turned)
		return fault_say(fault, -ENOMEM, "fisheye: out of memory");
	search_begin(solution, scratch);
	least_squares_free(&solution->fit);
	err = least_squares_solve(&least, scratch->x, &solution->fit, fault);
	if (!err || err == -ERANGE || err == -ETIMEDOUT) {
		take_parameters(&search, scratch->x);
		search_end(&search, solution);
	}
	free(search.turned);
	return err;
}

/* Returns the deviation of a point, and the largest residual. */
static double measure_errors(const struct lens_problem *problem,
			     const struct lens_solution *solution, double *largest)
{
	const int count = problem->seen->count;
	double *length = calloc((size_t)count + 1, sizeof(*length)), middle;

	*largest = 0;
	if (!length)
		return INFINITY;
	for (int n = 0; n < count; n++)
		length[n] = hypot(solution->fit.residual[2 * n], solution->fit.residual[2 * n + 1]);
	qsort(length, (size_t)count, sizeof(*length), order_doubles);
	*largest = count ? length[count - 1] : 0;
	middle = length[count / 2];
	free(length);
	return middle / 1.17741; /* half of a circular normal distribution is within 1.177 sigma */
}

double lens_deviation(const struct lens_problem *problem, const struct lens_solution *solution)
{
	double largest;

	return measure_errors(problem, solution, &largest);
}

static bool has_outliers(const struct lens_problem *problem, const struct lens_solution *solution)
{
	double largest;
	const double deviation = measure_errors(problem, solution, &largest);

	return largest > fmax(FAR * deviation, FINEST_PX);
}

static int search_twice(const struct lens_problem *problem, struct lens_solution *solution,
			const struct lens_scratch *scratch, struct fault *fault)
{
	struct fault first = {.text = ""};
	const int err = search_once(problem, solution, scratch, 0, &first);

	if (!err && !problem->plain && has_outliers(problem, solution))
		return search_once(problem, solution, scratch, LOSS_SCALE, fault);
	if (err && fault)
		*fault = first;
	return err;
}

int lens_solve(const struct lens_problem *problem, struct lens_solution *solution,
	       struct fault *fault)
{
	const size_t count = (size_t)solution->parameters;
	const struct lens_scratch scratch = {
		.x = calloc(count, sizeof(*scratch.x)),
		.scale = calloc(count, sizeof(*scratch.scale)),
		.fixed = calloc(count, sizeof(*scratch.fixed)),
	};
	int err = -ENOMEM;

	if (scratch.x && scratch.scale && scratch.fixed)
		err = search_twice(problem, solution, &scratch, fault);
	else
		fault_say(fault, err, "fisheye: out of memory");
	free(scratch.x);
	free(scratch.scale);
	free(scratch.fixed);
	return err;
}

bool lens_expect(const struct lens_solution *solution, const struct observation *point,
		 double px[2])
{
	const struct lens_pose *pose = &solution->pose[point->view];
	double c[3];

	mat_apply(pose->rotation, point->world, c);
	for (int i = 0; i < 3; i++)
		c[i] += pose->translation[i];
	return optics_project(&solution->optics, c, px, NULL, NULL);
}
