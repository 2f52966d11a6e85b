/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera_problem.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/estimate.h"
#include "bake/calibrate/estimate/linear.h"
#include "hal/optics/vec.h"

/* Least f, as a share of the reach: no perspective lens sees 84 degrees from its axis. A descent
 * that gets there is lost. */
#define FOCAL_LEAST 0.1

/* ---- how points lie ---- */

static void find_middle(const struct observation *point, int count, struct view_shape *shape)
{
	for (int k = 0; k < 3; k++)
		shape->middle[k] = point[0].world[k];
	/* relative to the first point: far from 0, sums lose digits */
	for (int k = 0; k < 3; k++) {
		double sum = 0;

		for (int i = 0; i < count; i++)
			sum += point[i].world[k] - point[0].world[k];
		shape->middle[k] += sum / count;
	}
}

static int find_axes(const double (*place)[3], int count, struct view_shape *shape)
{
	const int rows = count > 3 ? count : 3;
	double *a = calloc(3 * (size_t)rows, sizeof(*a));
	double r[9], v[9], spread[3], squares = 0;
	int order[3] = {0, 1, 2};

	if (!a)
		return -ENOMEM;
	for (int i = 0; i < count; i++)
		for (int k = 0; k < 3; k++)
			a[k * rows + i] = place[i][k];
	linear_triangulate(a, rows, 3, 3, r);
	free(a);
	linear_diagonalize(r, v, 3);
	for (int k = 0; k < 3; k++) {
		spread[k] = vec_length(r + 3 * k);
		squares += spread[k] * spread[k];
	}
	for (int i = 0; i < 2; i++)
		for (int j = i + 1; j < 3; j++)
			if (spread[order[j]] > spread[order[i]]) {
				const int swap = order[i];

				order[i] = order[j];
				order[j] = swap;
			}
	for (int i = 0; i < 2; i++)
		memcpy(shape->axes + 3 * i, v + 3 * order[i], 3 * sizeof(*v));
	vec_cross(shape->axes, shape->axes + 3, shape->axes + 6);
	shape->size = squares > 0 ? sqrt(squares / count) : 1;
	if (spread[order[0]] > 0) {
		shape->across = spread[order[1]] / spread[order[0]];
		shape->out = spread[order[2]] / spread[order[0]];
	}
	return 0;
}

static int describe_view(struct camera_problem *problem, int view)
{
	struct view_shape *shape = &problem->shape[view];
	const int first = problem->first[view], count = problem->first[view + 1] - first;

	*shape = (struct view_shape){.axes = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .size = 1};
	if (!count)
		return 0;
	find_middle(problem->point + first, count, shape);
	for (int i = first; i < first + count; i++)
		for (int k = 0; k < 3; k++)
			problem->place[i][k] = problem->point[i].world[k] - shape->middle[k];
	return find_axes(problem->place + first, count, shape);
}

int problem_create(struct camera_problem *problem, const struct observations *seen,
		   const struct camera_model *model, const double centre[2])
{
	const size_t n = (size_t)seen->count, views = (size_t)seen->views;
	int err = 0;

	*problem = (struct camera_problem){.model = *model,
					   .view = seen->view,
					   .point = seen->point,
					   .count = seen->count,
					   .views = seen->views};
	problem->place = calloc(n ? n : 1, sizeof(*problem->place));
	problem->shape = calloc(views ? views : 1, sizeof(*problem->shape));
	problem->first = calloc(views + 1, sizeof(*problem->first));
	if (!problem->place || !problem->shape || !problem->first) {
		problem_free(problem);
		return -ENOMEM;
	}
	for (int v = 0; v < seen->views; v++)
		problem->first[v] = seen->view[v].first;
	problem->first[seen->views] = seen->count;
	for (int v = 0; v < seen->views && !err; v++)
		err = describe_view(problem, v);
	for (int i = 0; i < seen->count; i++)
		problem->reach = fmax(problem->reach,
				      hypot((seen->point[i].px[0] - centre[0]) * model->pixel[0],
					    (seen->point[i].px[1] - centre[1]) * model->pixel[1]));
	if (!(problem->reach > 0))
		problem->reach = 1;
	problem->model.reach = problem->reach;
	if (err)
		problem_free(problem);
	return err;
}

