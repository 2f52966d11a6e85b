/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/fisheye_find.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/fisheye/fisheye_parts.h"
#include "hal/optics/vec.h"

#define LOSS_SCALE 3.0 /* in deviations of a point: 95 % of the efficiency of plain squares */
#define OUTLIER_WEIGHT 0.1

static const double unturned[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

void fisheye_result_free(struct fisheye_result *result)
{
	finding_free(&result->finding);
	memset(result, 0, sizeof(*result));
}

/* ---- parameters and their deviations ---- */

/* Derivatives of fisheye_rotation()'s three angles, degrees, by turns about the camera's axes. */
static void degrees_by_turn(const double rotation[9], double by[3][3])
{
	const double step = 1e-6;

	for (int k = 0; k < 3; k++) {
		double deg[2][3];

		for (int side = 0; side < 2; side++) {
			const double h = side ? step : -step;
			const double w[3] = {k == 0 ? h : 0, k == 1 ? h : 0, k == 2 ? h : 0};
			double turn[9], turned[9];

			turn_matrix(w, turn);
			turn_multiply(turn, rotation, turned);
			turn_degrees(turned, deg[side]);
		}
		for (int i = 0; i < 3; i++)
			by[i][k] = remainder(deg[1][i] - deg[0][i], 360) / (2 * step);
	}
}

static void name_parameters(const struct lens_problem *problem,
			    const struct lens_solution *solution, struct parameter *parameter)
{
	static const char axis[] = "xyz";

	for (int k = 0; k < OPTICS_COUNT; k++) {
		snprintf(parameter[k].name, sizeof(parameter->name), "%s", optics_names[k]);
		snprintf(parameter[k].unit, sizeof(parameter->unit), "%s",
			 k < OPTICS_CENTRE  ? "px/rad"
			 : k < OPTICS_TERMS ? "px"
					    : "");
		parameter[k].value = solution->optics.number[k];
		parameter[k].fixed = k >= OPTICS_TERMS &&
				     solution->optics.model != FISHEYE_POLYNOMIAL;
	}
	for (int p = 0; p < solution->poses; p++) {
		struct parameter *own = parameter + OPTICS_COUNT + p * LENS_POSE;
		double deg[3];

		turn_degrees(solution->pose[p].rotation, deg);
		for (int k = 0; k < LENS_POSE; k++) {
			char view[18]; /* leaves room for the rest of the name */

			snprintf(view, sizeof(view), "view %d ", problem->seen->view[p].number);
			snprintf(own[k].name, sizeof(own->name), "%s%s %c", view,
				 k < 3 ? "rotation" : "translation", axis[k % 3]);
			snprintf(own[k].unit, sizeof(own->unit), "%s", k < 3 ? "deg" : "");
			own[k].value = k < 3 ? deg[k] : solution->pose[p].translation[k - 3];
		}
	}
}

/* Transforms the rows and columns of turns in a covariance into those of degrees. */
static void turns_to_degrees(const struct lens_solution *solution, double *c)
{
	const int n = solution->parameters;

	for (int p = 0; p < solution->poses; p++) {
		const int at = OPTICS_COUNT + p * LENS_POSE;
		double by[3][3];

		degrees_by_turn(solution->pose[p].rotation, by);
		for (int k = 0; k < n; k++) {
			const double old[3] = {c[at * n + k], c[(at + 1) * n + k],
					       c[(at + 2) * n + k]};

			for (int i = 0; i < 3; i++)
				c[(at + i) * n + k] = vec_dot(by[i], old);
		}
		for (int k = 0; k < n; k++) {
			const double old[3] = {c[k * n + at], c[k * n + at + 1], c[k * n + at + 2]};

			for (int i = 0; i < 3; i++)
				c[k * n + at + i] = vec_dot(by[i], old);
		}
	}
}

static int fill_estimate(struct estimate *estimate, const struct lens_problem *problem,
			 const struct lens_solution *solution)
{
	const size_t n = (size_t)solution->parameters;
	const int err = estimate_create(estimate, solution->parameters);

	if (err)
		return err;
	name_parameters(problem, solution, estimate->parameter);
	memcpy(estimate->covariance, solution->fit.covariance, n * n * sizeof(double));
	turns_to_degrees(solution, estimate->covariance);
	estimate->residuals = 2 * problem->seen->count;
	estimate->freedom = solution->fit.freedom;
	estimate->sigma = solution->fit.sigma;
	return 0;
}

/* ---- what is known of the lens ---- */

static const double *world_rotation(const struct lens_solution *solution, int pose)
{
	return pose < 0 ? unturned : solution->pose[pose].rotation;
}

static void find_knowledge(struct lens_knowledge *knowledge, const struct lens_solution *solution,
			   int pose)
{
	const int n = solution->parameters;
	int at[KNOWLEDGE_COUNT];

	knowledge_begin(knowledge, &solution->optics, world_rotation(solution, pose));
	for (int k = 0; k < KNOWLEDGE_COUNT; k++)
		at[k] = k < OPTICS_COUNT ? k : k + (pose < 0 ? 0 : pose) * LENS_POSE;
	for (int a = 0; a < KNOWLEDGE_COUNT; a++)
		for (int b = 0; b < KNOWLEDGE_COUNT; b++)
			if (pose >= 0 || (a < OPTICS_COUNT && b < OPTICS_COUNT))
				knowledge->covariance[a][b] =
					solution->fit.covariance[at[a] * n + at[b]];
}

/* ---- the finding ---- */

static void fill_points(struct finding *finding, const struct lens_solution *solution)
{
	double squares = 0;
	int count = 0;

	for (int n = 0; n < finding->seen->count; n++) {
		const struct observation *point = &finding->seen->point[n];
		double away;

		if (!lens_expect(solution, point, finding->expected[n]))
			finding->expected[n][0] = finding->expected[n][1] = NAN;
		finding->weight[n] = solution->fit.weight[n];
		if (finding->weight[n] < OUTLIER_WEIGHT)
			continue;
		away = hypot(finding->expected[n][0] - point->px[0],
			     finding->expected[n][1] - point->px[1]);
		squares += away * away;
		finding->worst_px = fmax(finding->worst_px, away);
		count++;
	}
	finding->rms_px = sqrt(squares / (count > 0 ? count : 1));
}

static void add_criteria(struct finding *finding, const struct model_trials *trials)
{
	for (int m = 0; m < FISHEYE_MODEL_COUNT; m++) {
		char key[32], label[96];

		if (!trials->solved[m])
			continue;
		snprintf(key, sizeof(key), "aic_%s", fisheye_model_names[m]);
		snprintf(label, sizeof(label), "Akaike's criterion of the %s model, less the least",
			 fisheye_model_names[m]);
		finding_add(finding, key, label, "", trials->aic[m] - trials->aic[trials->best]);
	}
}

void fisheye_result_settings(struct fisheye_result *result, double field_deg)
{
	const struct oriented_lens *lens = &result->knowledge.lens;
	struct fisheye_settings *s = &result->lens;

	*s = (struct fisheye_settings){.field_deg = field_deg, .model = (int)lens->optics.model};
	for (int i = 0; i < 2; i++) {
		s->focal_px[i] = lens->optics.number[OPTICS_FOCAL + i];
		s->centre_px[i] = lens->optics.number[OPTICS_CENTRE + i];
	}
	memcpy(s->polynomial, lens->optics.number + OPTICS_TERMS, sizeof(s->polynomial));
	if (result->oriented)
		turn_degrees(lens->rotation, s->rotation_deg);
}

/*
 * A level board is seen from above if it lies on the ground, as board_point() has it, and from
 * below if it is held over the lens: turned over about its rows, with Y and Z the other way. The
 * one that has the lens look up is taken, because a lens that looks down sees no sky.
 */
static void look_up(struct lens_knowledge *knowledge)
{
	double *rotation = knowledge->lens.rotation;

	if (rotation[8] >= 0)
		return;
	for (int i = 0; i < 3; i++) {
		rotation[3 * i + 1] *= -1;
		rotation[3 * i + 2] *= -1;
	}
}

static int publish_lens(struct fisheye_result *result, const struct lens_problem *problem,
			const struct model_trials *trials, const struct fisheye_wanted *wanted,
			enum fisheye_model model)
{
	const struct lens_solution *solution = &trials->solution[model];
	const int pose = wanted->world_view;
	struct finding *finding = &result->finding;
	const int err = fill_estimate(&finding->estimate, problem, solution);

	if (err)
		return err;
	find_knowledge(&result->knowledge, solution, pose);
	result->knowledge.field_rad = wanted->field_deg * (M_PI / 180);
	result->knowledge.width = finding->width;
	result->knowledge.height = finding->height;
	result->oriented = pose >= 0;
	if (pose >= 0)
		look_up(&result->knowledge);
	snprintf(finding->model, sizeof(finding->model), "%s", fisheye_model_names[model]);
	fill_points(finding, solution);
	knowledge_publish(&result->knowledge, finding);
	add_criteria(finding, trials);
	fisheye_result_settings(result, wanted->field_deg);
	return 0;
}

static int find_lens(struct fisheye_result *result, const struct lens_problem *problem,
		     const struct fisheye_wanted *wanted, struct lens_solution *start,
		     struct fault *fault)
{
	struct model_trials trials = {.mirrored = false};
	bool mirrored = false;
	enum fisheye_model model;
	int err = lens_start(problem, start, &mirrored, fault);

	if (err == -ERANGE) {
		verdict_doubt(&result->finding.verdict,
			      "show it in several places all over the picture", "%s", fault->text);
		return 0;
	}
	if (!err)
		err = models_try(&trials, problem, start, wanted->model);
	if (err)
		return err;
	trials.mirrored = mirrored;
	model = wanted->model == FISHEYE_MODEL_AUTO ? trials.best
						    : (enum fisheye_model)wanted->model;
	if (trials.solved[model])
		err = publish_lens(result, problem, &trials, wanted, model);
	if (!err)
		fisheye_doubt(result, problem, &trials, wanted, model);
	models_free(&trials);
	return err;
}

int fisheye_find(struct fisheye_result *result, const struct observations *seen,
		 const struct fisheye_wanted *wanted, struct fault *fault)
{
	const struct lens_problem problem = {.seen = seen};
	struct lens_solution start = {.poses = 0};
	int err;

	*result = (struct fisheye_result){.oriented = false};
	err = finding_create(&result->finding, "fisheye", seen);
	if (!err && !fisheye_doubt_count(result, &problem, wanted)) {
		err = lens_solution_create(&start, &problem);
		if (!err)
			err = find_lens(result, &problem, wanted, &start, fault);
	}
	lens_solution_free(&start);
	if (err == -ENOMEM)
		fault_say(fault, err, "fisheye: out of memory");
	if (err)
		fisheye_result_free(result);
	return err;
}
