/* SPDX-License-Identifier: MIT */
/*
 * Pictures that were turned by 180 degrees after they were taken: a camera or a program turned them
 * upright. A board in them has a pose like any other, but the axis is on the other side of the
 * picture's middle, and a calibration that takes all pictures as alike puts it between both places.
 */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/camera/camera_parts.h"
#include "bake/calibrate/estimate/linear.h"

#define ROUNDS 20

/* What one view tells of the axis: to first order its squares grow by
 *     (a - at)^T m (a - at)
 * for an axis at a, relative to the picture's middle, with the lens else unchanged. */
struct axis_told {
	double at[2], m[3]; /* xx, xy, yy */
};

/* Subtracts from a column the part that the view's pose explains. */
static void clear_of_pose(double *room, const double *pose, int rows, double *column)
{
	double by[MODEL_OF_VIEW];

	memcpy(room, pose, MODEL_OF_VIEW * (size_t)rows * sizeof(*room));
	memcpy(room + MODEL_OF_VIEW * (size_t)rows, column, (size_t)rows * sizeof(*room));
	linear_solve(room, rows, MODEL_OF_VIEW, by);
	for (int k = 0; k < MODEL_OF_VIEW; k++)
		for (int i = 0; i < rows; i++)
			column[i] -= by[k] * pose[k * rows + i];
}

static double product(const double *a, const double *b, int rows)
{
	double sum = 0;

	for (int i = 0; i < rows; i++)
		sum += a[i] * b[i];
	return sum;
}

/* Fills one view's columns: the pose's, both of the axis, the residuals; then what they tell. */
static void view_tells(const struct camera_private *own, const double *jacobian, int view,
		       double *room, struct axis_told *told)
{
	const int first = own->problem.first[view];
	const int rows = 2 * (own->problem.first[view + 1] - first);
	const int n = problem_unknowns(&own->problem);
	double *pose = room, *axis[2], *residual, *scratch, u[2], determinant;

	*told = (struct axis_told){{0, 0}, {0, 0, 0}};
	if (rows < MODEL_OF_VIEW + 4)
		return;
	axis[0] = pose + MODEL_OF_VIEW * (size_t)rows;
	axis[1] = axis[0] + rows;
	residual = axis[1] + rows;
	scratch = residual + rows;
	for (int i = 0; i < rows; i++) {
		const double root = sqrt(own->fit.weight[first + i / 2]);
		const double *row = jacobian + (size_t)(2 * first + i) * (size_t)n;

		for (int k = 0; k < MODEL_OF_VIEW; k++)
			pose[k * rows + i] = root * row[model_of_view(view) + k];
		for (int k = 0; k < 2; k++)
			axis[k][i] = root * row[MODEL_CENTRE_X + k];
		residual[i] = root * own->fit.residual[2 * first + i];
	}
	for (int k = 0; k < 2; k++)
		clear_of_pose(scratch, pose, rows, axis[k]);
	for (int k = 0; k < 2; k++)
		u[k] = product(axis[k], residual, rows);
	told->m[0] = product(axis[0], axis[0], rows);
	told->m[1] = product(axis[0], axis[1], rows);
	told->m[2] = product(axis[1], axis[1], rows);
	determinant = told->m[0] * told->m[2] - told->m[1] * told->m[1];
	told->at[0] = own->x[MODEL_CENTRE_X] - own->task.width / 2.0;
	told->at[1] = own->x[MODEL_CENTRE_Y] - own->task.height / 2.0;
	if (!(determinant > 1e-9 * told->m[0] * told->m[2])) {
		memset(told->m, 0, sizeof(told->m));
		return;
	}
	told->at[0] -= (told->m[2] * u[0] - told->m[1] * u[1]) / determinant;
	told->at[1] -= (told->m[0] * u[1] - told->m[1] * u[0]) / determinant;
}

static double cost_of(const struct axis_told *told, double sign, const double axis[2])
{
	const double x = sign * axis[0] - told->at[0], y = sign * axis[1] - told->at[1];

	return told->m[0] * x * x + 2 * told->m[1] * x * y + told->m[2] * y * y;
}

/* Finds the axis that fits all views best, those of sign -1 turned. Returns the cost. */
static double best_axis(const struct axis_told *told, const double *sign, int views, double axis[2])
{
	double m[3] = {0, 0, 0}, b[2] = {0, 0}, determinant, cost = 0;

	for (int v = 0; v < views; v++) {
		const struct axis_told *t = &told[v];

		for (int k = 0; k < 3; k++)
			m[k] += t->m[k];
		b[0] += sign[v] * (t->m[0] * t->at[0] + t->m[1] * t->at[1]);
		b[1] += sign[v] * (t->m[1] * t->at[0] + t->m[2] * t->at[1]);
	}
	determinant = m[0] * m[2] - m[1] * m[1];
	if (!(determinant > 0))
		return INFINITY;
	axis[0] = (m[2] * b[0] - m[1] * b[1]) / determinant;
	axis[1] = (m[0] * b[1] - m[1] * b[0]) / determinant;
	for (int v = 0; v < views; v++)
		cost += cost_of(&told[v], sign[v], axis);
	return cost;
}

