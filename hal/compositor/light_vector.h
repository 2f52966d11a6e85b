/*
 * A frame's light as integers: what the cells send (X) and what of it the coarse lights gather (Y),
 * for the object, for receivers with a u of their own, and for each ground. Private to
 * hal/compositor; formats and proofs: README.md.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_VECTOR_H
#define INLAY_HAL_COMPOSITOR_LIGHT_VECTOR_H

#include <stdbool.h>

#include "hal/basis/basis.h"
#include "hal/compositor/compositor.h"
#include "hal/compositor/kernels.h"

#define BRIGHT_CLASSES 32
#define BRIGHT_LEAST (-20)

struct light_vector {
	int lights, coarse, stride; /* stride: coarse rounded up to a line */
	/* X in linear light, or of a ground in units of 2^ilogb(U + e): an integer times `unit`. */
	double (*amount)[3]; /* [lights] */
	double unit[3];	     /* a power of two: 1 of X and of Y */
	int reach;	     /* the sum of all amounts of a channel is below 2^reach */
	uint32_t factor[3]; /* Q30: turns a sum over amounts into O (less gain_bits) or 1 - ratio */
	struct kernel_vector planes[3]; /* Y */
	/*
	 * How much of what may be left out (basis column_cut) a column of value 1 would change:
	 * a column whose values reach r is left out where strength * r < 1. Infinite where nothing
	 * may be left out, 0 where there is no light.
	 */
	float *strength; /* [lights] */
	/* Lights that a block may need whose columns reach no farther than 2^k, for each k from
	 * BRIGHT_LEAST on: light_vector_bright(). The last are all lights. */
	uint64_t *bright; /* [BRIGHT_CLASSES][(lights + 63) / 64] */
	/* Of light_vector_track(): lights whose X is another than at its last call. */
	int *changed;
	int changed_count;
	int lit; /* lights with any X */
	/* private */
	double (*before)[3]; /* [lights] */
	int64_t *x;	     /* [lights], of one channel */
	int64_t *y;	     /* [coarse] */
	int16_t *digits;     /* [3][KERNEL_DIGITS][stride] */
};

int light_vector_create(struct light_vector *vector, const struct basis *basis);
void light_vector_free(struct light_vector *vector); /* zeroed is fine */

/* Finds what has changed. Each call is about the frame after that of the one before, or its answer
 * is not used. */
void light_vector_track(struct light_vector *vector);

/* The class of blocks whose columns reach so far. */
int bright_class(float reach);

static inline const uint64_t *light_vector_bright(const struct light_vector *v, int class)
{
	return v->bright + (size_t) class * (size_t)((v->lights + 63) / 64);
}

/* How many bits the gain moves values up by: gain <= 2^gain_bits(gain). */
int gain_bits(double gain);

/* Of T blocks: w_i (L_i + ambient). */
void light_vector_object(struct light_vector *vector, const struct basis *basis,
			 const struct light_selection *lights, double gain);

/* Of D (residue false) and U blocks, of which only quotients are taken: the same, finer. The light
 * of U has the residue e in it, as 2^-20 of radiance from everywhere. */
void light_vector_receiver(struct light_vector *vector, const struct basis *basis,
			   const struct light_selection *lights, bool residue);

/* Of V blocks on one ground: u_i (L_i + ambient), measured by U + e. */
void light_vector_ground(struct light_vector *vector, const struct basis *basis,
			 const struct light_selection *lights, int ground);

#endif
