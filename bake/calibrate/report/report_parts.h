/* SPDX-License-Identifier: MIT */
/* Shared by the sections of a calibration's report. Private to report/. */
#ifndef INLAY_BAKE_CALIBRATE_REPORT_REPORT_PARTS_H
#define INLAY_BAKE_CALIBRATE_REPORT_REPORT_PARTS_H

#include <stdbool.h>

#include "bake/base/report_page.h"
#include "bake/calibrate/estimate/finding.h"
#include "bake/calibrate/report/report_sheet.h"

/* A finding prepared for its report. */
struct shown {
	const struct finding *finding;
	const struct image *const *pictures; /* [views] or NULL */
	struct report_page *page;
	bool modelled;	   /* a model was found, so there are residuals */
	int width, height; /* of the picture, px; at least 1 */
	/* [points], seen minus expected, px; NaN: the model has no image of the point */
	double (*residual)[2];
	bool *outlier;		 /* [points]: low weight, or no image */
	struct shown_view *view; /* [views] */
	int outliers;
};

struct shown_view {
	double rms, worst; /* of the lengths of residuals, without outliers; NaN without a model */
	int outliers;
	bool drawn; /* has its own picture in the report */
};

/* Prepares a finding. -EINVAL: a picture that does not fit; -ENOMEM. */
int shown_begin(struct shown *shown, const struct finding *finding,
		const struct image *const *pictures, struct report_page *page, struct fault *fault);
void shown_free(struct shown *shown);

/* Returns the photograph of a view, or NULL. */
const struct image *shown_picture(const struct shown *shown, int view);

/* Returns the enlargement of arrows, 1, 2 or 5 times a power of ten, that makes most of them well
 * visible; view -1: of all views. */
double shown_enlargement(const struct shown *shown, int view, double scale);

/* Draws the world's axes in a view. Returns their length; 0: none are drawn. */
double report_axes(struct report_sheet *sheet, const struct sheet_area *area,
		   const struct shown *shown, int view);

int report_views(const struct shown *shown, struct fault *fault);
int report_residuals(const struct shown *shown, struct fault *fault);
int report_parts_of_picture(const struct shown *shown, struct fault *fault);
int report_parameters(const struct shown *shown, struct fault *fault);
int report_figures(const struct shown *shown, struct fault *fault);

/* Writes FOLDER/calibration.json. */
int report_json_write(const struct shown *shown, const char *folder, struct fault *fault);

#endif
