/* SPDX-License-Identifier: MIT */
/* Pictures of points over the photographs, with residuals as arrows. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/report/report_parts.h"

#define NAMED_MOST 12	   /* outliers named in one picture */
#define OUTLIER_ARROW 60.0 /* longest arrow on the sheet */

/* ---- points and arrows ---- */

/* Draws the arrow of a residual, which starts where the point was seen; an outlier's arrow is cut,
 * so that it does not cross the picture. */
static void draw_residual(struct report_sheet *sheet, const struct sheet_area *area,
			  const struct shown *s, int k, double enlargement)
{
	const double *r = s->residual[k];
	const double length = hypot(r[0], r[1]) * enlargement * area->scale;
	const double cut = s->outlier[k] && length > OUTLIER_ARROW ? OUTLIER_ARROW / length : 1;
	const double along[2] = {cut * r[0] * enlargement * area->scale,
				 cut * r[1] * enlargement * area->scale};
	double at[2];

	if (sheet_place(area, s->finding->seen->point[k].px, at))
		sheet_arrow(sheet, at, along, s->outlier[k] ? INK_OUTLIER : INK_RESIDUAL);
}

static void draw_point(struct report_sheet *sheet, const struct sheet_area *area,
		       const struct shown *s, int k)
{
	double at[2];

	if (sheet_place(area, s->finding->seen->point[k].px, at)) {
		if (s->outlier[k])
			sheet_square(sheet, at, 5, INK_OUTLIER);
		else
			sheet_ring(sheet, at, 4.5, INK_SEEN);
	}
	if (s->modelled && sheet_place(area, s->finding->expected[k], at))
		sheet_cross(sheet, at, 3, INK_EXPECTED);
}

/* Writes a point's name beside it, inside the picture. */
static void name_point(struct report_sheet *sheet, const struct sheet_area *area,
		       const struct observation *point)
{
	const double width = sheet_text_width(sheet, point->name);
	double at[2];

	if (!sheet_place(area, point->px, at))
		return;
	if (at[0] + 10 + width > area->left + area->scale * area->width)
		at[0] -= 20 + width;
	sheet_text(sheet, at[0] + 10, at[1] - 6, INK_OUTLIER, "%s", point->name);
}

static void name_outliers(struct report_sheet *sheet, const struct sheet_area *area,
			  const struct shown *s, int view)
{
	const struct observed_view *seen = &s->finding->seen->view[view];
	int named = 0;

	for (int k = seen->first; k < seen->first + seen->count && named < NAMED_MOST; k++)
		if (s->outlier[k]) {
			name_point(sheet, area, &s->finding->seen->point[k]);
			named++;
		}
}

/* Draws the legend: the marks, and the length of an arrow. */
static void draw_legend(struct report_sheet *sheet, const struct sheet_area *area,
			double enlargement, bool marks)
{
	const double y = area->top + area->scale * area->height + SHEET_LINE, middle = y - 5;
	double at[2] = {SHEET_MARGIN + 8, middle};
	const double tip[2] = {30, 0};

	if (marks) {
		sheet_ring(sheet, at, 4.5, INK_SEEN);
		sheet_text(sheet, at[0] + 14, y, INK_BLACK, "seen");
		at[0] += 75;
		sheet_cross(sheet, at, 3, INK_EXPECTED);
		sheet_text(sheet, at[0] + 14, y, INK_BLACK, "expected");
		at[0] += 100;
		sheet_square(sheet, at, 5, INK_OUTLIER);
		sheet_text(sheet, at[0] + 14, y, INK_BLACK, "outlier, not used");
		at[0] += 150;
	}
	sheet_arrow(sheet, at, tip, INK_RESIDUAL);
	sheet_text(sheet, at[0] + 40, y, INK_BLACK,
		   "from expected to seen, %g times as long as it is: this one is %.3g px",
		   enlargement, 30 / (enlargement * area->scale));
}

