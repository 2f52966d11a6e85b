/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/estimate/estimate.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

int estimate_create(struct estimate *estimate, int count)
{
	const size_t n = (size_t)count;

	*estimate = (struct estimate){.count = count};
	/* calloc() of 0 bytes may return NULL */
	estimate->parameter = calloc(n + 1, sizeof(*estimate->parameter));
	estimate->covariance = calloc(n * n + 1, sizeof(*estimate->covariance));
	if (!estimate->parameter || !estimate->covariance) {
		estimate_free(estimate);
		return -ENOMEM;
	}
	return 0;
}

void estimate_free(struct estimate *estimate)
{
	free(estimate->parameter);
	free(estimate->covariance);
	*estimate = (struct estimate){0};
}

int estimate_find(const struct estimate *estimate, const char *name)
{
	for (int k = 0; k < estimate->count; k++)
		if (!strcmp(estimate->parameter[k].name, name))
			return k;
	return -1;
}

double estimate_deviation(const struct estimate *estimate, int index)
{
	return sqrt(estimate->covariance[index * estimate->count + index]);
}

double estimate_correlation(const struct estimate *estimate, int a, int b)
{
	const double both = estimate_deviation(estimate, a) * estimate_deviation(estimate, b);

	if (!isfinite(both))
		return NAN;
	return both > 0 ? estimate->covariance[a * estimate->count + b] / both : 0;
}

void estimate_print(FILE *to, const char *before, const struct estimate *estimate, int index)
{
	const struct parameter *p = &estimate->parameter[index];
	const double deviation = estimate_deviation(estimate, index);

	fprintf(to, "%s%s = %.10g", before, p->name, p->value);
	if (!isfinite(deviation))
		fputs(" (not known)", to);
	else if (!p->fixed || deviation > 0)
		fprintf(to, " +- %.3g", deviation);
	if (p->fixed)
		fputs(deviation > 0 ? " (held, assumed)" : " (held)", to);
	fprintf(to, "%s%s\n", p->unit[0] ? " " : "", p->unit);
}
