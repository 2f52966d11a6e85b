/* SPDX-License-Identifier: MIT */
/*
 * First guesses in closed form from one view.
 *
 * Sensor coordinates are relative to the axis, x right, y down. Places are relative to an origin
 * among the points. The result maps places to camera axes; every point has positive depth.
 */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_TSAI_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_TSAI_H

struct first_guess {
	double rotation[9], translation[3];
	double focal;
	double aspect;
};

/*
 * Tsai's first stage for points in the plane z = 0 (Tsai 1987, II.D): five unknowns from the radial
 * alignment, which no radial distortion changes; then f and Tz by least squares without distortion.
 * For the computation the origin is moved to the point seen farthest from the x axis, where Ty
 * cannot be 0. focal: known f, or 0. -ERANGE: the points are on a line, or f and Tz cannot be told
 * apart; -ENOMEM.
 */
int tsai_coplanar(int count, const double (*plane)[2], const double (*sensor)[2], double focal,
		  struct first_guess *guess);

/*
 * The same for points in space (Tsai 1987, II.E): seven unknowns, s included. -EDOM: f or Tz is
 * negative, as for a mirrored world, or by noise for one that is far away.
 */
int tsai_spatial(int count, const double (*place)[3], const double (*sensor)[2], double focal,
		 struct first_guess *guess);

/*
 * Homography from plane to sensor, h[9] in rows, of unit length:
 *     sensor = h (x, y, 1)
 * -ERANGE: it is not unique; -ENOMEM.
 */
int homography_find(int count, const double (*plane)[2], const double (*sensor)[2], double h[9]);

/* Computes f from homographies of several boards, for known axis and s (Zhang 2000, 3.1). -ERANGE:
 * the boards are parallel to the picture, or to each other. */
int homography_focal(int count, const double (*h)[9], double *focal);

/* Computes rotation and translation of a plane from its homography. */
void homography_pose(const double h[9], double focal, struct first_guess *guess);

#endif
