/* SPDX-License-Identifier: MIT */
/* A plot of a report as SVG: points in two logarithmic axes, with labels beside them. */
#ifndef INLAY_BAKE_REPORT_REPORT_PLOT_H
#define INLAY_BAKE_REPORT_REPORT_PLOT_H

#include <stdbool.h>

#include "hal/base/fault.h"

#define REPORT_POINTS_MAX 64

struct report_point {
	double x, y;	   /* above 0, else it is left out */
	const char *label; /* beside the point; NULL: none */
	bool strong, ringed;
};

/* Writes FOLDER/NAME.svg. -EIO. */
int report_plot_write(const char *folder, const char *name, const char *x_label,
		      const char *y_label, const struct report_point *points, int count,
		      struct fault *fault);

#endif
