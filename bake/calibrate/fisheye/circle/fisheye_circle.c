/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/circle/fisheye_circle.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/least_squares.h"
#include "bake/calibrate/fisheye/circle/fisheye_rim.h"
#include "bake/calibrate/fisheye/fisheye_parts.h"

#define KEPT_PX 5.0 /* edges farther from the ellipse belong to other things */
#define FEWEST ELLIPSE_FEWEST
/* least share of edges on the ellipse: things at the rim, darkness and lamps have others */
#define INLIERS_SHARE 0.3
#define SECTORS 36	   /* of the rim */
#define SECTORS_SHARE 0.4  /* least share of the sectors with edges */
#define CLIPPED_SHARE 0.25 /* largest share of the edges */
#define OUTLIER_WEIGHT 0.1

enum { CENTRE = ELLIPSE_CENTRE, AXES = ELLIPSE_AXES, NUMBERS = ELLIPSE_NUMBERS };

/* Removes the edges of other things than the rim. */
static void keep_near(struct rim *rim, const double ellipse[NUMBERS])
{
	int kept = 0;

	for (int n = 0; n < rim->count; n++)
		if (fabs(ellipse_distance(ellipse, rim->edge[n].px)) < KEPT_PX)
			rim->edge[kept++] = rim->edge[n];
	rim->count = kept;
}

/* ---- the lens ---- */

static struct optics optics_of(const double ellipse[NUMBERS], const struct fisheye_curve *curve,
			       double rim_rad)
{
	const double radius = fisheye_curve_radius(curve, rim_rad);
	struct optics optics = {.model = curve->model};

	for (int i = 0; i < 2; i++) {
		optics.number[OPTICS_FOCAL + i] = ellipse[AXES + i] / radius;
		optics.number[OPTICS_CENTRE + i] = ellipse[CENTRE + i];
	}
	return optics;
}

/* Turns the covariance of centre and half axes into that of centre and focal lengths. */
static int fill_estimate(struct fisheye_result *result, const struct least_squares_fit *found,
			 double radius)
{
	static const int from[OPTICS_CENTRE + 2] = {AXES, AXES + 1, CENTRE, CENTRE + 1};
	struct estimate *e = &result->finding.estimate;
	const int err = estimate_create(e, NUMBERS);

	if (err)
		return err;
	for (int a = 0; a < NUMBERS; a++) {
		struct parameter *p = &e->parameter[a];

		snprintf(p->name, sizeof(p->name), "%s", optics_names[a]);
		snprintf(p->unit, sizeof(p->unit), "%s", a < OPTICS_CENTRE ? "px/rad" : "px");
		p->value = result->knowledge.lens.optics.number[a];
		for (int b = 0; b < NUMBERS; b++) {
			const double unit = (a < OPTICS_CENTRE ? radius : 1) *
					    (b < OPTICS_CENTRE ? radius : 1);
			const double c = found->covariance[from[a] * NUMBERS + from[b]] / unit;

			e->covariance[a * NUMBERS + b] = c;
			result->knowledge.covariance[a][b] = c;
		}
	}
	e->residuals = result->finding.seen->count;
	e->freedom = found->freedom;
	e->sigma = result->finding.rms_px;
	return 0;
}

/* Fills the expected place of each edge: the nearest point of the ellipse, to first order. */
static void fill_points(struct finding *finding, const double ellipse[NUMBERS],
			const struct least_squares_fit *found)
{
	double squares = 0;
	int count = 0;

	for (int n = 0; n < finding->seen->count; n++) {
		const double *px = finding->seen->point[n].px;
		const double away = ellipse_distance(ellipse, px);
		double normal[2];

		ellipse_normal(ellipse, px, normal);
		for (int i = 0; i < 2; i++)
			finding->expected[n][i] = px[i] - away * normal[i];
		finding->weight[n] = found->weight[n];
		if (found->weight[n] < OUTLIER_WEIGHT)
			continue;
		squares += away * away;
		finding->worst_px = fmax(finding->worst_px, fabs(away));
		count++;
	}
	finding->rms_px = sqrt(squares / (count > 0 ? count : 1));
}

/* ---- doubts ---- */

static void doubt_rim(struct fisheye_result *result, const struct rim *rim,
		      const double ellipse[NUMBERS])
{
	struct verdict *verdict = &result->finding.verdict;
	bool seen_in[SECTORS] = {false};
	int inliers = 0, clipped = 0, sectors = 0;

	for (int n = 0; n < rim->count; n++) {
		const double phi = ellipse_turn(ellipse, rim->edge[n].px);

		if (result->finding.weight[n] < OUTLIER_WEIGHT)
			continue;
		inliers++;
		clipped += rim->edge[n].clipped;
		seen_in[(int)(phi / (2 * M_PI) * SECTORS) % SECTORS] = true;
	}
	for (int k = 0; k < SECTORS; k++)
		sectors += seen_in[k];
	finding_add(&result->finding, "rim_seen", "share of the rim that was seen", "",
		    (double)sectors / SECTORS);
	if (inliers < FEWEST)
		verdict_doubt(verdict,
			      "take the picture under an even, bright sky, with dark surroundings",
			      "no image circle was found: what is bright has no round rim");
	if (sectors < SECTORS_SHARE * SECTORS && rim->cut * 4 > rim->rays)
		verdict_doubt(
			verdict, "show more of the circle, or calibrate with a board",
			"the picture's edge cuts the image circle: its rim is seen in %.0f %% of its length only",
			100.0 * sectors / SECTORS);
	else if (sectors < SECTORS_SHARE * SECTORS)
		verdict_doubt(verdict, "take the picture where light comes from all around",
			      "the rim is dark: it is seen in %.0f %% of its length only",
			      100.0 * sectors / SECTORS);
	if (clipped > CLIPPED_SHARE * inliers)
		verdict_doubt(verdict, "expose less, until the sky at the rim is below white",
			      "the picture is over-exposed at the rim, which moves it outwards");
}

