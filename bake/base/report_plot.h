/* SPDX-License-Identifier: MIT */
/* Plots of a report, as SVG: lines and points with their names beside them. */
#ifndef INLAY_BAKE_BASE_REPORT_PLOT_H
#define INLAY_BAKE_BASE_REPORT_PLOT_H

#include <stdbool.h>

#include "hal/base/fault.h"

#define REPORT_SERIES_MAX 12
#define REPORT_POINTS_MAX 256
#define REPORT_TICKS_MAX 16

enum report_style { STYLE_LINE, STYLE_DASHED, STYLE_POINTS, STYLE_STEPS };

struct report_point {
	double x, y;
	char label[48]; /* beside the point; empty: none */
	bool ringed;	/* the setting in use */
};

struct report_series {
	char label[64]; /* at its right end; empty: none */
	enum report_style style;
	int colour; /* of a palette that the colour-blind tell apart; 0 is grey */
	struct report_point *point;
	int count;
};

struct report_plot {
	const char *name; /* of its file: NAME.svg */
	char x_label[96], y_label[96];
	bool x_log, y_log;		      /* points that are not above 0 are left out then */
	double x_tick[REPORT_TICKS_MAX];      /* where there is no round number to be chosen */
	const char *x_name[REPORT_TICKS_MAX]; /* in place of the numbers; NULL: none */
	int x_ticks;
	struct report_series series[REPORT_SERIES_MAX];
	int count;
	int err; /* -ENOMEM, -E2BIG */
};

void report_plot_begin(struct report_plot *plot, const char *name, const char *x_label,
		       const char *y_label);
void report_plot_free(struct report_plot *plot); /* idempotent; zeroed is fine */

/* What follows belongs to it. label may be NULL. */
void report_plot_series(struct report_plot *plot, const char *label, enum report_style style,
			int colour);

/* Of the last series; the label of which may be changed later. Never NULL. */
struct report_point *report_plot_point(struct report_plot *plot, double x, double y);

/* FOLDER/NAME.svg. -EIO. */
int report_plot_write(struct report_plot *plot, const char *folder, struct fault *fault);

#endif
