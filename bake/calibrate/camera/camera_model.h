/* SPDX-License-Identifier: MIT */
/*
 * Tsai's camera as a vector of unknowns, with derivatives, for the descent.
 *
 * The world's origin is moved to the middle of each view's points, which decouples rotation and
 * translation:
 *     T' = R middle + T
 * The picture's y counts down.
 */
#ifndef INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_MODEL_H
#define INLAY_BAKE_CALIBRATE_CAMERA_CAMERA_MODEL_H

#include <stdbool.h>

#include "hal/optics/tsai.h"

/* The first unknowns are shared by all views; six more follow for each view. */
enum {
	MODEL_FOCAL,
	MODEL_KAPPA1, /* and MODEL_RADIAL - 1 more terms */
	MODEL_RADIAL = DISTORTION_RADIAL,
	MODEL_CENTRE_X = MODEL_KAPPA1 + MODEL_RADIAL, /* px */
	MODEL_CENTRE_Y,				      /* px, down */
	MODEL_ASPECT,
	MODEL_SHARED,
	MODEL_ROTATION = 0,    /* within a view: rotation vector, rad */
	MODEL_TRANSLATION = 3, /* T', world units */
	MODEL_OF_VIEW = 6,
	MODEL_GRADIENT = MODEL_SHARED + MODEL_OF_VIEW
};

struct camera_model {
	double pixel[2];      /* D */
	int distortion;	      /* enum tsai_distortion */
	double tangential[2]; /* q: known beforehand, or 0 */
	double reach;	      /* of struct distortion */
};

/* The pose of one view, computed once for all its points. */
struct model_view {
	double rotation[9];
	double slope[3][9]; /* derivatives of rotation by the rotation vector's components */
	double translation[3];
};

static inline int model_unknowns(int views)
{
	return MODEL_SHARED + views * MODEL_OF_VIEW;
}

static inline int model_of_view(int view)
{
	return MODEL_SHARED + view * MODEL_OF_VIEW;
}

void model_turn(struct model_view *view, const double *of_view);

/*
 * Projects a point, given relative to the view's middle. gradient: derivatives of px by the shared
 * unknowns, then by the view's; may be NULL. False: no image (behind the camera, beyond the fold).
 */
bool model_see(const struct camera_model *model, const double *shared,
	       const struct model_view *view, const double place[3], double px[2],
	       double gradient[2][MODEL_GRADIENT]);

/* Back-projects px to the point at this depth (along the view), relative to the view's middle.
 * False: px is beyond the fold. */
bool model_place(const struct camera_model *model, const double *shared,
		 const struct model_view *view, const double px[2], double depth, double place[3]);

/* Undistorts px to sensor coordinates, with s undone: |sensor| = f tan(angle to the axis). False:
 * beyond the fold. */
bool model_straighten(const struct camera_model *model, const double *shared, const double px[2],
		      double sensor[2]);

#endif
