/* SPDX-License-Identifier: MIT */
/* Plots of a report as SVG: lines and points, with their labels beside them. */
#ifndef INLAY_BAKE_BASE_REPORT_PLOT_H
#define INLAY_BAKE_BASE_REPORT_PLOT_H

#include <stdbool.h>

#include "hal/base/fault.h"

#define REPORT_SERIES_MAX 12
#define REPORT_POINTS_MAX 256
#define REPORT_TICKS_MAX 16

enum report_style { STYLE_LINE, STYLE_DASHED, STYLE_POINTS };

struct report_point {
	double x, y;
	double y_low, y_high; /* a bar from here to there; both y: none */
	char label[48];	      /* beside the point; empty: none */
	bool ringed;	      /* the setting in use */
};

struct report_series {
	char label[64]; /* at its right end; empty: none */
	enum report_style style;
	int colour; /* index into a palette for colour-blind readers, too; 0 is grey */
	struct report_point *point;
	int count;
};

struct report_plot {
	const char *name; /* of its file, NAME.svg */
	char x_label[96], y_label[96];
	bool x_log, y_log;		 /* logarithmic; points not above 0 are left out */
	double x_tick[REPORT_TICKS_MAX]; /* values of the ticks, where round numbers do not fit */
	int x_ticks;
	struct report_series series[REPORT_SERIES_MAX];
	int count;
	int err; /* the first error: -ENOMEM, -E2BIG */
};

void report_plot_begin(struct report_plot *plot, const char *name, const char *x_label,
		       const char *y_label);
void report_plot_free(struct report_plot *plot); /* idempotent; zeroed is fine */

/* Begins a series, to which the following points belong. label may be NULL. */
void report_plot_series(struct report_plot *plot, const char *label, enum report_style style,
			int colour);

/* Adds a point to the last series and returns it, for the caller to set label and ring. Never NULL:
 * a point that cannot be drawn or has no room is discarded. */
struct report_point *report_plot_point(struct report_plot *plot, double x, double y);

/* Writes FOLDER/NAME.svg. Returns the plot's first error, or -EIO. */
int report_plot_write(struct report_plot *plot, const char *folder, struct fault *fault);

#endif