static int draw_view(const struct shown *s, int v, struct fault *fault)
{
	const struct observed_view *seen = &s->finding->seen->view[v];
	const struct shown_view *view = &s->view[v];
	struct report_sheet sheet;
	struct sheet_area area;
	char name[32], caption[512];
	double enlargement, axes;
	int err = sheet_begin_area(&sheet, &area, s->width, s->height);

	if (!err)
		err = sheet_photograph(&sheet, &area, shown_picture(s, v));
	if (err) {
		sheet_free(&sheet);
		return fault_say(fault, err, "%s: cannot be drawn: %s", seen->name, strerror(-err));
	}
	enlargement = shown_enlargement(s, v, area.scale);
	sheet_clip(&sheet, &area);
	for (int k = seen->first; k < seen->first + seen->count; k++)
		draw_point(&sheet, &area, s, k);
	for (int k = seen->first; k < seen->first + seen->count; k++)
		draw_residual(&sheet, &area, s, k, enlargement);
	name_outliers(&sheet, &area, s, v);
	axes = report_axes(&sheet, &area, s, v);
	sheet_unclip(&sheet);
	sheet_frame(&sheet, &area);
	if (s->modelled)
		draw_legend(&sheet, &area, enlargement, true);
	snprintf(name, sizeof(name), "view-%03d", v + 1);
	if (s->modelled)
		snprintf(caption, sizeof(caption),
			 "View %d, %s: %d points, %.3g px RMS, %.3g px at most, %d outlier%s.",
			 v + 1, seen->name, seen->count, view->rms, view->worst, view->outliers,
			 view->outliers == 1 ? "" : "s");
	else
		snprintf(caption, sizeof(caption), "View %d, %s: %d points.", v + 1, seen->name,
			 seen->count);
	if (axes > 0)
		snprintf(caption + strlen(caption), sizeof(caption) - strlen(caption),
			 " The axes X, Y and Z of its points are %g long.", axes);
	return sheet_show(&sheet, s->page, name, caption, fault);
}

static int write_view_table(const struct shown *s, struct fault *fault)
{
	const struct observations *seen = s->finding->seen;
	struct table table;

	table_begin(&table, "views");
	table_column(&table, "view", "view", NULL);
	table_column(&table, "file", "file", NULL);
	table_column(&table, "points", "points", NULL);
	table_column(&table, "rms_px", "RMS", "px");
	table_column(&table, "worst_px", "at most", "px");
	table_column(&table, "outliers", "outliers", NULL);
	for (int v = 0; v < seen->views; v++) {
		table_number(&table, v + 1);
		table_text(&table, "%s", seen->view[v].name);
		table_number(&table, seen->view[v].count);
		table_number(&table, s->view[v].rms);
		table_number(&table, s->view[v].worst);
		table_number(&table, s->view[v].outliers);
	}
	return report_page_table(s->page, &table, fault);
}

int report_views(const struct shown *s, struct fault *fault)
{
	const int views = s->finding->seen->views;
	int err, drawn = 0;

	for (int v = 0; v < views; v++)
		drawn += s->view[v].drawn;
	report_heading(s->page->body, s->modelled ? "What was seen, and where the model expects it"
						  : "What was seen");
	if (drawn < views)
		report_paragraph(s->page->body,
				 "%d of %d views are drawn: the worst, and some of the others.",
				 drawn, views);
	if (s->modelled && s->finding->project)
		report_paragraph(
			s->page->body,
			"The axes start where the board has its origin. Of the view that "
			"says where the world is they are the scene's: X and Y have to lie on the ground as they were meant, and Z has to point up.");
	err = write_view_table(s, fault);
	for (int v = 0; v < views && !err; v++)
		if (s->view[v].drawn)
			err = draw_view(s, v, fault);
	return err;
}

/* ---- all residuals over the picture ---- */

int report_residuals(const struct shown *s, struct fault *fault)
{
	struct report_sheet sheet;
	struct sheet_area area;
	double enlargement;
	int err = sheet_begin_area(&sheet, &area, s->width, s->height);

	if (err)
		return fault_say(fault, err, "residuals cannot be drawn: %s", strerror(-err));
	sheet_photograph(&sheet, &area, NULL);
	enlargement = shown_enlargement(s, -1, area.scale);
	sheet_clip(&sheet, &area);
	for (int k = 0; k < s->finding->seen->count; k++)
		draw_residual(&sheet, &area, s, k, enlargement);
	sheet_unclip(&sheet);
	sheet_frame(&sheet, &area);
	draw_legend(&sheet, &area, enlargement, false);
	report_heading(s->page->body, "What is left over");
	report_paragraph(
		s->page->body,
		"Residuals of a model that fits point every way. Arrows that agree with their neighbours show what the model cannot do, or a board that is not flat.");
	return sheet_show(
		&sheet, s->page, "residuals",
		"Residuals of all views over the picture; outliers in orange, their arrows cut.",
		fault);
}

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
