/* SPDX-License-Identifier: MIT */
/*
 * The light of a frame as integers: X, the light that cells send, and Y, the light of the coarse
 * lights. There is one vector for the object, one each for D and U, and one for each ground.
 * Private to hal/compositor; formats and proofs: ../README.md.
 */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_VECTOR_H
#define INLAY_HAL_COMPOSITOR_LIGHT_LIGHT_VECTOR_H

#include <stdbool.h>

#include "hal/compositor/kernels/kernels.h"
#include "hal/compositor/light/light_terms.h"
#include "hal/compositor/light/selection.h"

/* Specifies the light that a vector is to hold. */
struct light_order {
	/*
	 * Kind of X, with R_i = L_i + ambient:
	 *     T   w_i R_i
	 *     D   w_i R_i               finer than T, as only the quotient D / U is used
	 *     U   w_i (R_i + 2^-20)     contains e
	 *     V   u_i R_i               u of `ground`; in units of 2^ilogb(U + e)
	 */
	enum basis_kind kind;
	int ground;
	double gain;   /* for T */
	bool patterns; /* its blocks have patterns: compute Y (planes) */
	bool cut;      /* T and V: columns may be left out: compute strength */
	bool groups;   /* with cut: its blocks have columns of groups: compute S */
};

/* The light that one cell sends. */
struct light_sent {
	/* X in linear light; of V in units of 2^ilogb(U + e). An integer times `unit`. */
	double amount[3];
	/*
	 * strength = max over channels of (change by a column of value 1) / cut, where the cut is
	 * column_cut, or basis_group_cut() for a group. A column is left out where
	 * strength * reach < cut_share. Very large if the cut is 0; 0 without light.
	 */
	double strength;
};

/* light_vector.sent has three parts:
 *     0 .. N - 1             X_i of each light
 *     N .. 2 N - 1           X_i - q_i S, for columns whose group has a column, too
 *     2 N .. 2 N + K - 1     S of each group; the file numbers groups N .. N + K - 1
 * After these, or after the first where there are no groups, come the lamps (light_terms_lamp()).
 * Returns the index of a light in the second part, or of a group in the third. */
static inline int light_beside(int lights, int number)
{
	return lights + number;
}

struct light_vector {
	int lights, coarse, stride; /* stride: coarse rounded up to a line */
	struct light_sent *sent;    /* [lights], with groups [2 * lights + coarse]; then [lamps] */
	double unit[3];		    /* value of the integer 1 of X and Y; a power of two */
	int reach;		    /* sum of the amounts of any channel < 2^reach */
	uint32_t factor[3]; /* Q30: O * 2^-gain_bits, or 1 - ratio, = factor * sum over amounts */
	/* T and V: largest O, or 1 - ratio, that lines with values up to 1 can make. */
	double strongest;
	struct kernel_vector planes[3]; /* Y */
	float lamp_share[LAMPS_MAX][3]; /* V: X of each lamp over U + e */
	/* private */
	const struct light_terms *terms;
	int64_t *y[3];	 /* [coarse] */
	int16_t *digits; /* [3][KERNEL_DIGITS][stride] */
};

/* terms must outlive the vector. -ENOMEM. */
int light_vector_create(struct light_vector *vector, const struct light_terms *terms);
void light_vector_free(struct light_vector *vector); /* zeroed is fine */

/* Computes the vector of one frame. Threads may make different vectors at the same time. */
void light_vector_make(struct light_vector *vector, const struct light_order *order,
		       const struct light_selection *lights);

/* Smallest integer >= 0 with gain <= 2^gain_bits(gain). */
int gain_bits(double gain);

#endif
