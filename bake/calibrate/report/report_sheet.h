/* SPDX-License-Identifier: MIT */
/*
 * Sheets: the pictures of a calibration's report, drawn at the width at which the page shows them.
 */
#ifndef INLAY_BAKE_CALIBRATE_REPORT_REPORT_SHEET_H
#define INLAY_BAKE_CALIBRATE_REPORT_REPORT_SHEET_H

#include <cairo.h>
#include <stdbool.h>

#include "bake/base/report_page.h"

#define SHEET_WIDTH 960
#define SHEET_MARGIN 16
#define SHEET_LINE 19 /* from one line of text to the next */

/* Okabe and Ito's, which the colour-blind tell apart. */
enum sheet_ink {
	INK_BLACK,
	INK_GREY,
	INK_FAINT,
	INK_WHITE,
	INK_SEEN,
	INK_EXPECTED,
	INK_RESIDUAL,
	INK_OUTLIER
};

struct report_sheet {
	cairo_surface_t *surface;
	cairo_t *c;
	int width, height;
};

/* Where the camera's picture lies on a sheet. */
struct sheet_area {
	double left, top, scale; /* sheet = left + scale * px, top + scale * px */
	int width, height;	 /* of the camera's picture, px */
};

/* White. -ENOMEM, -EFBIG. */
int sheet_begin(struct report_sheet *sheet, int width, int height);
void sheet_free(struct report_sheet *sheet); /* idempotent; zeroed is fine */

/* Writes it as NAME.png, shows it in the page, and frees it. */
int sheet_show(struct report_sheet *sheet, struct report_page *page, const char *name,
	       const char *caption, struct fault *fault);

/*
 * A sheet for a picture of this size with so many lines of text below it: begun, the picture's
 * place left white. -ENOMEM, -EFBIG.
 */
int sheet_begin_area(struct report_sheet *sheet, struct sheet_area *area, int width, int height,
		     int lines);
/* The photograph, paled so that marks stand out; NULL: plain grey. -ENOMEM. */
int sheet_photograph(struct report_sheet *sheet, const struct sheet_area *area,
		     const struct image *photograph);
/* What is drawn from here on stays inside the area; sheet_unclip() ends that. */
void sheet_clip(struct report_sheet *sheet, const struct sheet_area *area);
void sheet_unclip(struct report_sheet *sheet);
void sheet_frame(struct report_sheet *sheet, const struct sheet_area *area);
/* False: not finite, or far outside. */
bool sheet_place(const struct sheet_area *area, const double px[2], double at[2]);
double sheet_below(const struct sheet_area *area, int line); /* baseline of a line under it */

void sheet_ink(struct report_sheet *sheet, enum sheet_ink ink, double alpha);
/* share of its width lies left of x; y is its baseline; in what colour is set. */
void sheet_text(struct report_sheet *sheet, double x, double y, double share, const char *format,
		...) __attribute__((format(printf, 5, 6)));
/* The same with paper around its letters, over a picture. */
void sheet_label(struct report_sheet *sheet, double x, double y, enum sheet_ink ink,
		 const char *text);
double sheet_text_width(const struct report_sheet *sheet, const char *text);

void sheet_ring(struct report_sheet *sheet, const double at[2], double radius, enum sheet_ink ink);
void sheet_cross(struct report_sheet *sheet, const double at[2], double radius, enum sheet_ink ink);
void sheet_square(struct report_sheet *sheet, const double at[2], double radius,
		  enum sheet_ink ink);
void sheet_arrow(struct report_sheet *sheet, const double at[2], const double along[2],
		 enum sheet_ink ink);

#endif
