/* SPDX-License-Identifier: MIT */
/* Rotations for estimation: small turns with derivatives, Euler angles, and the best rotation
 * between directions. Matrices are in rows. */
#ifndef INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_TURN_H
#define INLAY_BAKE_CALIBRATE_FISHEYE_FISHEYE_TURN_H

/* Computes exp([w]x), the rotation about w by its length, rad (Rodrigues). */
void turn_matrix(const double w[3], double rotation[9]);

/* Computes the left Jacobian of SO(3): exp([w + dw]x) = exp([J dw]x) exp([w]x) to first order. */
void turn_jacobian(const double w[3], double jacobian[9]);

void turn_multiply(const double a[9], const double b[9], double product[9]);

/* The inverse of fisheye_rotation(): angles about X, then Y, then Z, degrees; the one about Y is in
 * -90..90. At +-90 the one about X is 0. */
void turn_degrees(const double rotation[9], double deg[3]);

/* Finds the rotation that takes world[] nearest to camera[], both unit vectors (Wahba's problem by
 * singular values; Markley 1988). Returns the sum of squared distances left. *mirrored, which may
 * be NULL, is the same with reflections allowed. */
double turn_between(const double (*world)[3], const double (*camera)[3], int count,
		    double rotation[9], double *mirrored);

#endif
