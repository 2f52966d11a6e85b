/* SPDX-License-Identifier: MIT */
/*
 * First guesses in closed form from one view.
 *
 * Sensor coordinates are from the axis, x right, y down. Places are relative to an origin among the
 * points. What comes out maps places to camera axes; the depth of every point is positive.
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
 * alignment, which no radial distortion changes; then f and Tz by least squares, distortion left
 * out. The origin is moved to the point seen farthest from the x axis, where Ty cannot be 0, and
 * back. focal: 0, or what f is known to be. -ERANGE: the points are on a line, or f and Tz cannot
 * be told apart; -ENOMEM.
 */
int tsai_coplanar(int count, const double (*plane)[2], const double (*sensor)[2], double focal,
		  struct first_guess *guess);

/*
 * The same for points in space (Tsai 1987, II.E): seven unknowns, s found too. -EDOM: f or Tz comes
 * out negative, as it does for a world that is mirrored, and by noise for one that is far away.
 */
int tsai_spatial(int count, const double (*place)[3], const double (*sensor)[2], double focal,
		 struct first_guess *guess);

/*
 * Plane to sensor: h[9] in rows, sensor = h (x, y, 1), of unit length. -ERANGE: more than one map
 * does it; -ENOMEM.
 */
int homography_find(int count, const double (*plane)[2], const double (*sensor)[2], double h[9]);

/* f from homographies of several boards, the axis and s being known (Zhang 2000, 3.1). -ERANGE:
 * they are parallel to the picture, or to each other. */
int homography_focal(int count, const double (*h)[9], double *focal);

/* Rotation and translation of a plane from its homography. */
void homography_pose(const double h[9], double focal, struct first_guess *guess);

#endif
