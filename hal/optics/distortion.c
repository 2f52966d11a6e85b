/* SPDX-License-Identifier: MIT */
#include "hal/optics/tsai.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdbool.h>

#define CUBIC 4		/* coefficients of a cubic, the constant first */
#define HALVINGS 1100	/* enough for all exponents of a double */
#define NEWTON_STEPS 50 /* a good start takes 5 */
#define SHORTER 40	/* times a step is halved */

static double cubic_at(const double c[CUBIC], double s)
{
	return c[0] + s * (c[1] + s * (c[2] + s * c[3]));
}

/* Root between low, where the cubic is positive, and high, where it is not. */
static double cubic_root_between(const double c[CUBIC], double low, double high)
{
	for (int k = 0; k < HALVINGS; k++) {
		const double middle = low + (high - low) / 2;

		if (!(middle > low && middle < high))
			break;
		if (cubic_at(c, middle) > 0)
			low = middle;
		else
			high = middle;
	}
	return low;
}

/* Smallest s > 0 where a cubic, which is c[0] > 0 at 0, is no longer positive; infinite: none. It
 * is monotonic between the roots of its derivative. */
static double cubic_first_root(const double c[CUBIC])
{
	const double a = 3 * c[3], b = c[2], square = b * b - a * c[1];
	double turn[2] = {0, 0}, low = 0, high;

	if (!(c[0] > 0) || !isfinite(square))
		return 0;
	if (c[1] >= 0 && c[2] >= 0 && c[3] >= 0)
		return INFINITY;
	if (c[2] == 0 && c[3] == 0)
		return -c[0] / c[1];
	if (square >= 0) { /* roots of c1 + 2 b s + a s^2, without cancellation */
		const double q = -(b + copysign(sqrt(square), b));
		const double one = q != 0 ? c[1] / q : 0, other = a != 0 ? q / a : 0;

		turn[0] = fmin(one, other);
		turn[1] = fmax(one, other);
	}
	for (int k = 0; k < 2; k++) {
		if (!(turn[k] > low) || !isfinite(turn[k]))
			continue;
		if (!(cubic_at(c, turn[k]) > 0))
			return cubic_root_between(c, low, turn[k]);
		low = turn[k];
	}
	if (c[3] > 0 || (c[3] == 0 && c[2] >= 0))
		return INFINITY;
	for (high = low > 0 ? 2 * low : 1; cubic_at(c, high) > 0 && high < DBL_MAX / 2;)
		high *= 2;
	return cubic_root_between(c, low, high);
}

/*
 * The Jacobian's eigenvalues are at least
 *     min(R, g') - 6 |q| r,   R = 1 + k1 r^2 + ...,   g' = d/dr r R
 * With 2 r <= r^2 / reach + reach this is positive where two cubics of r^2 are. Without q only the
 * second is needed, because R is the mean of g' from 0 to r.
 */
double distortion_fold(const struct distortion *d)
{
	const double *k = d->radial, q = 3 * hypot(d->tangential[0], d->tangential[1]);
	const double least = q > 0 ? 1 - q * d->reach : 1, steep = q > 0 ? q / d->reach : 0;
	const double slope[CUBIC] = {least, 3 * k[0] - steep, 5 * k[1], 7 * k[2]};
	const double factor[CUBIC] = {least, k[0] - steep, k[1], k[2]};
	const double square = cubic_first_root(slope);

	return sqrt(q > 0 ? fmin(square, cubic_first_root(factor)) : square);
}

/* r R, and its derivative by r. */
static double radial_bend(const struct distortion *d, double r, double *slope)
{
	const double *k = d->radial, s = r * r;

	*slope = 1 + s * (3 * k[0] + s * (5 * k[1] + s * 7 * k[2]));
	return r * (1 + s * (k[0] + s * (k[1] + s * k[2])));
}

double distortion_covers(const struct distortion *d)
{
	const double fold = distortion_fold(d);
	double slope;

	if (isinf(fold))
		return INFINITY;
	return fmax(0, radial_bend(d, fold, &slope) -
			       3 * hypot(d->tangential[0], d->tangential[1]) * fold * fold);
}

