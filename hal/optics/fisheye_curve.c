/* SPDX-License-Identifier: MIT */
#include "hal/optics/fisheye.h"

#include <math.h>
#include <stddef.h>

#define DEGREE_MAX 4 /* of polynomials in roots_of() */

const char *const fisheye_model_names[] = {"equidistant",  "equisolid",	 "stereographic",
					   "orthographic", "polynomial", NULL};

double fisheye_curve_radius(const struct fisheye_curve *curve, double theta)
{
	const double *k = curve->k, u = theta * theta;

	switch (curve->model) {
	case FISHEYE_EQUISOLID:
		return 2 * sin(theta / 2);
	case FISHEYE_STEREOGRAPHIC:
		return 2 * tan(theta / 2);
	case FISHEYE_ORTHOGRAPHIC:
		return sin(theta);
	case FISHEYE_POLYNOMIAL:
		return theta * (1 + u * (k[0] + u * (k[1] + u * (k[2] + u * k[3]))));
	default:
		return theta;
	}
}

double fisheye_curve_slope(const struct fisheye_curve *curve, double theta)
{
	const double *k = curve->k, u = theta * theta, c = cos(theta / 2);

	switch (curve->model) {
	case FISHEYE_EQUISOLID:
		return c;
	case FISHEYE_STEREOGRAPHIC:
		return 1 / (c * c);
	case FISHEYE_ORTHOGRAPHIC:
		return cos(theta);
	case FISHEYE_POLYNOMIAL:
		return 1 + u * (3 * k[0] + u * (5 * k[1] + u * (7 * k[2] + u * 9 * k[3])));
	default:
		return 1;
	}
}

/* Newton's method, with bisection where a step would leave the bracket of the root. */
static double polynomial_angle(const struct fisheye_curve *curve, double radius, double most)
{
	double low = 0, high = most, theta = fmin(radius, most);

	if (!(radius > 0))
		return 0;
	if (!(radius < fisheye_curve_radius(curve, most)))
		return most;
	for (int i = 0; i < 100; i++) {
		const double over = fisheye_curve_radius(curve, theta) - radius;
		double next = theta - over / fisheye_curve_slope(curve, theta);

		if (over > 0)
			high = theta;
		else
			low = theta;
		if (!(next >= low && next <= high))
			next = (low + high) / 2;
		if (!(fabs(next - theta) > 4e-16 * theta))
			return next;
		theta = next;
	}
	return theta;
}

double fisheye_curve_angle(const struct fisheye_curve *curve, double radius, double most)
{
	double theta = radius;

	switch (curve->model) {
	case FISHEYE_EQUISOLID:
		theta = 2 * asin(fmin(radius / 2, 1));
		break;
	case FISHEYE_STEREOGRAPHIC:
		theta = 2 * atan(radius / 2);
		break;
	case FISHEYE_ORTHOGRAPHIC:
		theta = asin(fmin(radius, 1));
		break;
	case FISHEYE_POLYNOMIAL:
		return polynomial_angle(curve, radius, most);
	default:
		break;
	}
	return fmin(theta, most);
}

double fisheye_curve_patch_sr(const struct fisheye_curve *curve, double theta, double sine)
{
	const double sinc = theta > 1e-8 ? sine / theta : 1;
	const double *k = curve->k, u = theta * theta, c = cos(theta / 2);

	switch (curve->model) {
	case FISHEYE_EQUISOLID:
		return 1;
	case FISHEYE_STEREOGRAPHIC:
		return c * c * c * c;
	case FISHEYE_ORTHOGRAPHIC:
		return 1 / cos(theta);
	case FISHEYE_POLYNOMIAL:
		return sinc / ((1 + u * (k[0] + u * (k[1] + u * (k[2] + u * k[3])))) *
			       fisheye_curve_slope(curve, theta));
	default:
		return sinc;
	}
}

static double polynomial_value(const double *c, int degree, double x)
{
	double value = c[degree];

	while (degree-- > 0)
		value = value * x + c[degree];
	return value;
}

/* Bisection between two places without an extremum between them, where the sign changes. */
static double root_between(const double *c, int degree, double low, double high)
{
	const double at_low = polynomial_value(c, degree, low);

	for (int i = 0; i < 200 && high - low > 1e-16 * high; i++) {
		const double middle = (low + high) / 2;

		if ((polynomial_value(c, degree, middle) > 0) == (at_low > 0))
			low = middle;
		else
			high = middle;
	}
	return high;
}

/* Finds all roots in 0..most, in ascending order: one between two successive extrema, which are
 * roots of the derivative. Returns their number. */
static int roots_of(const double *c, int degree, double most, double *root)
{
	double derivative[DEGREE_MAX] = {0}, turn[DEGREE_MAX + 2] = {0};
	int turns, count = 0;

	if (degree < 1 || degree > DEGREE_MAX)
		return 0;
	for (int i = 0; i < degree; i++)
		derivative[i] = (i + 1) * c[i + 1];
	turns = roots_of(derivative, degree - 1, most, turn + 1);
	turn[turns + 1] = most;
	for (int i = 0; i <= turns; i++) {
		const double from = polynomial_value(c, degree, turn[i]);
		const double to = polynomial_value(c, degree, turn[i + 1]);

		if ((from > 0) == (to > 0))
			continue;
		root[count++] = root_between(c, degree, turn[i], turn[i + 1]);
	}
	return count;
}

double fisheye_first_root(const double *c, int degree, double most)
{
	double root[DEGREE_MAX + 1];

	return roots_of(c, degree, most, root) ? root[0] : INFINITY;
}

double fisheye_curve_fold(const struct fisheye_curve *curve, double most)
{
	const double *k = curve->k;
	const double slope[5] = {1, 3 * k[0], 5 * k[1], 7 * k[2], 9 * k[3]}; /* in theta^2 */

	switch (curve->model) {
	case FISHEYE_STEREOGRAPHIC:
		return most >= M_PI ? M_PI : INFINITY;
	case FISHEYE_ORTHOGRAPHIC:
		/* Tolerance: a field of 90 degrees may be rounded up. */
		return most > M_PI / 2 + 1e-12 ? M_PI / 2 : INFINITY;
	case FISHEYE_POLYNOMIAL:
		return sqrt(fisheye_first_root(slope, 4, most * most));
	default:
		return INFINITY;
	}
}
