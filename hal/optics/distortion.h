/* SPDX-License-Identifier: MIT */
/*
 * A radial polynomial with tangential terms, which bends points of the sensor:
 *
 *     F(p) = p (1 + k1 r^2 + k2 r^4 + k3 r^6) + q r^2 + 2 p (q . p),   r = |p|
 *
 * OpenCV's k1, k2, k3 and (p2, p1), in units of the focal length, are these k and q. F is the
 * gradient of a potential, so that its Jacobian is symmetric. Inside of a circle around the axis,
 * where the Jacobian is positive definite, F is one-to-one (the potential is convex there); nothing
 * beyond it is bent or comes out of the inverse. Without q the circle is exact: its radius is the
 * fold, the smallest r with
 *     d/dr r (1 + k1 r^2 + ...) = 0
 * With q it is a little smaller (hal/optics/README.md).
 */
#ifndef INLAY_HAL_OPTICS_DISTORTION_H
#define INLAY_HAL_OPTICS_DISTORTION_H

#define DISTORTION_RADIAL 3

struct distortion {
	double radial[DISTORTION_RADIAL]; /* k, 1/mm^2, 1/mm^4, 1/mm^6 */
	double tangential[2];		  /* q, 1/mm */
	double reach; /* radius of the picture, mm, for which the circle is largest; above 0 */
};

/* Radius of the circle inside of which F is one-to-one; infinite: everywhere; 0: nowhere. */
double distortion_fold(const struct distortion *d);

/* Radius of the circle that F makes the circle cover: each point inside of it has one inverse. */
double distortion_covers(const struct distortion *d);

/* bent = F(straight); slope: its Jacobian xx, xy, yy, or NULL. 0; -ERANGE: beyond the fold. */
int distortion_bend(const struct distortion *d, const double straight[2], double bent[2],
		    double slope[3]);

/* Solves F(straight) = bent inside of the circle. 0; -ERANGE: no solution. */
int distortion_straighten(const struct distortion *d, const double bent[2], double straight[2]);

#endif
