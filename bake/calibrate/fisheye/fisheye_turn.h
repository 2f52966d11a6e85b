/* SPDX-License-Identifier: MIT */
/* Rotations of a fisheye as estimation needs them: small turns, and how a matrix follows from them.
 * Matrices are in rows. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_TURN_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_TURN_H

/* exp([w]x): the turn about w by its length, rad (Rodrigues). */
void turn_matrix(const double w[3], double rotation[9]);

/* The left Jacobian of SO(3): exp([w + dw]x) = exp([J dw]x) exp([w]x) to first order. */
void turn_jacobian(const double w[3], double jacobian[9]);

void turn_multiply(const double a[9], const double b[9], double product[9]);

/* The inverse of fisheye_rotation(): about X, then Y, then Z, degrees; the turn about Y is in
 * -90..90. Where that is at its end, the turn about X is 0. */
void turn_degrees(const double rotation[9], double deg[3]);

/* The rotation that takes world[] nearest to camera[], both unit vectors (Wahba's problem by
 * singular values; Markley 1988). Returns the sum of squared distances left. mirrored, which may be
 * NULL: the same if a reflection were allowed as well. */
double turn_between(const double (*world)[3], const double (*camera)[3], int count,
		    double rotation[9], double *mirrored);

#endif
