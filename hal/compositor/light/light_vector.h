/* SPDX-License-Identifier: MIT */
/*
 * A frame's light as integers: what the cells send (X) and what of it the coarse lights gather (Y),
 * for the object, for receivers with a u of their own, and for each ground. Private to
 * hal/compositor; formats and proofs: README.md.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_VECTOR_H
#define INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_VECTOR_H

#include <stdbool.h>

#include "hal/compositor/kernels/kernels.h"
#include "hal/compositor/light/light_terms.h"
#include "hal/compositor/light/selection.h"

/* What a vector is to hold of a frame's light. */
struct light_order {
	/* T: w_i (L_i + ambient). D, U: the same, finer, as only quotients are taken of them; that
	 * of U has the residue e in it, as 2^-20 of radiance from everywhere. V: u_i (L_i +
	 * ambient) of `ground`, measured by U + e. */
	enum basis_kind kind;
	int ground;
	double gain;   /* of T */
	bool patterns; /* its blocks have some: they need planes, which otherwise stay as they are
			*/
	bool cut;      /* columns may be left out: strength, of T and V */
	bool groups;   /* with that: its blocks have columns of groups */
};

/* What one light sends; beside each other, as that is how columns ask for it. */
struct light_sent {
	/* X in linear light, or of a ground in units of 2^ilogb(U + e): an integer times `unit` */
	double amount[3];
	/*
	 * How much of what may be left out (basis column_cut; of a group, basis_group_cut()) a
	 * column of value 1 would change:
	 * a column whose values reach r is left out where strength * r < 1. Beyond any 1 / r where
	 * nothing may be left out, 0 where there is no light.
	 */
	double strength;
};

/* Behind the lights a vector has what each sends beside its group, X - q S, and then S of each
 * group. So this is the place of a light whose group has a column too, and of a group, whose number
 * in a file comes after those of the lights. */
static inline int light_beside(int lights, int number)
{
	return lights + number;
}

struct light_vector {
	int lights, coarse, stride; /* stride: coarse rounded up to a line */
	struct light_sent *sent;    /* [lights], and with groups [lights + coarse] more */
	double unit[3];		    /* a power of two: 1 of X and of Y */
	int reach;		    /* the sum of all amounts of a channel is below 2^reach */
	uint32_t factor[3]; /* Q30: turns a sum over amounts into O (less gain_bits) or 1 - ratio */
	/* Of T and V: lines of which no value exceeds 1 make no more than this of O, or of
	 * 1 - ratio. */
	double strongest;
	struct kernel_vector planes[3]; /* Y */
	/* Of light_vector_track(): lights whose X is another than at its last call. */
	int *changed;
	int changed_count;
	int lit; /* lights with any X */
	/* private */
	const struct light_terms *terms;
	double (*before)[3]; /* [lights] */
	int64_t *y[3];	     /* [coarse] */
	int16_t *digits;     /* [3][KERNEL_DIGITS][stride] */
};

/* terms must outlive it. -ENOMEM. */
int light_vector_create(struct light_vector *vector, const struct light_terms *terms);
void light_vector_free(struct light_vector *vector); /* zeroed is fine */

/* Of one frame. Different vectors may be made at the same time. */
void light_vector_make(struct light_vector *vector, const struct light_order *order,
		       const struct light_selection *lights);

/* Finds what has changed. Each call is about the frame after that of the one before, or its answer
 * is not used. */
void light_vector_track(struct light_vector *vector);

/* How many bits the gain moves values up by: gain <= 2^gain_bits(gain). */
int gain_bits(double gain);

#endif
