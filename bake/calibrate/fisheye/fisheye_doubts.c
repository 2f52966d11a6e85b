/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/fisheye_parts.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Points nearer to the axis than this do not tell focal length and model apart. */
#define NEAR_AXIS_DEG 30.0
/* Share of the field that points must reach; less for a model that was given, not chosen by the
 * points. */
#define SEEN_SHARE 0.75
#define SEEN_SHARE_OF_KNOWN 0.5
/* Noise of points that counts at least, px, as that of the best corners. */
#define NOISE_LEAST 0.03
#define OUTLIERS_SHARE 0.2
#define OUTLIER_WEIGHT 0.1
/* A model that was given is refused if another one's rms is so many times smaller. */
#define NEARER 1.5

#define BOARDS_EVERYWHERE "show the board in several places, tilted, out to the rim"

int fisheye_fewest(const struct lens_problem *problem, const struct fisheye_wanted *wanted)
{
	const bool closed = wanted->model != FISHEYE_MODEL_AUTO &&
			    wanted->model != FISHEYE_POLYNOMIAL;
	const int parameters = OPTICS_COUNT - (closed ? FISHEYE_TERMS : 0) +
			       problem->seen->views * LENS_POSE;

	return parameters / 2 + 1;
}

bool fisheye_doubt_count(struct fisheye_result *result, const struct lens_problem *problem,
			 const struct fisheye_wanted *wanted)
{
	const int least = fisheye_fewest(problem, wanted);

	for (int v = 0; v < problem->seen->views; v++)
		if (problem->seen->view[v].count < 4) {
			verdict_doubt(&result->finding.verdict,
				      "leave the picture out, or show more of the board",
				      "%s shows %d points of the board, fewer than 4",
				      problem->seen->view[v].name, problem->seen->view[v].count);
			return true;
		}
	if (problem->seen->count >= least)
		return false;
	verdict_doubt(&result->finding.verdict, BOARDS_EVERYWHERE,
		      "there are %d points, fewer than the %d that tell a lens",
		      problem->seen->count, least);
	return true;
}

/* qsort order, the largest first. */
static int by_falling_angle(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return x < y ? 1 : x > y ? -1 : 0;
}

static double seen_to_deg(const struct fisheye_result *result)
{
	const struct finding *f = &result->finding;
	double *angle = calloc((size_t)f->seen->count + 1, sizeof(*angle)), farthest = 0;
	int count = 0;

	for (int n = 0; angle && n < f->seen->count; n++) {
		const double deg = knowledge_angle_deg(&result->knowledge, f->seen->point[n].px);

		if (f->weight[n] >= OUTLIER_WEIGHT && isfinite(deg))
			angle[count++] = deg;
	}
	if (count) {
		qsort(angle, (size_t)count, sizeof(*angle), by_falling_angle);
		farthest = angle[count / 50];
	}
	free(angle);
	return farthest;
}

static void doubt_unsolved(struct fisheye_result *result, const struct lens_problem *problem,
			   const struct model_trials *trials, enum fisheye_model model)
{
	const char *name = fisheye_model_names[model];

	if (problem->seen->views == 1)
		verdict_doubt(&result->finding.verdict,
			      "show it in three places or more, tilted, out to the rim",
			      "the board was seen in one place only");
	else if (trials->err[model] == -EDOM)
		verdict_doubt(&result->finding.verdict, "choose another model, or none",
			      "a lens of the %s model cannot show all of the points", name);
	else
		verdict_doubt(&result->finding.verdict, BOARDS_EVERYWHERE,
			      "the points do not tell a lens of the %s model: %s", name,
			      trials->fault[model].text);
}

static void doubt_model(struct fisheye_result *result, const struct model_trials *trials,
			enum fisheye_model model)
{
	const enum fisheye_model best = trials->best;

	if (best == model || trials->aic[model] - trials->aic[best] < 10 ||
	    trials->rms_px[model] < NEARER * trials->rms_px[best])
		return;
	verdict_doubt(
		&result->finding.verdict, "let the model be chosen, or look for wrong points",
		"the points are not where a lens of the %s model shows them (%.2f px); one of the %s model is nearer (%.2f px)",
		fisheye_model_names[model], trials->rms_px[model], fisheye_model_names[best],
		trials->rms_px[best]);
}

static void doubt_outliers(struct fisheye_result *result)
{
	const struct finding *f = &result->finding;
	int count = 0, first = -1;

	for (int n = 0; n < f->seen->count; n++)
		if (f->weight[n] < OUTLIER_WEIGHT) {
			first = first < 0 ? n : first;
			count++;
		}
	if (count > OUTLIERS_SHARE * f->seen->count)
		verdict_doubt(&result->finding.verdict, "look at those that the report marks",
			      "%d of %d points lie elsewhere than all others say, %s among them",
			      count, f->seen->count, f->seen->point[first].name);
}

static void doubt_reach(struct fisheye_result *result, const struct fisheye_wanted *wanted)
{
	const bool known = wanted->model != FISHEYE_MODEL_AUTO &&
			   wanted->model != FISHEYE_POLYNOMIAL;
	const double share = known ? SEEN_SHARE_OF_KNOWN : SEEN_SHARE;
	const double seen = seen_to_deg(result);

	finding_add(&result->finding, "seen_to_deg", "points were seen as far from the axis", "deg",
		    seen);
	if (seen < NEAR_AXIS_DEG && !known)
		verdict_doubt(
			&result->finding.verdict, BOARDS_EVERYWHERE,
			"all points lie within %.0f degrees of the axis: focal length and model cannot be told apart",
			seen);
	if (seen < share * wanted->field_deg)
		verdict_doubt(
			&result->finding.verdict, BOARDS_EVERYWHERE,
			"nothing was seen beyond %.0f degrees from the axis: the lens is a guess from there to the rim at %.0f",
			seen, wanted->field_deg);
}

void fisheye_doubt_circle(struct fisheye_result *result, double tolerance_px, const char *remedy)
{
	const struct circle_errors errors = knowledge_errors(&result->knowledge);
	const struct finding *f = &result->finding;
	const int width = f->width ? f->width : 1, height = f->height ? f->height : 1;
	struct fault why = {.text = ""};
	struct fisheye lens;

	if (fisheye_prepare(&lens, &result->lens, width, height, &why))
		verdict_doubt(&result->finding.verdict, remedy, "%s", why.text);
	if (!(errors.most_px <= tolerance_px))
		verdict_doubt(
			&result->finding.verdict, remedy,
			"the lens is known to %.2g px only (one standard deviation, at its worst in the image circle), not to %.2g",
			errors.most_px, tolerance_px);
}

void fisheye_doubt(struct fisheye_result *result, const struct lens_problem *problem,
		   const struct model_trials *trials, const struct fisheye_wanted *wanted,
		   enum fisheye_model model)
{
	finding_doubt_twins(&result->finding);
	if (trials->mirrored)
		verdict_doubt(&result->finding.verdict,
			      "check the order of the points and the view's flips",
			      "the picture is mirrored: it fits better the other way round");
	if (!trials->solved[model]) {
		doubt_unsolved(result, problem, trials, model);
		return;
	}
	if (problem->seen->views == 1)
		verdict_doubt(&result->finding.verdict,
			      "show it in three places or more, tilted, out to the rim",
			      "the board was seen in one place only");
	doubt_model(result, trials, model);
	doubt_outliers(result);
	doubt_reach(result, wanted);
	fisheye_doubt_circle(result, wanted->tolerance_px, BOARDS_EVERYWHERE);
}
