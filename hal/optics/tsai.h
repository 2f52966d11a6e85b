/* SPDX-License-Identifier: MIT */
/* A camera by Tsai, and its distortion. */
#ifndef INLAY_HAL_OPTICS_TSAI_H
#define INLAY_HAL_OPTICS_TSAI_H

#include "hal/base/fault.h"
#include "hal/ini/ini.h"

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

/*
 * Tsai's camera as in the thesis, equations 2.1 to 2.7.
 *
 *     Pc  = R Pw + T                              (2.1)
 *     Psu = f (Pc.x, Pc.y) / Pc.z                 (2.2, 2.3)
 *     Psd = Psu (1 + kappa1 |Psu|^2)              (2.4, 2.5), TSAI_DISTORTS
 *     X   = Cx + s Psd.x / Dx                     (2.6)   image x right
 *     Y   = Cy -   Psd.y / Dy                     (2.7)   image y up, origin lower left
 *
 * Tsai's own papers define the distortion in the other direction, TSAI_UNDISTORTS:
 *
 *     Psu = Psd (1 + kappa1 |Psd|^2)              (Tsai 1987, 5a, 5b)
 *
 * Neither is the inverse of the other: a kappa1 means nothing without its direction. Barrel
 * distortion has a negative kappa1 in the thesis's direction, a positive one in Tsai's.
 *
 * A lens that one kappa1 cannot describe has more terms, in either direction:
 *     1 + kappa1 r^2 + kappa2 r^4 + kappa3 r^6, and tangential terms (above)
 * In the thesis's direction these are OpenCV's k1 to k3, p1 and p2.
 *
 * Camera axes: x right, y down, z along the view. World units are the scene's; f, D in one sensor
 * unit (mm), kappa1 in 1/unit^2. Picture coordinates below are (x right, y down from the upper
 * edge), pixel centres at +0.5: y_down = height - Y.
 */

#define TSAI_SIDE_MAX 32768
#define TSAI_EDGE_SPREAD_MAX 8.0

enum tsai_distortion {
	TSAI_DISTORTS,	 /* the thesis: distorted from undistorted */
	TSAI_UNDISTORTS, /* Tsai: undistorted from distorted */
};

extern const char *const tsai_distortion_names[]; /* "distorts", "undistorts", NULL */

struct tsai_camera {
	int width, height;     /* of the picture, pixels */
	double rotation[9];    /* R, rows */
	double translation[3]; /* T */
	double focal;	       /* f */
	double kappa1;
	int distortion;	     /* enum tsai_distortion: what kappa1 and the others mean */
	double centre_px[2]; /* C, in image axes (x right, y up) */
	double pixel[2];     /* D */
	double aspect;	     /* s */
	/* The terms that most cameras have not, last: without them a scene's hash leaves them
	 * out. */
	double kappa2, kappa3;
	double tangential[2]; /* q */
	/* Sigma of the Gaussian with which the lens, and sharpening, spread an edge beyond its
	 * pixels' squares; 0: not measured. */
	double edge_spread_px;
};

extern const struct ini_key tsai_keys[]; /* every field of struct tsai_camera */

/* Checks a camera and makes R an exact rotation. 0; -EINVAL: a field out of range, R is not a
 * rotation to 1e-6, or a distortion of more than kappa1 that folds over inside of the picture. */
int tsai_check(struct tsai_camera *camera, struct fault *fault);

/* Reads a camera from INI text, its section [camera], as a basis carries it, and checks it. 0;
 * -EINVAL: a mistake in the text, or no text; camera is all 0 then. */
int tsai_read_text(const char *text, struct tsai_camera *camera, struct fault *fault);

/* Sets up a camera at eye that looks at target, with world Z up, square pixels, no distortion, and
 * this horizontal field of view. 0; -EINVAL: eye and target coincide, or the view is vertical. */
int tsai_look_at(struct tsai_camera *camera, int width, int height, const double eye[3],
		 const double target[3], double field_deg, struct fault *fault);

/* Whether kappa1 is the only term of the distortion. */
bool tsai_is_plain(const struct tsai_camera *camera);

/* The distortion of a camera, around its axis on the sensor; reach is the farthest corner's. */
struct distortion tsai_distortion_of(const struct tsai_camera *camera);

/*
 * Projects a world point into the picture. 0; -ERANGE: the point has no image: it lies behind the
 * camera, or beyond the radius where a negative kappa1 folds the picture over:
 *     TSAI_DISTORTS      |Psu| > 1 / sqrt(-3 kappa1)
 *     TSAI_UNDISTORTS    |Psu| > 2/3 / sqrt(-3 kappa1), which no |Psd| reaches
 * More terms fold at the radius that distortion_fold() gives.
 */
int tsai_project(const struct tsai_camera *camera, const double world[3], double px[2]);

/*
 * The ray of a point in the picture: origin (the same for all) and unit direction. 0; -ERANGE:
 * kappa1 is negative and the point too far out: no undistorted radius maps there (TSAI_DISTORTS),
 * or it lies beyond the fold, |Psd| > 1 / sqrt(-3 kappa1) (TSAI_UNDISTORTS).
 */
int tsai_ray(const struct tsai_camera *camera, const double px[2], double origin[3], double dir[3]);

/*
 * Solves r (1 + kappa1 r^2) = bent for the smallest r >= 0, in closed form on the branch that
 * starts at the axis, then by two Newton steps. Projection needs it for one direction of kappa1,
 * tsai_ray() for the other. 0; -ERANGE: no solution, or a negative, infinite or NaN argument.
 */
int tsai_straight_radius(double kappa1, double bent, double *straight);

/* The radius r at which r (1 + kappa1 r^2) stops growing: infinite unless kappa1 is negative. */
double tsai_fold_radius(double kappa1);

#endif
