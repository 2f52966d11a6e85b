/* SPDX-License-Identifier: MIT */
/* Chooses the lights that a frame uses, and returns the light of the others. */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_SELECTION_H
#define INLAY_HAL_COMPOSITOR_LIGHT_SELECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/basis/basis.h"
#include "hal/lights/lamps.h"

enum threshold_mode { THRESHOLD_AMBIENT, THRESHOLD_DROP, THRESHOLD_MODE_COUNT };

extern const char *const threshold_mode_names[]; /* "ambient", "drop", NULL */

struct mirror_map;

/* The lights that a frame uses (thesis 3.2.2). */
struct light_selection {
	int count;	       /* N */
	double (*radiance)[3]; /* [count]: L_i, 0 if light i is dropped */
	bool *used;	       /* [count] */
	int used_count;
	double ambient[3]; /* mode ambient: radiance from every light that replaces the dropped
			      ones, sum over dropped of w_i L_i / (2 pi); 0 in other modes */
	/* Set by the owner, 0 as created: the sum of L_i w_i of each lamp at a place, as the
	 * fisheye sees it. None is ever dropped. Counts in a compositor that was created with
	 * lamps, and in compositor_reference() where lamps, borrowed, tells where they are. */
	double lamp[LAMPS_MAX][3];
	const struct lamps *lamps;
	/* Set by the owner, NULL and 1 as created: the sky as mirrors show it, borrowed, and its
	 * factors; NULL: mirrors show the lights' cells. Nothing of it is ever dropped. */
	const struct mirror_map *mirror;
	double mirror_gain[3];
	/*
	 * Bound, in each channel, for the error of the object's radiance in any pixel:
	 *     gain max(sum over dropped of L_i peak_i, ambient peak_total)
	 */
	double dropped_error[3];
	/* Set by the owner, 0 as created: hysteresis of the threshold. A light that was used stays
	 * used until it is below threshold - band. Should cover the camera's noise; otherwise a
	 * light at the threshold, and with it the picture, flickers. */
	double band;
	/* Set by the owner, 0 as created: if above 0, a budget replaces the threshold. In linear
	 * light, white is 1. */
	double budget;
	/* private: */
	double (*ground)[3]; /* [grounds]: sum of u */
	uint64_t *bound;     /* [count]: b_i (light_budget.h) */
	/* of the choice before */
	double threshold, last_budget;
	enum threshold_mode mode;
	bool lit; /* any light was above 0; a choice in darkness is no state */
};

/* -ENOMEM. */
int light_selection_create(struct light_selection *selection, const struct basis *basis);
void light_selection_free(struct light_selection *selection);

/*
 * Chooses the lights of a frame. Negative and non-finite radiance counts as 0.
 *
 * Threshold: a light is used if any channel reaches threshold (linear radiance; 0 uses all), and
 * stays used until all channels are below threshold - band. The state counts only if threshold and
 * mode are those of the choice before; else the threshold alone decides.
 *
 * Return: in each channel, the dropped lights are replaced by this radiance from light j:
 *
 *     drop        0
 *     ambient     sum over dropped of w_i L_i / (2 pi)
 *
 * Budget: as many of the weakest lights are dropped as together cannot change any pixel by more
 * than the budget. A light is weak if its bound is small; over channels c and grounds g of the
 * file:
 *
 *     b_i   = max over c of L_ic (gain P_ic + max over g of G_igc / U_gc)
 *     P_ic  = max(peak_ic, w_i / (2 pi) peak_total_c)            drop: peak_ic
 *     G_igc = max(u_igc, w_i / (2 pi) sum over k of u_kgc)       drop: u_igc
 *     U_gc  = sum over k of u_kgc L_kc + e_gc
 *
 * The sum of b_i over the dropped lights is at most the budget, and no pixel changes by more than
 * that sum:
 *   - Object. The dropped lights take away at most gain L_i peak_i each; at most
 *     gain L_i w_i / (2 pi) peak_total each comes back. Neither sum is negative, so their
 *     difference is at most the larger one.
 *   - Ground. 1 - ratio is the mean of v with weights u L, where e counts as light of v = 0. The
 *     light before and after are two mixtures that share the kept lights, of weight K; D was
 *     dropped, A came back. For 0 <= v <= 1 their means differ by at most
 *         max(D / (K + D), A / (K + A)) <= max(D, A) / (K + D) <= sum of G_i L_i / U.
 *     Where the object also reflects light onto the ground, v >= -n, the limit is 1 + n times that.
 *     Receivers with a u of their own (D and U) are treated as ground.
 *   - coverage and the background are at most 1, and clipping moves no two values apart.
 * Bounds are rounded up to multiples of 2^-40 and summed exactly. The declared errors of the basis
 * file add to this.
 *
 * With a budget the set is a state, too. The first choice drops the most lights whose bounds fit.
 * The set stays until its bounds exceed the budget, or 7/8 of the budget would hold more lights.
 * Then the most lights that fit into 15/16 are dropped. So noise of 1/16 does not change the set.
 */
void light_selection_choose(struct light_selection *selection, const struct basis *basis, int pose,
			    const float (*radiance)[3], double threshold, enum threshold_mode mode,
			    double gain);

#endif
