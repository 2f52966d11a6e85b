/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/camera/camera_tsai.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/estimate/linear.h"
#include "hal/optics/vec.h"

/* Replaces rows 1 and 2, which are nearly orthonormal, by the nearest orthonormal pair, and row 3
 * by their cross product. */
static void square_up(double r[9])
{
	double sum[3], difference[3];

	vec_normalize(r);
	vec_normalize(r + 3);
	for (int i = 0; i < 3; i++) {
		sum[i] = r[i] + r[3 + i];
		difference[i] = r[i] - r[3 + i];
	}
	vec_normalize(sum);
	vec_normalize(difference);
	for (int i = 0; i < 3; i++) {
		r[i] = (sum[i] + difference[i]) * M_SQRT1_2;
		r[3 + i] = (sum[i] - difference[i]) * M_SQRT1_2;
	}
	vec_cross(r, r + 3, r + 6);
}

/* Index of the point seen farthest from the x axis. */
static int farthest_from_x(int count, const double (*sensor)[2])
{
	int at = 0;

	for (int i = 1; i < count; i++)
		if (fabs(sensor[i][1]) > fabs(sensor[at][1]))
			at = i;
	return at;
}

/* turned = R (place - origin) */
static void turn_place(const struct first_guess *guess, const double place[3],
		       const double origin[3], double turned[3])
{
	double from[3];

	for (int k = 0; k < 3; k++)
		from[k] = place[k] - origin[k];
	mat_apply(guess->rotation, from, turned);
}

/*
 * Solves for f and Tz by least squares from
 *     f y = (w + Tz) Y,   f x = (w + Tz) X
 * where (x, y, w) is a place after rotation, with Tx and Ty added. Returns how well f and Tz can be
 * told apart (see linear_solve()), 0: not at all.
 */
static double focal_and_depth(int count, const double (*place)[3], int of,
			      const double (*sensor)[2], double *a, struct first_guess *guess)
{
	double x[2], apart;

	for (int i = 0; i < count; i++) {
		double p[3];

		turn_place(guess, place[i], place[of], p);
		for (int k = 0; k < 2; k++) {
			const double seen = sensor[i][k] / (k ? 1 : guess->aspect);
			const int row = 2 * i + k;

			a[row] = p[k] + guess->translation[k];
			a[2 * count + row] = -seen;
			a[4 * count + row] = p[2] * seen;
		}
	}
	apart = linear_solve(a, 2 * count, 2, x);
	guess->focal = x[0];
	guess->translation[2] = x[1];
	return apart;
}

/* Solves the same equations for Tz alone; returns the remaining sum of squares. */
static double depth_alone(int count, const double (*place)[3], int of, const double (*sensor)[2],
			  struct first_guess *guess)
{
	double above = 0, below = 0, all = 0;

	for (int i = 0; i < count; i++) {
		double p[3];

		turn_place(guess, place[i], place[of], p);
		for (int k = 0; k < 2; k++) {
			const double seen = sensor[i][k] / (k ? 1 : guess->aspect);
			const double is = guess->focal * (p[k] + guess->translation[k]) -
					  p[2] * seen;

			above += seen * is;
			below += seen * seen;
			all += is * is;
		}
	}
	guess->translation[2] = below > 0 ? above / below : 0;
	return all - above * guess->translation[2];
}

/* Moves the origin back from place `of` to 0. */
static void move_back(const double of[3], struct first_guess *guess)
{
	double back[3];

	mat_apply(guess->rotation, of, back);
	for (int k = 0; k < 3; k++)
		guess->translation[k] -= back[k];
}

/* Whether the sign of Ty is wrong: both fit, but with the right one points lie on the side on which
 * they are seen. */
static bool wrong_side(int count, const double (*place)[3], int of, const double (*sensor)[2],
		       const struct first_guess *guess)
{
	double votes = 0;

	for (int i = 0; i < count; i++) {
		double p[3];

		turn_place(guess, place[i], place[of], p);
		for (int k = 0; k < 2; k++)
			votes += (p[k] + guess->translation[k]) * sensor[i][k];
	}
	return votes < 0;
}