/* Finds which views are turned, from where each view sees the axis in turn. Returns the cost. */
static double find_sides(const struct axis_told *told, int views, double *sign, double *best)
{
	double least = INFINITY;

	for (int start = 0; start < views; start++) {
		double axis[2] = {told[start].at[0], told[start].at[1]}, cost = INFINITY;

		for (int round = 0; round < ROUNDS; round++) {
			const double before = cost;

			for (int v = 0; v < views; v++)
				sign[v] = cost_of(&told[v], 1, axis) <= cost_of(&told[v], -1, axis)
						  ? 1
						  : -1;
			cost = best_axis(told, sign, views, axis);
			if (!(cost < before))
				break;
		}
		if (cost < least) {
			least = cost;
			memcpy(best, sign, (size_t)views * sizeof(*best));
		}
	}
	return least;
}

/* Turns own->turned of the views that are turned against the reference view. Returns the gain. */
static double choose_sides(struct camera_private *own, const struct axis_told *told, double *sign,
			   double *best)
{
	const int views = own->problem.views;
	const double turned = find_sides(told, views, sign, best);
	double alike, axis[2];

	for (int v = 0; v < views; v++)
		sign[v] = 1;
	alike = best_axis(told, sign, views, axis);
	for (int v = 0; v < views; v++)
		own->turned[v] ^= best[v] != best[own->task.reference];
	return alike - turned;
}

/* Variance of what the views tell of the axis, in units of a residual's: that of noise, or more
 * where boards that are not flat make them disagree. */
static double axis_variance(const struct camera_private *own, const struct axis_told *told,
			    double *sign)
{
	const int views = own->problem.views;
	const double sigma = fmax(own->fit.sigma, CAMERA_NOISE_LEAST);
	double axis[2];

	for (int v = 0; v < views; v++)
		sign[v] = 1;
	return fmax(sigma * sigma, best_axis(told, sign, views, axis) / (2 * views - 2));
}

int camera_tell_turned(struct camera_private *own, double *gain, double *variance)
{
	const size_t n = (size_t)problem_unknowns(&own->problem);
	const size_t views = (size_t)own->problem.views, points = (size_t)own->problem.count;
	double *jacobian, *room, *sign;
	struct axis_told *told;
	int err = -ENOMEM;

	jacobian = calloc(2 * points * n, sizeof(*jacobian));
	room = calloc((2 * MODEL_OF_VIEW + 4) * 2 * points, sizeof(*room));
	sign = calloc(2 * views, sizeof(*sign));
	told = calloc(views, sizeof(*told));
	if (jacobian && room && sign && told) {
		err = 0;
		problem_slopes(&own->problem, own->x, jacobian);
		for (int v = 0; v < own->problem.views; v++)
			view_tells(own, jacobian, v, room, &told[v]);
		*variance = axis_variance(own, told, sign);
		*gain = choose_sides(own, told, sign, sign + views);
	}
	free(jacobian);
	free(room);
	free(sign);
	free(told);
	return err;
}

void camera_turn_point(const struct camera_private *own, double px[2])
{
	px[0] = own->task.width - px[0];
	px[1] = own->task.height - px[1];
}

int camera_turn_pictures(struct camera_private *own)
{
	const size_t bytes = (size_t)own->problem.count * sizeof(*own->turned_point);

	if (!own->turned_point)
		own->turned_point = malloc(bytes);
	if (!own->turned_point)
		return -ENOMEM;
	memcpy(own->turned_point, own->seen->point, bytes);
	for (int i = 0; i < own->problem.count; i++)
		if (own->turned[own->problem.point[i].view])
			camera_turn_point(own, own->turned_point[i].px);
	own->problem.point = own->turned_point;
	return 0;
}

void camera_turn_camera(struct tsai_camera *camera)
{
	for (int k = 0; k < 6; k++)
		camera->rotation[k] = -camera->rotation[k];
	for (int k = 0; k < 2; k++) {
		camera->translation[k] = -camera->translation[k];
		camera->tangential[k] = -camera->tangential[k];
	}
	camera->centre_px[0] = camera->width - camera->centre_px[0];
	camera->centre_px[1] = camera->height - camera->centre_px[1];
}
