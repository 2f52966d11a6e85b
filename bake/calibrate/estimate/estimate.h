/* SPDX-License-Identifier: MIT */
/*
 * Estimated parameters with their covariance.
 *
 * Deviations are standard deviations of one estimate, to first order:
 *     covariance = sigma^2 (J^T W J)^-1
 * where sigma, the standard deviation of one residual, is estimated from the residuals; or, of
 * several views, from how these differ (least_squares.h).
 */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_ESTIMATE_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_ESTIMATE_H

#include <stdbool.h>
#include <stdio.h>

#define PARAMETER_NAME_MAX 32

struct parameter {
	char name[PARAMETER_NAME_MAX]; /* "focal", "translation z", "view 3 rotation x" */
	char unit[8];		       /* empty: a pure number */
	double value;
	bool fixed; /* held at its value: its deviation is 0 or was assumed */
};

struct estimate {
	int count;
	struct parameter *parameter; /* [count] */
	/* [count][count], in units of the parameters; 0 for fixed ones without an assumed
	 * deviation */
	double *covariance;
	/* residuals: scalars; freedom: residuals less free parameters */
	int residuals, freedom;
	double sigma; /* standard deviation of one residual, px */
};

/* Creates an estimate whose values are all 0. -ENOMEM. */
int estimate_create(struct estimate *estimate, int count);
void estimate_free(struct estimate *estimate); /* idempotent; zeroed is fine */

/* Returns the index of a parameter, or -1. */
int estimate_find(const struct estimate *estimate, const char *name);

double estimate_deviation(const struct estimate *estimate, int index);

/* Prints "focal = 1234.5 +- 1.2 px" as a line that begins with before; or that it is held, or not
 * known. */
void estimate_print(FILE *to, const char *before, const struct estimate *estimate, int index);

/* Returns -1..1; 0 where one of them is fixed, NaN where one is not known at all. */
double estimate_correlation(const struct estimate *estimate, int a, int b);

#endif