/*
 * Computes rows 1 and 2 of R, Tx and Ty from the five numbers; |Ty| is the smaller root of
 *     d^2 Ty^4 - u Ty^2 + 1 = 0
 */
static void rows_of_plane(const double x[5], double sign, struct first_guess *guess)
{
	const double u = x[0] * x[0] + x[1] * x[1] + x[3] * x[3] + x[4] * x[4];
	const double d = x[0] * x[4] - x[1] * x[3];
	const double ty = sign * sqrt(2 / (u + sqrt(fmax(0, u * u - 4 * d * d))));
	double *r = guess->rotation;

	r[0] = x[0] * ty;
	r[1] = x[1] * ty;
	r[3] = x[3] * ty;
	r[4] = x[4] * ty;
	r[2] = sqrt(fmax(0, 1 - r[0] * r[0] - r[1] * r[1]));
	r[5] = sqrt(fmax(0, 1 - r[3] * r[3] - r[4] * r[4]));
	if (r[0] * r[3] + r[1] * r[4] > 0)
		r[5] = -r[5];
	square_up(r);
	guess->translation[0] = x[2] * ty;
	guess->translation[1] = ty;
}

/* Replaces R by the other rotation with the same upper left 2 x 2 block. */
static void tilt_back(double r[9])
{
	r[2] = -r[2];
	r[5] = -r[5];
	r[6] = -r[6];
	r[7] = -r[7];
}

/*
 * Solves for the five unknowns (r1, r2, Tx, r4, r5) / Ty, from one equation for each point:
 *     Y (r1 x + r2 y + Tx) = X (r4 x + r5 y + Ty)
 * The noise of an equation grows with the point's distance from the axis. Further passes know that
 * distance and divide by it: otherwise far points would count most, and the choice of the origin
 * would matter.
 */
static double align_plane(int count, const double (*place)[3], int of, const double (*sensor)[2],
			  double *a, double x[5])
{
	double apart = 0;

	for (int pass = 0; pass < 3; pass++) {
		for (int i = 0; i < count; i++) {
			const double px = place[i][0] - place[of][0];
			const double py = place[i][1] - place[of][1];
			const double across = pass ? hypot(px * x[0] + py * x[1] + x[2],
							   px * x[3] + py * x[4] + 1)
						   : 1;
			const double row[6] = {sensor[i][1] * px,  sensor[i][1] * py,
					       sensor[i][1],	   -sensor[i][0] * px,
					       -sensor[i][0] * py, sensor[i][0]};

			for (int k = 0; k < 6; k++)
				a[k * count + i] = across > 0 ? row[k] / across : 0;
		}
		apart = linear_solve(a, count, 5, x);
	}
	return apart;
}

/* For known f, keeps the tilt that leaves the smaller sum of squares. */
static void choose_side(int count, const double (*place)[3], int of, const double (*sensor)[2],
			struct first_guess *guess)
{
	const double left = depth_alone(count, place, of, sensor, guess);
	const struct first_guess first = *guess;

	tilt_back(guess->rotation);
	if (depth_alone(count, place, of, sensor, guess) > left)
		*guess = first;
}

static int solve_plane(int count, const double (*place)[3], const double (*sensor)[2], double focal,
		       double *a, struct first_guess *guess)
{
	const int of = farthest_from_x(count, sensor);
	double x[5], apart = 1;

	if (align_plane(count, place, of, sensor, a, x) < 1e-9)
		return -ERANGE;
	guess->aspect = 1;
	rows_of_plane(x, 1, guess);
	if (wrong_side(count, place, of, sensor, guess))
		rows_of_plane(x, -1, guess);
	if (focal > 0) {
		guess->focal = focal;
		choose_side(count, place, of, sensor, guess);
	} else {
		apart = focal_and_depth(count, place, of, sensor, a, guess);
		if (guess->focal < 0 || guess->translation[2] < 0) {
			tilt_back(guess->rotation);
			apart = focal_and_depth(count, place, of, sensor, a, guess);
		}
	}
	if (!(guess->focal > 0) || !(guess->translation[2] > 0) || apart < 1e-9)
		return -ERANGE;
	move_back(place[of], guess);
	return 0;
}

