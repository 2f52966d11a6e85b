/* SPDX-License-Identifier: MIT */
/* The world's axes in a view: from where lengths are counted, and which way is up. */
#include <math.h>
#include <stdio.h>

#include "bake/calibrate/report/report_parts.h"

#define STEPS 24 /* of an axis, which the lens may bend */

/* Returns 1, 2 or 5 times a power of ten, about a third of the longest side of the view's
 * points. */
static double axis_length(const struct observations *seen, int view)
{
	const struct observation *point = seen->point + seen->view[view].first;
	double longest = 0, unit;

	for (int k = 0; k < 3; k++) {
		double low = INFINITY, high = -INFINITY;

		for (int i = 0; i < seen->view[view].count; i++) {
			low = fmin(low, point[i].world[k]);
			high = fmax(high, point[i].world[k]);
		}
		longest = fmax(longest, high - low);
	}
	if (!(longest > 0) || !isfinite(longest))
		return 0;
	unit = pow(10, floor(log10(longest / 3)));
	return longest / 3 >= 5 * unit ? 5 * unit : longest / 3 >= 2 * unit ? 2 * unit : unit;
}

/* Draws one axis as far as it is seen, with its name at the end. */
static void draw_axis(struct report_sheet *sheet, const struct sheet_area *area,
		      const struct shown *s, int view, int axis, double length)
{
	static const enum sheet_ink ink[] = {INK_AXIS_X, INK_AXIS_Y, INK_AXIS_Z};
	static const char *const name[] = {"X", "Y", "Z"};
	double place[STEPS + 1][2];
	int count = 0;

	while (count <= STEPS) {
		double world[3] = {0, 0, 0}, px[2];

		world[axis] = length * count / STEPS;
		if (!s->finding->project(s->finding->context, view, world, px) ||
		    !sheet_place(area, px, place[count]))
			break;
		count++;
	}
	if (count < 2)
		return;
	sheet_line(sheet, place, count, 3, ink[axis]);
	sheet_text(sheet, place[count - 1][0] + 5, place[count - 1][1] + 5, ink[axis], "%s",
		   name[axis]);
}

double report_axes(struct report_sheet *sheet, const struct sheet_area *area, const struct shown *s,
		   int view)
{
	const double length = axis_length(s->finding->seen, view);

	if (!s->modelled || !s->finding->project || !(length > 0))
		return 0;
	for (int axis = 0; axis < 3; axis++)
		draw_axis(sheet, area, s, view, axis, length);
	return length;
}
