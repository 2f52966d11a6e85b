/* SPDX-License-Identifier: MIT */
/*
 * Measures the error of a composite against double precision, in 8-bit levels, over the pixels that
 * the object changes. The reference is not rounded, so a perfect 8-bit picture has an RMS error of
 * 0.29 levels, 58.9 dB.
 */
#ifndef INLAY_HAL_MEASURE_ERROR_H
#define INLAY_HAL_MEASURE_ERROR_H

#include <stdint.h>

#include "hal/basis/basis.h"
#include "hal/colour/transfer.h"
#include "hal/frame/frame.h"
#include "hal/frame/view.h"

/* Classifies the pixels of a picture. */
enum scope_pixel {
	SCOPE_UNTOUCHED, /* the object does not change the pixel */
	SCOPE_OBJECT,	 /* the object covers the pixel, at least in part */
	SCOPE_SHADOW,	 /* the object changes the receiver and does not cover it */
};

struct scope {
	int width, height;
	uint8_t *pixel; /* [height * width]: enum scope_pixel */
	long objects, shadows;
};

int scope_create(struct scope *scope, const struct basis *basis,
		 const struct basis_layer *layer); /* -ENOMEM */
void scope_free(struct scope *scope);		   /* idempotent; zeroed is fine */

struct composite_error {
	double rms, psnr_db, max; /* over object and shadow */
	double frame_psnr_db;	  /* over every pixel */
	/* Mean of |ratio - true ratio| over pixels and channels of the shadow, weighted by the
	 * background, in linear light:
	 *     sum |out - true out| / sum B
	 */
	double contrast;
};

double error_psnr(double rms); /* in dB; at most 120: JSON has no infinity */

/* truth: [height][width][3], R G B, 0..255. Both pictures hold code values of this transfer
 * function. */
struct composite_error error_measure(const struct scope *scope, const double *truth,
				     const struct canvas *is, const struct picture *background,
				     enum transfer transfer);

/* Sets each figure of *worst to the worse of both. */
void error_worse(struct composite_error *worst, const struct composite_error *other);

#endif
