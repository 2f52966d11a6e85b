/* SPDX-License-Identifier: MIT */
/* How many radial terms a lens needs: what more of them would gain, and what they predict. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/camera/camera_parts.h"

#define FOLDS 5
#define FEWEST_VIEWS 3 /* with fewer, points are left out instead of views */

/* ---- what more terms would gain ---- */

/* Sum over the residuals of the product of two columns, weighted; column -1: the residuals. */
static double columns_product(const struct camera_private *own, const double *jacobian, int a,
			      int b)
{
	const int n = problem_unknowns(&own->problem);
	double sum = 0;

	for (int i = 0; i < 2 * own->problem.count; i++)
		sum += own->fit.weight[i / 2] * jacobian[i * n + a] *
		       (b < 0 ? own->fit.residual[i] : jacobian[i * n + b]);
	return sum;
}

/*
 * The residuals r are orthogonal to the columns J of the free unknowns. New columns E then decrease
 * the sum of squares, to first order, by
 *     u^T M^-1 u,   u = E^T r,   M = E^T E - E^T J (J^T J)^-1 J^T E
 */
static double gain_of(const struct camera_private *own, const double *jacobian, int first,
		      double *by)
{
	const int n = problem_unknowns(&own->problem), extra = MODEL_KAPPA1 + MODEL_RADIAL - first;
	double u[MODEL_RADIAL] = {0}, m[MODEL_RADIAL][MODEL_RADIAL] = {{0}};

	for (int a = 0; a < extra; a++) {
		u[a] = columns_product(own, jacobian, first + a, -1);
		for (int k = 0; k < n; k++)
			by[a * n + k] = own->fixed[k]
						? 0
						: columns_product(own, jacobian, first + a, k);
	}
	for (int a = 0; a < extra; a++)
		for (int b = 0; b < extra; b++) {
			m[a][b] = columns_product(own, jacobian, first + a, first + b);
			for (int k = 0; k < n; k++)
				for (int l = 0; l < n && by[a * n + k] != 0; l++)
					m[a][b] -= by[a * n + k] * own->fit.inverse[k * n + l] *
						   by[b * n + l];
		}
	if (extra == 1)
		return m[0][0] > 0 ? u[0] * u[0] / m[0][0] : 0;
	m[1][1] -= m[0][1] * m[0][1] / m[0][0];
	u[1] -= u[0] * m[0][1] / m[0][0];
	return m[0][0] > 0 && m[1][1] > 0 ? u[0] * u[0] / m[0][0] + u[1] * u[1] / m[1][1] : 0;
}

int camera_radial_gain(const struct camera_private *own, double *gain)
{
	const size_t n = (size_t)problem_unknowns(&own->problem);
	double *jacobian, *by;

	*gain = 0;
	if (own->radial >= MODEL_RADIAL || !(own->fit.sigma > 0))
		return 0;
	jacobian = calloc(2 * (size_t)own->problem.count * n, sizeof(*jacobian));
	by = calloc(MODEL_RADIAL * n, sizeof(*by));
	if (jacobian && by) {
		problem_slopes(&own->problem, own->x, jacobian);
		*gain = gain_of(own, jacobian, MODEL_KAPPA1 + own->radial, by) /
			fmax(own->fit.sigma * own->fit.sigma,
			     CAMERA_NOISE_LEAST * CAMERA_NOISE_LEAST);
	}
	free(jacobian);
	free(by);
	return jacobian && by ? 0 : -ENOMEM;
}

/* ---- what is left out ---- */

/* Work of one round: which points are left out, and the solution without them. */
struct round {
	bool by_view;
	int fold;
	bool *unused;
	double *x;
};

static bool left_out(const struct camera_private *own, const struct round *round, int i)
{
	const int place = round->by_view ? own->problem.point[i].view - own->problem.first_view : i;

	return place % FOLDS == round->fold;
}

/* Cauchy's loss, which approaches the squared distance for small ones. */
static double loss_of(double squared, double width)
{
	return width > 0 ? width * width * log1p(squared / (width * width)) : squared;
}

static double distance_squared(const double a[2], const double b[2])
{
	return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]);
}

/* Finds the poses of the views that were left out; the lens stays. */
static int find_poses(const struct camera_private *own, const struct round *round, double width,
		      bool *lens_fixed)
{
	for (int v = round->fold; v < own->problem.views; v += FOLDS) {
		const struct camera_problem one = problem_of_view(&own->problem, v);
		double x[MODEL_GRADIENT];
		int err;

		if (!one.count)
			continue;
		memcpy(x, round->x, MODEL_SHARED * sizeof(*x));
		memcpy(x + MODEL_SHARED, round->x + model_of_view(v), MODEL_OF_VIEW * sizeof(*x));
		err = problem_descend(&one, x, lens_fixed, width > 0 ? CAMERA_LOSS : 0, NULL, NULL);
		if (err == -ENOMEM)
			return err;
		memcpy(round->x + model_of_view(v), x + MODEL_SHARED, MODEL_OF_VIEW * sizeof(*x));
	}
	return 0;
}

