/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/response/light_response_parts.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/least_squares.h"

#define ROUNDS 4 /* rounds of reweighting by the curve found so far */
/* weak prior on second differences of coefficients: no real response comes near */
#define LOOSE 3.0
#define TIME_FIXED 1e-9 /* instead of a deviation of 0 */

/* Equations sqrt(weight) (J a + c). Each sample's weighted mean is subtracted, which eliminates its
 * ln L. */
struct system {
	int columns, rows, samples, room;
	double *row; /* [rows][columns] */
	double *constant;
};

static int exposures_of(const struct light_fit_task *task)
{
	return task->samples->exposures;
}

static bool is_counted(const struct light_fit_task *task, const struct light_sample *s, int j)
{
	return s->good[j] && j != task->held_out &&
	       (task->channel < 0 || s->channel == task->channel);
}

double light_fit_log(const struct light_fit *fit, double u, double *slope, double *bend)
{
	const double step = 1e-4 * u;
	double value[LIGHT_SPLINE_MAX], d[LIGHT_SPLINE_MAX], after[LIGHT_SPLINE_MAX];
	double log_f = log(u), s = 1 / u, second = -1 / (u * u);

	if (bend)
		light_spline_at(&fit->spline, u + step, value, after);
	light_spline_at(&fit->spline, u, value, d);
	for (int k = 0; k < light_spline_count(&fit->spline); k++) {
		log_f += value[k] * fit->a[k];
		s += d[k] * fit->a[k];
		if (bend)
			second += (after[k] - d[k]) / step * fit->a[k];
	}
	if (slope)
		*slope = s;
	if (bend)
		*bend = second;
	return log_f;
}

double light_fit_radiance(const struct light_fit *fit, const struct light_fit_task *task,
			  const struct light_sample *s, int j, double *variance)
{
	double slope, bend;
	const double log_f = light_fit_log(fit, s->mean[j], &slope, &bend);

	/* f'' / f = bend + slope^2, both of ln f. The noise of the mean, bent by ln f, shifts it
	 * too. */
	*variance = slope * slope * s->variance[j];
	return log_f + (bend + slope * slope) * s->noise[j] / 2 - bend * s->variance[j] / 2 -
	       log(task->time[j]) - fit->a[light_spline_count(&fit->spline) + j];
}

static int add_row(struct system *y, double **row)
{
	if (y->rows == y->room) {
		const int room = y->room ? 2 * y->room : 4096;
		double *rows = realloc(y->row, (size_t)room * (size_t)y->columns * sizeof(*rows));
		double *constant;

		if (!rows)
			return -ENOMEM;
		y->row = rows;
		constant = realloc(y->constant, (size_t)room * sizeof(*constant));
		if (!constant)
			return -ENOMEM;
		y->constant = constant;
		y->room = room;
	}
	*row = y->row + (size_t)y->rows * (size_t)y->columns;
	memset(*row, 0, (size_t)y->columns * sizeof(**row));
	y->constant[y->rows++] = 0;
	return 0;
}

/*
 * Weights of a sample's equations, by the curve found so far at the code that all exposures
 * together predict: weights at the observed code would favour exposures that noise made darker.
 */
static void weigh_sample(const struct light_fit *fit, const struct light_fit_task *task,
			 const struct light_sample *s, double weight[LIGHT_EXPOSURES_MAX])
{
	double log_l[LIGHT_EXPOSURES_MAX], variance, sum = 0, total = 0;

	for (int j = 0; j < exposures_of(task); j++) {
		if (!is_counted(task, s, j))
			continue;
		log_l[j] = light_fit_radiance(fit, task, s, j, &variance);
		weight[j] = 1 / variance;
		sum += log_l[j] / variance;
		total += 1 / variance;
	}
	for (int j = 0; fit->sigma > 0 && j < exposures_of(task); j++) {
		double slope, bend;

		if (!is_counted(task, s, j))
			continue;
		light_fit_log(fit, s->mean[j], &slope, &bend);
		slope = fmax(slope - bend * (log_l[j] - sum / total) / slope, slope / 4);
		weight[j] = 1 / (slope * slope * s->variance[j]);
	}
}

/* Adds the equations of a sample, by the curve found so far. */
static int fit_add_sample(struct system *y, const struct light_fit *fit,
			  const struct light_fit_task *task, const struct light_sample *s)
{
	const int splines = light_spline_count(&fit->spline), first = y->rows;
	double by_exposure[LIGHT_EXPOSURES_MAX], weight[LIGHT_EXPOSURES_MAX];
	double total = 0, middle = 0, *mean, *row;
	int good = 0;

	for (int j = 0; j < exposures_of(task); j++)
		good += is_counted(task, s, j);
	if (good < 2)
		return 0;
	mean = calloc((size_t)y->columns, sizeof(*mean));
	if (!mean)
		return -ENOMEM;
	weigh_sample(fit, task, s, by_exposure);
	for (int j = 0; j < exposures_of(task); j++) {
		double variance, now = 0;
		const int r = y->rows - first;

		if (!is_counted(task, s, j))
			continue;
		if (add_row(y, &row) < 0) {
			free(mean);
			return -ENOMEM;
		}
		light_spline_at(&fit->spline, s->mean[j], row, NULL);
		row[splines + j] = -1;
		for (int k = 0; k < y->columns; k++)
			now += row[k] * fit->a[k];
		y->constant[y->rows - 1] = light_fit_radiance(fit, task, s, j, &variance) - now;
		weight[r] = by_exposure[j];
		total += weight[r];
		middle += weight[r] * y->constant[y->rows - 1];
		for (int k = 0; k < y->columns; k++)
			mean[k] += weight[r] * row[k];
	}
	for (int r = 0; r < good; r++) {
		const double root = sqrt(weight[r]);

		row = y->row + (size_t)(first + r) * (size_t)y->columns;
		for (int k = 0; k < y->columns; k++)
			row[k] = root * (row[k] - mean[k] / total);
		y->constant[first + r] = root * (y->constant[first + r] - middle / total);
	}
	free(mean);
	y->samples++;
	return 0;
}

