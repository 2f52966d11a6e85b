/* SPDX-License-Identifier: MIT */
/* Shared by the sections of a calibration's report. Private to report/. */
#ifndef INLAY_BAKE_CALIBRATE_REPORT_REPORT_PARTS_H
#define INLAY_BAKE_CALIBRATE_REPORT_REPORT_PARTS_H

#include <cairo.h>
#include <stdbool.h>

#include "bake/base/report_page.h"
#include "bake/calibrate/estimate/finding.h"

#define SHEET_WIDTH 960
#define SHEET_MARGIN 16
#define SHEET_LINE 19 /* height of a line of text */

/* Colours of Okabe and Ito, which colour-blind people can tell apart. */
enum sheet_ink {
	INK_BLACK,
	INK_GREY,
	INK_WHITE,
	INK_SEEN,
	INK_EXPECTED,
	INK_RESIDUAL,
	INK_OUTLIER,
	INK_AXIS_X,
	INK_AXIS_Y,
	INK_AXIS_Z
};

struct report_sheet {
	cairo_surface_t *surface;
	cairo_t *c;
	int width, height;
};

/* Place of the camera's picture on a sheet. */
struct sheet_area {
	double left, top, scale; /* sheet = left + scale * px, top + scale * px */
	int width, height;	 /* of the camera's picture, px */
};

void sheet_free(struct report_sheet *sheet); /* idempotent; zeroed is fine */

/* Writes the sheet as NAME.png, shows it in the page, and frees it. */
int sheet_show(struct report_sheet *sheet, struct report_page *page, const char *name,
	       const char *caption, struct fault *fault);

/*
 * Creates a sheet for a picture of this size with a line of text below it; the picture's place is
 * white. -ENOMEM, -EFBIG.
 */
int sheet_begin_area(struct report_sheet *sheet, struct sheet_area *area, int width, int height);
/* Draws the photograph, paled so that marks stand out; NULL: plain grey. -ENOMEM. */
int sheet_photograph(struct report_sheet *sheet, const struct sheet_area *area,
		     const struct image *photograph);
/* Clips what is drawn from here on to the area, until sheet_unclip(). */
void sheet_clip(struct report_sheet *sheet, const struct sheet_area *area);
void sheet_unclip(struct report_sheet *sheet);
void sheet_frame(struct report_sheet *sheet, const struct sheet_area *area);
/* Converts px to a place on the sheet. False: not finite, or far outside. */
bool sheet_place(const struct sheet_area *area, const double px[2], double at[2]);

/* Writes text with a white outline around its letters; y is its baseline. */
void sheet_text(struct report_sheet *sheet, double x, double y, enum sheet_ink ink,
		const char *format, ...) __attribute__((format(printf, 5, 6)));
double sheet_text_width(const struct report_sheet *sheet, const char *text);

/* Draws a line through places on the sheet. */
void sheet_line(struct report_sheet *sheet, double (*place)[2], int count, double width,
		enum sheet_ink ink);
void sheet_ring(struct report_sheet *sheet, const double at[2], double radius, enum sheet_ink ink);
void sheet_cross(struct report_sheet *sheet, const double at[2], double radius, enum sheet_ink ink);
void sheet_square(struct report_sheet *sheet, const double at[2], double radius,
		  enum sheet_ink ink);
void sheet_arrow(struct report_sheet *sheet, const double at[2], const double along[2],
		 enum sheet_ink ink);

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