static int leave_out_fold(const struct camera_private *own, const struct round *round, double width,
			  struct camera_left_out *out, double (*px)[2], bool *held)
{
	const int n = problem_unknowns(&own->problem);
	struct camera_problem rest = own->problem;
	bool lens_fixed[MODEL_GRADIENT] = {false};
	int err;

	rest.unused = round->unused;
	memcpy(round->x, own->x, (size_t)n * sizeof(*round->x));
	memcpy(held, own->fixed, (size_t)n * sizeof(*held));
	for (int i = 0; i < rest.count; i++)
		round->unused[i] = left_out(own, round, i);
	for (int v = round->fold; round->by_view && v < rest.views; v += FOLDS)
		for (int k = 0; k < MODEL_OF_VIEW; k++)
			held[model_of_view(v) + k] = true;
	for (int k = 0; k < MODEL_SHARED; k++)
		lens_fixed[k] = true;
	err = problem_descend(&rest, round->x, held, width > 0 ? CAMERA_LOSS : 0, NULL, NULL);
	if (err != -ENOMEM && round->by_view)
		err = find_poses(own, round, width, lens_fixed);
	if (err == -ENOMEM)
		return err;
	problem_expect(&own->problem, round->x, px);
	for (int i = 0; i < rest.count; i++) {
		const int place = round->by_view ? rest.point[i].view - rest.first_view
						 : round->fold;

		if (!round->unused[i])
			continue;
		/* a point without an image is as wrong as the picture is large */
		out->loss[place] += loss_of(isnan(px[i][0])
						    ? own->diagonal * own->diagonal
						    : distance_squared(px[i], rest.point[i].px),
					    width);
		out->points++;
	}
	return 0;
}

int camera_leave_out(const struct camera_private *own, double width, struct camera_left_out *out)
{
	const size_t n = (size_t)problem_unknowns(&own->problem);
	const size_t points = (size_t)own->problem.count;
	struct round round = {.by_view = own->problem.views >= FEWEST_VIEWS};
	double(*px)[2] = calloc(points, sizeof(*px));
	bool *held = calloc(n, sizeof(*held));
	int err = -ENOMEM;

	*out = (struct camera_left_out){.count = round.by_view ? own->problem.views : FOLDS};
	out->loss = calloc((size_t)out->count, sizeof(*out->loss));
	round.unused = calloc(points, sizeof(*round.unused));
	round.x = calloc(n, sizeof(*round.x));
	if (px && held && out->loss && round.unused && round.x)
		err = 0;
	for (round.fold = 0; round.fold < FOLDS && !err; round.fold++)
		err = leave_out_fold(own, &round, width, out, px, held);
	free(px);
	free(held);
	free(round.unused);
	free(round.x);
	return err;
}

bool camera_predicts_better(const struct camera_left_out *a, const struct camera_left_out *b,
			    double least)
{
	double sum = 0, squares = 0;

	for (int k = 0; k < a->count; k++)
		sum += a->loss[k] - b->loss[k];
	for (int k = 0; k < a->count; k++)
		squares += pow(a->loss[k] - b->loss[k] - sum / a->count, 2);
	return sum > least && sum > sqrt(squares * a->count / (a->count - 1.0));
}

/* ---- where it folds over ---- */

double camera_grows_to(const struct camera_private *own, double *reach)
{
	const double *x = own->x, *pixel = own->problem.model.pixel;
	const struct tsai_camera camera = {
		.width = own->task.width,
		.height = own->task.height,
		.kappa1 = x[MODEL_KAPPA1],
		.kappa2 = x[MODEL_KAPPA1 + 1],
		.kappa3 = x[MODEL_KAPPA1 + 2],
		.tangential = {own->problem.model.tangential[0], own->problem.model.tangential[1]},
		.centre_px = {x[MODEL_CENTRE_X], own->task.height - x[MODEL_CENTRE_Y]},
		.pixel = {pixel[0], pixel[1]},
		.aspect = x[MODEL_ASPECT],
	};
	struct distortion d = tsai_distortion_of(&camera);

	if (!own->task.width)
		d.reach = own->problem.reach;
	*reach = d.reach;
	return own->task.distortion == TSAI_DISTORTS ? distortion_covers(&d) : distortion_fold(&d);
}
