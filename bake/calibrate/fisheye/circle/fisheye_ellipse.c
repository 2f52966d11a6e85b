/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/fisheye/circle/fisheye_rim.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "bake/base/random.h"
#include "bake/calibrate/estimate/linear.h"

#define TRIES 400
#define NEAR_PX 1.5 /* an edge so near lies on the ellipse */
#define LOSS_SCALE 3.0
/* Errors common to all edges, as pixels are not uniform squares and light is diffracted at the rim:
 * larger outwards or inwards than sideways. */
#define TOGETHER_CENTRE_PX 0.01
#define TOGETHER_AXES_PX 0.04 /* the largest error of a blurred picture in test_fisheye_circle.c */
#define SECTORS 24	      /* errors are correlated within a sector */

enum { CENTRE = ELLIPSE_CENTRE, AXES = ELLIPSE_AXES, NUMBERS = ELLIPSE_NUMBERS };

double ellipse_distance(const double ellipse[ELLIPSE_NUMBERS], const double px[2])
{
	double square = 0, slope = 0;

	for (int i = 0; i < 2; i++) {
		const double a = ellipse[ELLIPSE_AXES + i];
		const double d = (px[i] - ellipse[ELLIPSE_CENTRE + i]) / a;

		square += d * d;
		slope += d * d / (a * a);
	}
	return (sqrt(square) - 1) * sqrt(square) / sqrt(slope + 1e-300);
}

void ellipse_normal(const double ellipse[ELLIPSE_NUMBERS], const double px[2], double normal[2])
{
	double length;

	for (int i = 0; i < 2; i++) {
		const double a = ellipse[ELLIPSE_AXES + i];

		normal[i] = (px[i] - ellipse[ELLIPSE_CENTRE + i]) / (a * a);
	}
	length = hypot(normal[0], normal[1]) + 1e-300;
	normal[0] /= length;
	normal[1] /= length;
}

double ellipse_turn(const double ellipse[ELLIPSE_NUMBERS], const double px[2])
{
	const double turn = atan2((px[1] - ellipse[ELLIPSE_CENTRE + 1]) / ellipse[ELLIPSE_AXES + 1],
				  (px[0] - ellipse[ELLIPSE_CENTRE]) / ellipse[ELLIPSE_AXES]);

	return turn < 0 ? turn + 2 * M_PI : turn;
}

/* Fits an ellipse to six random edges, by x^2 + b y^2 + c x + d y + e = 0. */
static bool ellipse_through(const struct rim *rim, int attempt, double ellipse[NUMBERS])
{
	double a[5 * 6], x[4];

	for (int n = 0; n < 6; n++) {
		const uint64_t chance = random_hash((uint64_t)attempt, (uint64_t)n, 0);
		const struct rim_edge *edge = &rim->edge[chance % (uint64_t)rim->count];
		const double px = edge->px[0], py = edge->px[1];

		a[n] = py * py;
		a[6 + n] = px;
		a[12 + n] = py;
		a[18 + n] = 1;
		a[24 + n] = -px * px;
	}
	if (!(linear_solve(a, 6, 4, x) > 1e-12) || !(x[0] > 0))
		return false;
	ellipse[CENTRE] = -x[1] / 2;
	ellipse[CENTRE + 1] = -x[2] / (2 * x[0]);
	x[3] = ellipse[0] * ellipse[0] + x[0] * ellipse[1] * ellipse[1] - x[3];
	ellipse[AXES] = sqrt(x[3]);
	ellipse[AXES + 1] = sqrt(x[3] / x[0]);
	return x[3] > 100;
}

int ellipse_search(const struct rim *rim, double ellipse[NUMBERS])
{
	int best = 0;

	for (int k = 0; k < TRIES && rim->count >= ELLIPSE_FEWEST; k++) {
		double trial[NUMBERS];
		int near = 0;

		if (!ellipse_through(rim, k, trial))
			continue;
		for (int n = 0; n < rim->count; n++)
			near += fabs(ellipse_distance(trial, rim->edge[n].px)) < NEAR_PX;
		if (near <= best)
			continue;
		best = near;
		memcpy(ellipse, trial, sizeof(trial));
	}
	return best;
}

