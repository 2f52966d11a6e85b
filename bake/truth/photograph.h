/* SPDX-License-Identifier: MIT */
/* Photographs of a scene's camera, as they are read for truth and preview, and pictures like
 * them. */
#ifndef INLAY_BAKE_TRUTH_PHOTOGRAPH_H
#define INLAY_BAKE_TRUTH_PHOTOGRAPH_H

#include "bake/scene/scene.h"
#include "hal/colour/transfer.h"
#include "hal/image/image.h"

/* Reads a picture of the size of the scene's camera, which the caller frees: code values or linear
 * light. Errors of image_read(); -EINVAL: another size. */
int photograph_read(const char *path, const struct scene *scene, struct image *picture,
		    struct fault *fault);

/* Between code values and linear light; out is a new picture. -ENOMEM. */
int photograph_encode(const struct image *linear, const struct transfer_curve *curve,
		      struct image *out);
int photograph_decode(const struct image *coded, const struct transfer_curve *curve,
		      struct image *out);

/* Writes linear light, encoded for .png. Errors of image_write(). */
int photograph_write(const char *path, const struct image *linear,
		     const struct transfer_curve *curve, struct fault *fault);

#endif
