/*
 * A frame's light colours as integers, ready for the rows of a basis. Private to hal/compositor.
 *
 * A weight is split into balanced digits of base 4096, each in -2048..2047, so that a row of int16
 * times 32 of them fits an int32. Formats and proofs: README.md.
 */
#ifndef INLAY_HAL_COMPOSITOR_WEIGHTS_H
#define INLAY_HAL_COMPOSITOR_WEIGHTS_H

#include "hal/basis/basis.h"
#include "hal/basis/basis_layout.h"
#include "hal/compositor/compositor.h"
#include "hal/compositor/fixed.h"

#define WEIGHT_DIGITS 4
#define WEIGHT_DIGIT_BITS 12

/* One channel's weights of all N lights. */
struct weights {
	int digits;		       /* how many of the planes hold anything */
	int16_t *digit[WEIGHT_DIGITS]; /* [N] each; plane d counts 4096^d */
	int64_t sum;		       /* of all N weights */
	int64_t ambient;	       /* times a row's total */
	int ambient_shift;	       /* and that shifted right by this; 0: not */
	int64_t residue;	       /* D and U: e, times U's total ... */
	int residue_shift;	       /* ... shifted right by this; 0: not */
	struct multiplier unit;	       /* of a sum over a row of scale 1, in the result's Q16 */
};

int weights_create(struct weights *weights, int lights);
void weights_free(struct weights *weights); /* zeroed is fine */

/* For T rows: L_i + ambient, in Q16 object radiance (1.0 = 65535), gain included. */
void weights_object(struct weights *weights, const struct light_selection *lights, int channel,
		    double gain);
/* For D and U rows, of which only quotients are taken: finer, and without a unit. */
void weights_receiver(struct weights *weights, const struct light_selection *lights, int channel);
/* For V rows: shares of the light on a ground whose term is u[N]; ratios in Q16. */
void weights_ground(struct weights *weights, const struct light_selection *lights, int channel,
		    const double *u);

/*
 * The weights of a block's own lights, in runs of 32 lights with two digits each: digits 0 and 1 of
 * every run that has any, then digits 2 and 3. What is 0 is not there, so it costs nothing.
 *
 * The weight of a block's rest is the sum of all weights less those of the lights it lists: exact.
 */
#define SEGMENT_WEIGHTS (2 * BASIS_ROW_STEP)

struct segments {
	int low, high;	 /* how many hold digits 0 and 1; digits 2 and 3 */
	uint32_t *start; /* [low + high]: of the run in a row */
	int16_t *weight; /* [low + high][2][32], aligned to BASIS_ALIGN */
};

int segments_create(struct segments *segments, int lights);
void segments_free(struct segments *segments);
void segments_gather(struct segments *segments, const struct weights *weights,
		     const struct basis_block *block);

#endif