static bool ellipse_evaluate(void *context, const double *x, double *residual)
{
	const struct rim *rim = context;

	if (!(x[AXES] > 1 && x[AXES + 1] > 1))
		return false;
	for (int n = 0; n < rim->count; n++)
		residual[n] = ellipse_distance(x, rim->edge[n].px);
	return true;
}

static int ellipse_fit(const struct rim *rim, double ellipse[NUMBERS],
		       struct least_squares_fit *found, struct fault *fault)
{
	static const double scale[NUMBERS] = {1, 1, 1, 1};
	const struct least_squares problem = {
		.parameters = NUMBERS,
		.residuals = rim->count,
		.evaluate = ellipse_evaluate,
		.context = (void *)rim,
		.scale = scale,
		.loss_scale = LOSS_SCALE,
		.group = 1,
	};

	return least_squares_solve(&problem, ellipse, found, fault);
}

/* Copies the rim without one sector; returns how many edges that leaves out. */
static int ellipse_without(struct rim *part, const struct rim *rim, const double ellipse[NUMBERS],
			   int sector)
{
	part->count = 0;
	for (int n = 0; n < rim->count; n++)
		if ((int)(ellipse_turn(ellipse, rim->edge[n].px) * (SECTORS / (2 * M_PI))) %
			    SECTORS !=
		    sector)
			part->edge[part->count++] = rim->edge[n];
	return rim->count - part->count;
}

/* Jackknife: adds the covariance from leaving out one sector after the other. */
static int leave_out(const struct rim *rim, const double ellipse[NUMBERS], double *covariance)
{
	struct rim part = {.edge = calloc((size_t)rim->count, sizeof(*part.edge))};
	double moved[SECTORS][NUMBERS], mean[NUMBERS] = {0};
	int sectors = 0, err = part.edge ? 0 : -ENOMEM;

	for (int k = 0; !err && k < SECTORS; k++) {
		struct least_squares_fit found = {.covariance = NULL};
		struct fault ignored;

		if (!ellipse_without(&part, rim, ellipse, k))
			continue;
		memcpy(moved[sectors], ellipse, sizeof(moved[sectors]));
		err = ellipse_fit(&part, moved[sectors], &found, &ignored);
		least_squares_free(&found);
		for (int i = 0; i < NUMBERS; i++)
			mean[i] += moved[sectors][i];
		sectors++;
	}
	free(part.edge);
	if (err || sectors <= NUMBERS)
		return err ? err : -ERANGE;
	for (int k = 0; k < sectors; k++)
		for (int i = 0; i < NUMBERS; i++)
			for (int j = 0; j < NUMBERS; j++)
				covariance[i * NUMBERS + j] += (moved[k][i] - mean[i] / sectors) *
							       (moved[k][j] - mean[j] / sectors) *
							       (sectors - 1) / sectors;
	return 0;
}

int ellipse_known(const struct rim *rim, double ellipse[NUMBERS], struct least_squares_fit *found,
		  struct fault *fault)
{
	const int err = ellipse_fit(rim, ellipse, found, fault);
	double covariance[NUMBERS * NUMBERS] = {0};

	if (err)
		return err;
	/* With too few sectors, the covariance of single edges must do. */
	if (leave_out(rim, ellipse, covariance) == -ENOMEM)
		return fault_say(fault, -ENOMEM, "out of memory");
	for (int k = 0; k < NUMBERS * NUMBERS; k++)
		found->covariance[k] += covariance[k];
	for (int i = 0; i < NUMBERS; i++)
		found->covariance[i * NUMBERS + i] +=
			i < AXES ? TOGETHER_CENTRE_PX * TOGETHER_CENTRE_PX
				 : TOGETHER_AXES_PX * TOGETHER_AXES_PX;
	return 0;
}
