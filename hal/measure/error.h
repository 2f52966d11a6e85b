/* SPDX-License-Identifier: MIT */
/*
 * How far a composite is from double precision, in 8-bit levels, over the pixels that the object
 * changes. What double precision says is not rounded: a perfect picture in 8 bits has an RMS error
 * of 0.29 levels, 58.9 dB.
 */
#ifndef INLAY_HAL_MEASURE_ERROR_H
#define INLAY_HAL_MEASURE_ERROR_H

#include <stdint.h>

#include "hal/basis/basis.h"
#include "hal/colour/transfer.h"
#include "hal/frame/frame.h"
#include "hal/frame/view.h"

/* Which pixels count. */
enum scope_pixel {
	SCOPE_UNTOUCHED, /* the object changes nothing */
	SCOPE_OBJECT,	 /* all others */
	SCOPE_SHADOW,	 /* of these, where a receiver is seen and no part of the object */
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
	/* Mean over the shadow's pixels and channels of |ratio - true ratio|, the light behind the
	 * shadow as weight: sum |out - true out| / sum B, in linear light. */
	double contrast;
};

/* truth: [height][width][3], R G B, 0..255. Both are code values of this transfer. */
struct composite_error error_measure(const struct scope *scope, const double *truth,
				     const struct canvas *is, const struct picture *background,
				     enum transfer transfer);

/* The worst of both in each figure. */
void error_worse(struct composite_error *worst, const struct composite_error *other);

#endif