void problem_free(struct camera_problem *problem)
{
	free(problem->place);
	free(problem->shape);
	free(problem->first);
	*problem = (struct camera_problem){0};
}

struct camera_problem problem_of_view(const struct camera_problem *problem, int view)
{
	const int first = problem->first[view];
	struct camera_problem one = *problem;

	one.view += view;
	one.point += first;
	one.place += first;
	one.unused = problem->unused ? problem->unused + first : NULL;
	one.count = problem->first[view + 1] - first;
	one.shape += view;
	one.first = NULL;
	one.views = 1;
	one.first_view += view;
	return one;
}

void problem_name(const struct camera_problem *problem, int unknown, char *name, int room)
{
	static const char *const shared[] = {"focal",	 "kappa1",   "kappa2", "kappa3",
					     "centre x", "centre y", "aspect"};
	static const char *const of_view[] = {"rotation x",    "rotation y",	"rotation z",
					      "translation x", "translation y", "translation z"};
	const int part = (unknown - MODEL_SHARED) % MODEL_OF_VIEW;
	const int view = (unknown - MODEL_SHARED) / MODEL_OF_VIEW;

	if (unknown < MODEL_SHARED)
		snprintf(name, (size_t)room, "%s", shared[unknown]);
	else if (problem->views == 1)
		snprintf(name, (size_t)room, "%s", of_view[part]);
	else
		snprintf(name, (size_t)room, "view %d %s", problem->view[view].number,
			 of_view[part]);
}

/* ---- what the model expects ---- */

static bool is_view_used(const struct camera_problem *problem, int i)
{
	return !problem->unused || !problem->unused[i];
}

static int view_of(const struct camera_problem *problem, int i)
{
	return problem->point[i].view - problem->first_view;
}

/* Cached rotation of the last point's view: neighbouring points mostly share a view. */
struct turned_view {
	int view; /* -1: none yet */
	struct model_view as;
};

/* model_see() of a point. */
static bool see_point(const struct camera_problem *problem, const double *x, int i,
		      struct turned_view *at, double px[2], double (*gradient)[MODEL_GRADIENT])
{
	if (view_of(problem, i) != at->view) {
		at->view = view_of(problem, i);
		model_turn(&at->as, x + model_of_view(at->view));
	}
	return model_see(&problem->model, x, &at->as, problem->place[i], px, gradient);
}

int problem_expect(const struct camera_problem *problem, const double *x, double (*px)[2])
{
	struct turned_view at = {.view = -1};
	int missing = 0;

	for (int i = 0; i < problem->count; i++) {
		if (!see_point(problem, x, i, &at, px[i], NULL)) {
			px[i][0] = px[i][1] = NAN;
			missing++;
		}
	}
	return missing;
}

static bool problem_residuals(void *context, const double *x, double *residual)
{
	const struct camera_problem *problem = context;
	struct turned_view at = {.view = -1};

	if (!(x[MODEL_FOCAL] > FOCAL_LEAST * problem->reach))
		return false;
	for (int i = 0; i < problem->count; i++) {
		double px[2];

		residual[2 * i] = residual[2 * i + 1] = 0;
		if (!is_view_used(problem, i))
			continue;
		if (!see_point(problem, x, i, &at, px, NULL))
			return false;
		for (int k = 0; k < 2; k++)
			residual[2 * i + k] = px[k] - problem->point[i].px[k];
	}
	return true;
}

