/* SPDX-License-Identifier: MIT */
/* Rotations as vectors: the axis times the angle, rad. Matrices are in rows. */
#ifndef INLAY_BAKE_CALIBRATE_ESTIMATE_ROTATION_H
#define INLAY_BAKE_CALIBRATE_ESTIMATE_ROTATION_H

/* R = exp([vector]x), and its derivatives by the components of the vector. */
void rotation_from_vector(const double vector[3], double rotation[9], double slope[3][9]);

/* The rotation vector of a matrix, of length 0..pi. */
void rotation_to_vector(const double rotation[9], double vector[3]);

#endif