/* Adds prior knowledge: of the times, and of the smoothness. */
static int fit_add_known(struct system *y, const struct light_fit *fit,
			 const struct light_fit_task *task)
{
	const int splines = light_spline_count(&fit->spline);
	double *row;

	for (int k = 2; k < splines; k++) {
		if (add_row(y, &row) < 0)
			return -ENOMEM;
		row[k] = row[k - 2] = 1 / LOOSE;
		row[k - 1] = -2 / LOOSE;
	}
	for (int j = 1; j < exposures_of(task); j++) {
		if (add_row(y, &row) < 0)
			return -ENOMEM;
		row[splines + j] = 1 / fmax(task->time_deviation, TIME_FIXED);
	}
	return 0;
}

static bool response_evaluate(void *context, const double *a, double *residual)
{
	const struct system *y = context;

	for (int i = 0; i < y->rows; i++) {
		const double *row = y->row + (size_t)i * (size_t)y->columns;

		residual[i] = y->constant[i];
		for (int k = 0; k < y->columns; k++)
			residual[i] += row[k] * a[k];
	}
	return true;
}

static void response_differentiate(void *context, const double *a, double *jacobian)
{
	const struct system *y = context;

	(void)a;
	memcpy(jacobian, y->row, (size_t)y->rows * (size_t)y->columns * sizeof(*jacobian));
}

/* Stores the solution; sigma is of the samples' equations alone. */
static void take_solution(struct light_fit *fit, const struct system *y,
			  const struct light_fit_task *task, const struct least_squares_fit *solved,
			  int equations)
{
	const int free_times = task->time_deviation > 0 ? exposures_of(task) - 1 : 0;
	double squares = 0, scale;

	for (int i = 0; i < equations; i++)
		squares += solved->residual[i] * solved->residual[i];
	fit->equations = equations;
	fit->freedom = equations - y->samples - (light_spline_count(&fit->spline) - 1) - free_times;
	fit->sigma = fit->freedom > 0 ? sqrt(squares / fit->freedom) : 0;
	scale = fit->sigma * fit->sigma;
	for (int a = 0; a < y->columns; a++)
		for (int b = 0; b < y->columns; b++)
			fit->covariance[a][b] = scale * solved->inverse[a * y->columns + b];
}

static int response_solve(struct light_fit *fit, struct system *y,
			  const struct light_fit_task *task, int equations, struct fault *fault)
{
	double scale[LIGHT_PARAMETERS_MAX];
	bool fixed[LIGHT_PARAMETERS_MAX] = {false};
	struct least_squares_fit solved = {.covariance = NULL};
	const struct least_squares problem = {.parameters = y->columns,
					      .residuals = y->rows,
					      .evaluate = response_evaluate,
					      .differentiate = response_differentiate,
					      .context = y,
					      .scale = scale,
					      .fixed = fixed,
					      .group = 1};
	int ret;

	for (int k = 0; k < y->columns; k++)
		scale[k] = 1;
	fixed[0] = true; /* a factor of f, which ln L absorbs */
	for (int j = 0; j < exposures_of(task); j++)
		fixed[light_spline_count(&fit->spline) + j] = j == 0 || j == task->held_out ||
							      !(task->time_deviation > 0);
	ret = least_squares_solve(&problem, fit->a, &solved, fault);
	if (ret == -ETIMEDOUT)
		ret = 0; /* the equations are linear: it has converged */
	if (ret == 0)
		take_solution(fit, y, task, &solved, equations);
	least_squares_free(&solved);
	return ret == -ERANGE || ret == -EINVAL ? -ENODATA : ret;
}

int light_fit_find(struct light_fit *fit, const struct light_fit_task *task,
		   const struct light_spline *spline, struct fault *fault)
{
	struct system y = {.columns = light_spline_count(spline) + exposures_of(task)};
	int ret = 0;

	*fit = (struct light_fit){.spline = *spline};
	for (int round = 0; ret == 0 && round < ROUNDS; round++) {
		int equations;

		y.rows = y.samples = 0;
		for (int i = 0; ret == 0 && i < task->samples->count; i++)
			ret = fit_add_sample(&y, fit, task, &task->samples->sample[i]);
		equations = y.rows;
		if (ret == 0 && equations < y.samples + y.columns)
			ret = -ENODATA;
		if (ret == 0)
			ret = fit_add_known(&y, fit, task);
		if (ret == 0)
			ret = response_solve(fit, &y, task, equations, fault);
	}
	free(y.row);
	free(y.constant);
	return ret;
}

double light_fit_foretell(const struct light_fit *fit, const struct light_fit_task *task)
{
	double squares = 0;
	int count = 0;

	for (int i = 0; i < task->samples->count; i++) {
		const struct light_sample *s = &task->samples->sample[i];
		double sum = 0, total = 0, variance, off;

		if (!s->good[task->held_out])
			continue;
		for (int j = 0; j < exposures_of(task); j++) {
			if (!is_counted(task, s, j))
				continue;
			off = light_fit_radiance(fit, task, s, j, &variance);
			sum += off / variance;
			total += 1 / variance;
		}
		if (!(total > 0))
			continue;
		off = light_fit_radiance(fit, task, s, task->held_out, &variance) - sum / total;
		squares += off * off / (variance + 1 / total);
		count++;
	}
	return count ? sqrt(squares / count) : -1;
}
