/* SPDX-License-Identifier: MIT */
/*
 * What was estimated, and how well it is known: parameters with their covariance.
 *
 * Deviations are of one estimate, to first order: covariance = sigma^2 (J^T W J)^-1, sigma being
 * what the residuals themselves show (sum of weighted squares over the degrees of freedom).
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
	bool fixed; /* held at its value: no deviation, or one that was assumed */
};

struct estimate {
	int count;
	struct parameter *parameter; /* [count] */
	double *covariance;	     /* [count][count], in units of the parameters; 0 for fixed, but
				for what was assumed of them */
	int residuals, freedom;	     /* single numbers; residuals less free parameters */
	double sigma;		     /* standard deviation of one residual, px */
};

/* -ENOMEM. All zero. */
int estimate_create(struct estimate *estimate, int count);
void estimate_free(struct estimate *estimate); /* idempotent; zeroed is fine */

/* Index of a parameter, or -1. */
int estimate_find(const struct estimate *estimate, const char *name);

double estimate_deviation(const struct estimate *estimate, int index);

/* "focal = 1234.5 +- 1.2 px" as a line after this; or that it was held, or is not known. */
void estimate_print(FILE *to, const char *before, const struct estimate *estimate, int index);

/* -1..1; 0 where one of them is fixed, NaN where one is not known at all. */
double estimate_correlation(const struct estimate *estimate, int a, int b);

/*
 * Variance of a function of the parameters from its gradient[count] at the estimate: g^T C g. Not
 * finite where it depends on a parameter that is not known at all.
 */
double estimate_variance(const struct estimate *estimate, const double *gradient);

#endif