/* F and its Jacobian, wherever. */
static void bend_anywhere(const struct distortion *d, const double p[2], double bent[2],
			  double slope[3])
{
	const double *k = d->radial, *q = d->tangential;
	const double s = p[0] * p[0] + p[1] * p[1], along = q[0] * p[0] + q[1] * p[1];
	const double factor = 1 + s * (k[0] + s * (k[1] + s * k[2]));
	const double by_square = k[0] + s * (2 * k[1] + s * 3 * k[2]);

	for (int i = 0; i < 2; i++)
		bent[i] = p[i] * factor + q[i] * s + 2 * p[i] * along;
	slope[0] = factor + 2 * by_square * p[0] * p[0] + 4 * q[0] * p[0] + 2 * along;
	slope[1] = 2 * by_square * p[0] * p[1] + 2 * (q[0] * p[1] + q[1] * p[0]);
	slope[2] = factor + 2 * by_square * p[1] * p[1] + 4 * q[1] * p[1] + 2 * along;
}

int distortion_bend(const struct distortion *d, const double straight[2], double bent[2],
		    double slope[3])
{
	double own[3];

	if (!(hypot(straight[0], straight[1]) <= distortion_fold(d)))
		return -ERANGE;
	bend_anywhere(d, straight, bent, slope ? slope : own);
	return isfinite(bent[0]) && isfinite(bent[1]) ? 0 : -ERANGE;
}

/* Solves r R = bent for r up to the fold by Newton's method inside of a bracket. */
static int radial_straighten(const struct distortion *d, double bent, double fold, double *straight)
{
	double low = 0, high = fold, r, slope;

	if (isinf(fold))
		for (high = bent; radial_bend(d, high, &slope) < bent; high *= 2)
			;
	if (!(radial_bend(d, high, &slope) >= bent))
		return -ERANGE;
	r = fmin(bent, high);
	for (int step = 0; step < HALVINGS && high > low; step++) {
		const double over = radial_bend(d, r, &slope) - bent;
		double next = r - over / slope;

		if (over > 0)
			high = r;
		else
			low = r;
		if (fabs(next - r) <= DBL_EPSILON * r)
			break;
		if (!(next > low && next < high))
			next = low + (high - low) / 2;
		if (next == r)
			break;
		r = next;
	}
	*straight = r;
	return 0;
}

static double distance(const double a[2], const double b[2])
{
	return hypot(a[0] - b[0], a[1] - b[1]);
}

/* Newton's method with shortened steps, which stays inside of the fold. */
static int plane_straighten(const struct distortion *d, const double bent[2], double fold,
			    double p[2])
{
	double here[2], slope[3], left;

	bend_anywhere(d, p, here, slope);
	left = distance(here, bent);
	for (int step = 0; step < NEWTON_STEPS && left > 0; step++) {
		const double determinant = slope[0] * slope[2] - slope[1] * slope[1];
		const double x = bent[0] - here[0], y = bent[1] - here[1];
		const double by[2] = {(slope[2] * x - slope[1] * y) / determinant,
				      (slope[0] * y - slope[1] * x) / determinant};
		double share = 1;
		bool closer = false;

		for (int k = 0; k < SHORTER && !closer; k++, share /= 2) {
			const double next[2] = {p[0] + share * by[0], p[1] + share * by[1]};
			double there[2], next_slope[3];

			bend_anywhere(d, next, there, next_slope);
			closer = hypot(next[0], next[1]) <= fold && distance(there, bent) < left;
			if (!closer)
				continue;
			left = distance(there, bent);
			for (int i = 0; i < 2; i++) {
				p[i] = next[i];
				here[i] = there[i];
			}
			for (int i = 0; i < 3; i++)
				slope[i] = next_slope[i];
		}
		if (!closer)
			break;
	}
	return left <= 1e-12 * hypot(bent[0], bent[1]) ? 0 : -ERANGE;
}

int distortion_straighten(const struct distortion *d, const double bent[2], double straight[2])
{
	const double fold = distortion_fold(d), radius = hypot(bent[0], bent[1]);
	const bool turns = d->tangential[0] != 0 || d->tangential[1] != 0;
	double r = 0;

	if (!isfinite(radius))
		return -ERANGE;
	/* the start with tangential terms may lie on the rim */
	if (radius > 0 && radial_straighten(d, radius, fold, &r)) {
		if (!turns || !(fold > 0))
			return -ERANGE;
		r = fold;
	}
	for (int i = 0; i < 2; i++)
		straight[i] = radius > 0 ? bent[i] * (r / radius) : 0;
	return turns ? plane_straighten(d, bent, fold, straight) : 0;
}