double problem_rms(const struct camera_problem *problem, const double *x)
{
	struct turned_view at = {.view = -1};
	double squares = 0;
	int count = 0;

	for (int i = 0; i < problem->count; i++) {
		double px[2];

		if (!is_view_used(problem, i))
			continue;
		if (!see_point(problem, x, i, &at, px, NULL))
			return INFINITY;
		for (int k = 0; k < 2; k++) {
			const double off = px[k] - problem->point[i].px[k];

			squares += off * off;
		}
		count++;
	}
	return count ? sqrt(squares / count) : INFINITY;
}

void problem_slopes(const struct camera_problem *problem, const double *x, double *jacobian)
{
	const int n = problem_unknowns(problem);
	struct turned_view at = {.view = -1};

	for (int i = 0; i < problem->count; i++) {
		double px[2], gradient[2][MODEL_GRADIENT];

		if (!is_view_used(problem, i))
			continue;
		if (!see_point(problem, x, i, &at, px, gradient))
			continue;
		for (int k = 0; k < 2; k++) {
			double *row = jacobian + (size_t)(2 * i + k) * (size_t)n;

			memcpy(row, gradient[k], MODEL_SHARED * sizeof(*row));
			memcpy(row + model_of_view(at.view), gradient[k] + MODEL_SHARED,
			       MODEL_OF_VIEW * sizeof(*row));
		}
	}
}

static void problem_jacobian(void *context, const double *x, double *jacobian)
{
	problem_slopes(context, x, jacobian);
}

/* ---- descent ---- */

static void typical_changes(const struct camera_problem *problem, const double *x, double *scale)
{
	scale[MODEL_FOCAL] = 0.01 * x[MODEL_FOCAL];
	for (int k = 0; k < MODEL_RADIAL; k++)
		scale[MODEL_KAPPA1 + k] = 0.01 / pow(problem->reach, 2 * (k + 1));
	scale[MODEL_CENTRE_X] = 0.01 * problem->reach / problem->model.pixel[0];
	scale[MODEL_CENTRE_Y] = 0.01 * problem->reach / problem->model.pixel[1];
	scale[MODEL_ASPECT] = 0.01;
	for (int v = 0; v < problem->views; v++)
		for (int k = 0; k < MODEL_OF_VIEW; k++)
			scale[model_of_view(v) + k] = k < MODEL_TRANSLATION
							      ? 0.01
							      : 0.01 * problem->shape[v].size;
}

static int problem_first(const void *context, int view)
{
	const struct camera_problem *problem = context;

	return problem->first[view];
}

int problem_descend(const struct camera_problem *problem, double *x, const bool *fixed,
		    double loss_scale, struct least_squares_fit *fit, struct fault *fault)
{
	const int n = problem_unknowns(problem);
	const struct by_view_layout layout = {.views = problem->views,
					      .shared = MODEL_SHARED,
					      .of_view = MODEL_OF_VIEW,
					      .first = problem_first};
	struct least_squares_fit own;
	char(*text)[PARAMETER_NAME_MAX] = calloc((size_t)n, sizeof(*text));
	const char **name = calloc((size_t)n, sizeof(*name));
	double *scale = calloc((size_t)n, sizeof(*scale));
	struct least_squares squares = {
		.parameters = n,
		.residuals = 2 * problem->count,
		.evaluate = problem_residuals,
		.differentiate = problem_jacobian,
		.context = (void *)problem,
		.scale = scale,
		.fixed = fixed,
		.name = name,
		.loss_scale = loss_scale,
		.group = 2,
		.layout = problem->views > 1 && fit ? &layout : NULL,
	};
	int err = -ENOMEM;

	if (fit)
		*fit = (struct least_squares_fit){0};
	if (text && name && scale) {
		for (int k = 0; k < n; k++) {
			problem_name(problem, k, text[k], sizeof(text[k]));
			name[k] = text[k];
		}
		typical_changes(problem, x, scale);
		err = least_squares_solve(&squares, x, fit ? fit : &own, fault);
		if (!fit)
			least_squares_free(&own);
	}
	free(text);
	free(name);
	free(scale);
	return err;
}