int tsai_coplanar(int count, const double (*plane)[2], const double (*sensor)[2], double focal,
		  struct first_guess *guess)
{
	const size_t n = (size_t)count;
	double *a = calloc(6 * n, sizeof(*a)), (*place)[3] = calloc(n, sizeof(*place));
	int err = -ENOMEM;

	if (a && place) {
		for (int i = 0; i < count; i++)
			memcpy(place[i], plane[i], sizeof(plane[i]));
		err = count < 5 ? -ERANGE : solve_plane(count, place, sensor, focal, a, guess);
	}
	free(a);
	free(place);
	return err;
}

/* Computes rows 1 and 2 of R, s, Tx and Ty from the seven numbers. */
static void rows_of_space(const double x[7], double sign, struct first_guess *guess)
{
	const double ty = sign / vec_length(x + 4);
	double *r = guess->rotation;

	guess->aspect = vec_length(x) * fabs(ty);
	for (int k = 0; k < 3; k++) {
		r[k] = x[k] * ty / guess->aspect;
		r[3 + k] = x[4 + k] * ty;
	}
	square_up(r);
	guess->translation[0] = x[3] * ty / guess->aspect;
	guess->translation[1] = ty;
}

static int solve_space(int count, const double (*place)[3], const double (*sensor)[2], double focal,
		       double *a, struct first_guess *guess)
{
	const int of = farthest_from_x(count, sensor);
	double x[7];

	for (int i = 0; i < count; i++)
		for (int k = 0; k < 4; k++) {
			const double p = k < 3 ? place[i][k] - place[of][k] : 1;

			a[k * count + i] = sensor[i][1] * p;
			a[(4 + k) * count + i] = -sensor[i][0] * p;
		}
	for (int i = 0; i < count; i++) /* the last column is b */
		a[7 * count + i] = -a[7 * count + i];
	if (linear_solve(a, count, 7, x) < 1e-9 || !(vec_length(x) > 0) || !(vec_length(x + 4) > 0))
		return -ERANGE;
	rows_of_space(x, 1, guess);
	if (wrong_side(count, place, of, sensor, guess))
		rows_of_space(x, -1, guess);
	guess->focal = focal;
	if (focal > 0)
		depth_alone(count, place, of, sensor, guess);
	else if (focal_and_depth(count, place, of, sensor, a, guess) < 1e-9)
		return -ERANGE;
	if (!(guess->focal > 0) || !(guess->translation[2] > 0))
		return -EDOM;
	move_back(place[of], guess);
	return 0;
}

int tsai_spatial(int count, const double (*place)[3], const double (*sensor)[2], double focal,
		 struct first_guess *guess)
{
	double *a = calloc(8 * (size_t)count, sizeof(*a));
	int err;

	if (!a)
		return -ENOMEM;
	err = count < 7 ? -ERANGE : solve_space(count, place, sensor, focal, a, guess);
	free(a);
	return err;
}

/* Computes the mean of the points and the mean distance from it, to scale numbers to about 1. */
static void normalize_points(int count, const double (*point)[2], double middle[2], double *size)
{
	middle[0] = middle[1] = *size = 0;
	for (int i = 0; i < count; i++)
		for (int k = 0; k < 2; k++)
			middle[k] += point[i][k] / count;
	for (int i = 0; i < count; i++)
		*size += hypot(point[i][0] - middle[0], point[i][1] - middle[1]) / count;
	if (!(*size > 0))
		*size = 1;
}

