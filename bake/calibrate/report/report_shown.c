/* SPDX-License-Identifier: MIT */
/* Prepares a finding for its report: residuals, outliers, which views are drawn. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/order.h"
#include "bake/calibrate/report/report_parts.h"

#define OUTLIER_WEIGHT 0.1 /* finding.h */
#define VIEWS_DRAWN 12	   /* views drawn at most; the table has all */
#define VIEWS_WORST 4	   /* those of them with the largest residuals */
#define MARGIN 1.1	   /* border around points in a picture of unknown size */
#define ARROW_PX 40.0	   /* largest length of most arrows on the sheet */

static double quantile(double *value, int count, double share)
{
	if (!count)
		return 0;
	qsort(value, (size_t)count, sizeof(*value), order_doubles);
	return value[(int)(share * (count - 1) + 0.5)];
}

/* ---- size ---- */

static int check_shown_pictures(const struct shown *s, struct fault *fault)
{
	const struct observations *seen = s->finding->seen;

	for (int v = 0; s->pictures && v < seen->views; v++) {
		const struct image *picture = s->pictures[v];

		if (picture &&
		    (!picture->u8 || picture->width != s->width || picture->height != s->height))
			return fault_say(fault, -EINVAL,
					 "%s: a picture of %d x %d, expected 8 bits and %d x %d",
					 seen->view[v].name, picture->width, picture->height,
					 s->width, s->height);
	}
	return 0;
}

/* Finds the picture's size: the finding's, the pictures', or one that holds all points. */
static void find_size(struct shown *s)
{
	const struct observations *seen = s->finding->seen;

	s->width = s->finding->width;
	s->height = s->finding->height;
	for (int v = 0; s->pictures && (s->width < 1 || s->height < 1) && v < seen->views; v++)
		if (s->pictures[v]) {
			s->width = s->pictures[v]->width;
			s->height = s->pictures[v]->height;
		}
	if (s->width > 0 && s->height > 0)
		return;
	s->width = s->height = 1;
	for (int k = 0; k < seen->count; k++) {
		s->width = (int)fmin(fmax(s->width, ceil(MARGIN * seen->point[k].px[0])),
				     IMAGE_SIDE_MAX);
		s->height = (int)fmin(fmax(s->height, ceil(MARGIN * seen->point[k].px[1])),
				      IMAGE_SIDE_MAX);
	}
}

/* ---- residuals ---- */

static void measure_point(struct shown *s, int k)
{
	const struct finding *f = s->finding;
	double *r = s->residual[k];

	if (!s->modelled) {
		r[0] = r[1] = NAN;
		return;
	}
	for (int i = 0; i < 2; i++)
		r[i] = f->seen->point[k].px[i] - f->expected[k][i];
	if (!isfinite(r[0]) || !isfinite(r[1]))
		r[0] = r[1] = NAN;
	s->outlier[k] = isnan(r[0]) || !(f->weight[k] >= OUTLIER_WEIGHT);
}

static void measure_view(struct shown *s, int v)
{
	const struct observed_view *seen = &s->finding->seen->view[v];
	struct shown_view *view = &s->view[v];
	double squares = 0;

	for (int k = seen->first; k < seen->first + seen->count; k++) {
		const double length = hypot(s->residual[k][0], s->residual[k][1]);

		view->outliers += s->outlier[k];
		if (s->outlier[k] || isnan(length))
			continue;
		squares += length * length;
		view->worst = fmax(view->worst, length);
	}
	if (!s->modelled)
		view->rms = view->worst = NAN;
	else if (seen->count > view->outliers)
		view->rms = sqrt(squares / (seen->count - view->outliers));
	s->outliers += view->outliers;
}

static int worst_undrawn(const struct shown *s)
{
	int worst = -1;

	for (int v = 0; v < s->finding->seen->views; v++)
		if (!s->view[v].drawn && (worst < 0 || s->view[v].rms > s->view[worst].rms))
			worst = v;
	return worst;
}

/* Chooses the views to draw: all of a few; of many the worst ones, and others evenly spaced. */
static void choose_views(struct shown *s)
{
	const int views = s->finding->seen->views;
	int drawn = 0;

	for (; drawn < VIEWS_WORST && drawn < views; drawn++)
		s->view[worst_undrawn(s)].drawn = true;
	for (int k = 0; drawn < VIEWS_DRAWN && drawn < views; k++, drawn++) {
		int v = k * views / (VIEWS_DRAWN - VIEWS_WORST) % views;

		while (s->view[v].drawn)
			v = (v + 1) % views;
		s->view[v].drawn = true;
	}
}

int shown_begin(struct shown *s, const struct finding *finding, const struct image *const *pictures,
		struct report_page *page, struct fault *fault)
{
	const struct observations *seen = finding->seen;
	const size_t points = (size_t)seen->count + 1, views = (size_t)seen->views + 1;

	*s = (struct shown){.finding = finding, .pictures = pictures, .page = page};
	s->modelled = finding->estimate.count > 0;
	find_size(s);
	if (check_shown_pictures(s, fault))
		return -EINVAL;
	s->residual = calloc(points, sizeof(*s->residual));
	s->outlier = calloc(points, sizeof(*s->outlier));
	s->view = calloc(views, sizeof(*s->view));
	if (!s->residual || !s->outlier || !s->view) {
		shown_free(s);
		return fault_say(fault, -ENOMEM, "not enough memory for the report");
	}
	for (int k = 0; k < seen->count; k++)
		measure_point(s, k);
	for (int v = 0; v < seen->views; v++)
		measure_view(s, v);
	choose_views(s);
	return 0;
}

void shown_free(struct shown *s)
{
	free(s->residual);
	free(s->outlier);
	free(s->view);
	*s = (struct shown){.finding = NULL};
}

const struct image *shown_picture(const struct shown *s, int view)
{
	return s->pictures ? s->pictures[view] : NULL;
}

static double round_down(double value)
{
	const double decade = pow(10, floor(log10(value)));

	return value >= 5 * decade ? 5 * decade : value >= 2 * decade ? 2 * decade : decade;
}

double shown_enlargement(const struct shown *s, int view, double scale)
{
	const struct observations *seen = s->finding->seen;
	double *length = malloc(((size_t)seen->count + 1) * sizeof(*length));
	double most;
	int count = 0;

	if (!length)
		return 1;
	for (int k = 0; k < seen->count; k++)
		if (!s->outlier[k] && (view < 0 || seen->point[k].view == view))
			length[count++] = hypot(s->residual[k][0], s->residual[k][1]);
	most = quantile(length, count, 0.9);
	free(length);
	return most > 0 ? round_down(fmin(fmax(ARROW_PX / (scale * most), 1e-3), 1e6)) : 1;
}
