/* SPDX-License-Identifier: MIT */
/* Judges the points as given: whether they are enough, listed once each, and spread so that they
 * determine a camera. */
#include <math.h>

#include "bake/calibrate/camera/camera_parts.h"

#define COVERED_LEAST 0.02 /* least share of the picture inside the points' convex hull */

/* ---- what was given ---- */

static void judge_count(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const struct camera_problem *problem = &own->problem;
	const bool known = own->task.intrinsics;

	for (int v = 0; v < problem->views; v++) {
		const int count = problem->first[v + 1] - problem->first[v];
		const bool flat = problem_flat(problem, v);
		const int least = !flat ? 7 : known || problem->views > 1 ? 4 : 5;

		if (count && count < least)
			verdict_doubt(&solution->finding.verdict, "add points",
				      "%d points%s are too few: %s take at least %d", count,
				      problem->views > 1 ? " of a view" : "",
				      flat ? "points of one plane" : "points in space", least);
	}
	if (!known && problem->count < 11)
		verdict_doubt(&solution->finding.verdict, "add points, or give --intrinsics",
			      "%d points are too few for a lens, which takes at least 11",
			      problem->count);
}

static void judge_shape(struct camera_solution *solution)
{
	const struct camera_problem *problem = &solution->own->problem;

	for (int v = 0; v < problem->views; v++)
		if (problem->first[v + 1] - problem->first[v] > 1 &&
		    problem->shape[v].across < SHAPE_FLAT)
			verdict_doubt(
				&solution->finding.verdict,
				"add points beside the line, as far from it as the picture allows",
				"all points%s%s are on a line", problem->views > 1 ? " of " : "",
				problem->views > 1 ? solution->own->seen->view[v].name : "");
}

void camera_judge_points(struct camera_solution *solution)
{
	judge_count(solution);
	judge_shape(solution);
	finding_doubt_twins(&solution->finding);
}

/* ---- how points lie in the picture ---- */

static double turn_of_corner(const double a[2], const double b[2], const double c[2])
{
	return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/* Area of the convex hull of all points in all pictures, by gift wrapping; px^2. */
static double hull_area(const struct camera_problem *problem)
{
	const struct observation *point = problem->point;
	int start = 0, at, steps = 0;
	double area = 0;

	for (int i = 1; i < problem->count; i++)
		if (point[i].px[0] < point[start].px[0])
			start = i;
	at = start;
	do {
		int next = at == 0 ? problem->count - 1 : 0;

		for (int i = 0; i < problem->count; i++) {
			const double side = turn_of_corner(point[at].px, point[next].px,
							   point[i].px);
			const double far = hypot(point[i].px[0] - point[at].px[0],
						 point[i].px[1] - point[at].px[1]);
			const double near = hypot(point[next].px[0] - point[at].px[0],
						  point[next].px[1] - point[at].px[1]);

			if (side < 0 || (side == 0 && far > near))
				next = i;
		}
		area += turn_of_corner(point[start].px, point[at].px, point[next].px) / 2;
		at = next;
	} while (at != start && ++steps < problem->count);
	return fabs(area);
}

void camera_judge_coverage(struct camera_solution *solution)
{
	const struct camera_private *own = solution->own;
	const double picture = (double)own->task.width * own->task.height;
	const double covered = hull_area(&own->problem);

	if (!own->task.intrinsics && picture > 0 && covered < COVERED_LEAST * picture)
		verdict_doubt(
			&solution->finding.verdict,
			"spread the points over the picture, or come closer to the board",
			"the points cover only %.2g %% of the picture: they are all in one corner, or on a line",
			100 * covered / picture);
}