int homography_find(int count, const double (*plane)[2], const double (*sensor)[2], double h[9])
{
	const int rows = count > 4 ? 2 * count : 9;
	double *a = calloc(9 * (size_t)rows, sizeof(*a));
	double from[2], from_size, to[2], to_size, x[9], length = 0, unique;

	if (!a)
		return -ENOMEM;
	normalize_points(count, plane, from, &from_size);
	normalize_points(count, sensor, to, &to_size);
	for (int i = 0; i < count; i++)
		for (int k = 0; k < 2; k++) {
			const double seen = (sensor[i][k] - to[k]) / to_size;
			const double p[3] = {(plane[i][0] - from[0]) / from_size,
					     (plane[i][1] - from[1]) / from_size, 1};

			for (int j = 0; j < 3; j++) {
				a[(3 * k + j) * rows + 2 * i + k] = p[j];
				a[(6 + j) * rows + 2 * i + k] = -seen * p[j];
			}
		}
	unique = linear_null(a, rows, 9, x);
	free(a);
	for (int j = 0; j < 3; j++) {
		x[j] = x[j] * to_size + to[0] * x[6 + j];
		x[3 + j] = x[3 + j] * to_size + to[1] * x[6 + j];
	}
	for (int i = 0; i < 3; i++) {
		h[3 * i] = x[3 * i] / from_size;
		h[3 * i + 1] = x[3 * i + 1] / from_size;
		h[3 * i + 2] = x[3 * i + 2] - h[3 * i] * from[0] - h[3 * i + 1] * from[1];
	}
	for (int i = 0; i < 9; i++)
		length += h[i] * h[i];
	for (int i = 0; i < 9; i++)
		h[i] /= sqrt(length);
	return unique > 1e-9 ? 0 : -ERANGE;
}

/* The first two columns, divided by (f, f, 1), are orthogonal and of equal length: two equations in
 * 1 / f^2 for each homography, weighted so that the units of plane and sensor do not matter. */
int homography_focal(int count, const double (*h)[9], double *focal)
{
	double numerator = 0, denominator = 0, largest = 0, inverse;

	for (int k = 0; k < count; k++) {
		const double *m = h[k];
		const double size = m[0] * m[0] + m[3] * m[3] + m[1] * m[1] + m[4] * m[4];
		const double by[2] = {(m[0] * m[1] + m[3] * m[4]) / size,
				      (m[0] * m[0] + m[3] * m[3] - m[1] * m[1] - m[4] * m[4]) /
					      size};
		const double is[2] = {m[6] * m[7] / size, (m[6] * m[6] - m[7] * m[7]) / size};

		for (int i = 0; i < 2; i++) {
			numerator -= by[i] * is[i];
			denominator += by[i] * by[i];
			largest = fmax(largest, fabs(by[i]));
		}
	}
	if (largest < 1e-6)
		return -ERANGE;
	inverse = numerator / denominator;
	if (!(inverse > 0))
		return -ERANGE;
	*focal = sqrt(1 / inverse);
	return isfinite(*focal) ? 0 : -ERANGE;
}

void homography_pose(const double h[9], double focal, struct first_guess *guess)
{
	double columns[9], size;

	*guess = (struct first_guess){.focal = focal, .aspect = 1};
	for (int k = 0; k < 3; k++) { /* a column of h becomes a row of columns */
		columns[3 * k] = h[k] / focal;
		columns[3 * k + 1] = h[3 + k] / focal;
		columns[3 * k + 2] = h[6 + k];
	}
	size = (vec_length(columns) + vec_length(columns + 3)) / 2;
	if (columns[8] < 0)
		size = -size;
	for (int k = 0; k < 9; k++)
		columns[k] /= size;
	memcpy(guess->translation, columns + 6, sizeof(guess->translation));
	square_up(columns);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			guess->rotation[3 * i + j] = columns[3 * j + i];
}