static int rim_conclude(struct fisheye_result *result, const struct rim *rim,
			double ellipse[NUMBERS], double rim_deg,
			const struct fisheye_wanted *wanted, struct fault *fault)
{
	static const double unturned[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
	const bool chosen = wanted->model != FISHEYE_MODEL_AUTO;
	const struct fisheye_curve curve = {.model = chosen ? (enum fisheye_model)wanted->model
							    : FISHEYE_EQUIDISTANT};
	struct finding *finding = &result->finding;
	struct lens_knowledge *knowledge = &result->knowledge;
	struct least_squares_fit found = {.covariance = NULL};
	const double rim_rad = rim_deg * (M_PI / 180);
	int err = ellipse_known(rim, ellipse, &found, fault);

	if (err && err != -ENOMEM) {
		verdict_doubt(&finding->verdict, "take the picture under an even, bright sky",
			      "no image circle was found");
		least_squares_free(&found);
		return 0;
	}
	if (!err) {
		const struct optics optics = optics_of(ellipse, &curve, rim_rad);

		knowledge_begin(knowledge, &optics, unturned);
		fill_points(finding, ellipse, &found);
		err = fill_estimate(result, &found, fisheye_curve_radius(&curve, rim_rad));
	}
	if (!err) {
		knowledge->field_rad = fmin(wanted->field_deg, rim_deg) * (M_PI / 180);
		knowledge->width = finding->width;
		knowledge->height = finding->height;
		snprintf(finding->model, sizeof(finding->model), "%s, from the image circle",
			 fisheye_model_names[curve.model]);
		fisheye_result_settings(result, fmin(wanted->field_deg, rim_deg));
		knowledge_publish(knowledge, finding);
		doubt_rim(result, rim, ellipse);
		fisheye_doubt_circle(result, wanted->tolerance_px,
				     "take the picture under an even, bright sky");
	}
	least_squares_free(&found);
	return err;
}

/* Adds the rim's points as observations, each in the direction that it shows if the lens points
 * straight up. */
static int rim_observe(struct observations *seen, const struct rim *rim,
		       const double ellipse[NUMBERS], double rim_rad, const char *name)
{
	int err = observations_begin_view(seen, name);

	for (int n = 0; !err && n < rim->count; n++) {
		const double *px = rim->edge[n].px;
		const double phi = ellipse_turn(ellipse, px);
		const double world[3] = {sin(rim_rad) * cos(phi), sin(rim_rad) * sin(phi),
					 cos(rim_rad)};

		err = observations_add(seen, world, px, "rim at %.0f degrees", phi * 180 / M_PI);
	}
	return err;
}

int fisheye_circle(struct fisheye_result *result, struct observations *seen,
		   const struct image *picture, const char *name, double rim_deg,
		   const struct fisheye_wanted *wanted, struct fault *fault)
{
	double ellipse[NUMBERS] = {picture->width / 2.0, picture->height / 2.0, 1, 1};
	struct rim rim;
	int err, near, edges;

	*result = (struct fisheye_result){.oriented = false};
	if (wanted->model == FISHEYE_POLYNOMIAL)
		return fault_say(
			fault, -EINVAL,
			"the image circle alone does not tell a polynomial; expected another model, or points");
	if (wanted->model == FISHEYE_ORTHOGRAPHIC && rim_deg > 90)
		return fault_say(
			fault, -EINVAL,
			"an orthographic lens has no rim at %g degrees, expected at most 90",
			rim_deg);
	err = rim_find(&rim, picture, NULL);
	near = err ? 0 : ellipse_search(&rim, ellipse);
	/* Again from the ellipse's own middle, so that rays cross the rim at right angles. */
	if (!err && near >= FEWEST) {
		rim_free(&rim);
		err = rim_find(&rim, picture, ellipse);
		near = err ? 0 : ellipse_search(&rim, ellipse);
	}
	*seen = (struct observations){.width = picture->width, .height = picture->height};
	edges = rim.count;
	if (near >= FEWEST)
		keep_near(&rim, ellipse);
	if (!err)
		err = rim_observe(seen, &rim, ellipse, rim_deg * (M_PI / 180), name);
	if (!err)
		err = finding_create(&result->finding, "fisheye", seen);
	if (!err && (near < FEWEST || near < INLIERS_SHARE * edges))
		verdict_doubt(&result->finding.verdict,
			      "take the picture under an even, bright sky, with dark surroundings",
			      "no image circle was found: what is bright has no round rim");
	else if (!err)
		err = rim_conclude(result, &rim, ellipse, rim_deg, wanted, fault);
	rim_free(&rim);
	if (err == -ENOMEM)
		fault_say(fault, err, "%s: out of memory", name);
	if (err)
		fisheye_result_free(result);
	return err;
}
