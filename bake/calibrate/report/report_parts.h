/* SPDX-License-Identifier: MIT */
/* What the sections of a calibration's report share. Private to report*.c. */
#ifndef INLAY_BAKE_CALIBRATE_REPORT_REPORT_PARTS_H
#define INLAY_BAKE_CALIBRATE_REPORT_REPORT_PARTS_H

#include <stdbool.h>

#include "bake/base/report_page.h"
#include "bake/calibrate/estimate/finding.h"
#include "bake/calibrate/report/report_sheet.h"

/* A finding as reports look at it. */
struct shown {
	const struct finding *finding;
	const struct image *const *pictures; /* [views] or NULL */
	struct report_page *page;
	bool modelled;		 /* something was found that residuals could be of */
	int width, height;	 /* of the picture, px; at least 1 */
	double (*residual)[2];	 /* [points], seen less expected, px; NaN: expected nowhere */
	bool *outlier;		 /* [points]: low weight, or expected nowhere */
	struct shown_view *view; /* [views] */
	double rms, worst;	 /* length of residuals, outliers left out; 0 without points */
	int outliers;
};

struct shown_view {
	double rms, worst; /* as above; NaN without a model */
	int outliers;
	bool drawn; /* has a picture of its own in the report */
};

/* -EINVAL: a picture that does not fit; -ENOMEM. */
int shown_begin(struct shown *shown, const struct finding *finding,
		const struct image *const *pictures, struct report_page *page, struct fault *fault);
void shown_free(struct shown *shown);

/* A photograph to draw over, or NULL. */
const struct image *shown_picture(const struct shown *shown, int view);

/* 1, 2 or 5 times a power of ten by which arrows are enlarged, so that most are well seen: view -1
 * for all views. */
double shown_enlargement(const struct shown *shown, int view, double scale);

int report_views(const struct shown *shown, struct fault *fault);
int report_residuals(const struct shown *shown, struct fault *fault);
int report_directions(const struct shown *shown, struct fault *fault);
int report_maps(const struct shown *shown, struct fault *fault);
int report_coverage(const struct shown *shown, struct fault *fault);
int report_parameters(const struct shown *shown, struct fault *fault);
int report_correlations(const struct shown *shown, struct fault *fault);
int report_figures(const struct shown *shown, struct fault *fault);
int report_points(const struct shown *shown, struct fault *fault);

/* FOLDER/calibration.json. */
int report_json_write(const struct shown *shown, const char *folder, struct fault *fault);

/* Numbers from -values: sorts, and gives the one below which share of them lie; 0 for none. */
double report_quantile(double *value, int count, double share);

#endif
