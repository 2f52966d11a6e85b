/* SPDX-License-Identifier: MIT */
/* Which lights a frame uses, and what becomes of the others. */
#ifndef INLAY_HAL_COMPOSITOR_LIGHT_SELECTION_H
#define INLAY_HAL_COMPOSITOR_LIGHT_SELECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/basis/basis.h"

enum threshold_mode {
	THRESHOLD_AMBIENT,
	THRESHOLD_DROP,
	THRESHOLD_HARMONICS,
	THRESHOLD_MODE_COUNT
};

extern const char *const threshold_mode_names[]; /* "ambient", "drop", "harmonics", NULL */

/* Spherical harmonics up to l = 2 but for the constant. */
#define LIGHT_RETURN_TERMS 8

/* The lights of one frame, chosen (thesis 3.2.2). */
struct light_selection {
	int count;	       /* N */
	double (*radiance)[3]; /* [count]: L_i, 0 where the light is left out; in mode harmonics
				  with what comes back of the dropped from there */
	bool *used;	       /* [count] */
	int used_count;
	double ambient[3]; /* radiance over all cells that stands for the dropped: sum over dropped
			      of w_i L_i / (2 pi); 0 in other modes */
	double dropped_error[3]; /* no pixel's object radiance is off by more than this, per
				    channel: max(sum over dropped of L_i peak_i, ambient *
				    peak_total) * gain; in mode harmonics the less of that, with
				    the largest that comes back in ambient's place, and the
				    larger of the sums of r_i peak_i, r what comes back less what
				    was dropped, over the lights that gain and those that lose */
	/* The owner's, 0 as created: how far below the threshold a light that was used in the
	 * choice before must fall to be left out. What a camera's noise amounts to there: else a
	 * light at the threshold comes and goes from frame to frame, and the picture with it. */
	double band;
	/* The owner's, 0 as created: above 0, a share of white (1) that stands in the threshold's
	 * place. */
	double budget;
	/* private: */
	double (*ground)[3]; /* [grounds]: sum of u */
	uint64_t *bound;     /* [count]: what each light may change (light_budget.h) */
	double (*term)[LIGHT_RETURN_TERMS]; /* [count]: light_return.h */
	double (*returned)[3];		    /* [count] */
	/* of the choice before */
	double threshold, last_budget;
	enum threshold_mode mode;
	bool lit; /* there was light: what is chosen of none is no state */
};

int light_selection_create(struct light_selection *selection, const struct basis *basis);
void light_selection_free(struct light_selection *selection);

/*
 * A light is used when any channel reaches threshold (linear radiance; 0 uses all), and stays so
 * until all are below threshold - band. What was used before counts only where threshold and mode
 * are the same as in the choice before: a first choice, and one by another threshold or mode, is
 * by the threshold alone. Negative and non-finite radiance counts as 0.
 *
 * What is dropped comes back in ambient mode as m = sum over dropped of w_i L_i / (2 pi) from every
 * light alike; in mode harmonics as m + s q_j from light j, in each channel: q is the least-squares
 * fit of spherical harmonics of l = 1 and 2 to the dropped light over the sky (light_return.h), and
 * s the largest share of 0..1 with which none comes back negative. sum of w_j q_j = 0, so that the
 * energy is ambient's; over the sky it is nearer to what was dropped, by the fit, the larger s.
 *
 * With a budget, as many of the weakest lights are left out as cannot together change any pixel by
 * more than that share of white, in linear light. Weak is a light whose bound is small:
 *
 *     b_i = max over c of L_ic (gain P_ic + max over g of G_igc / U_gc)
 *     P_ic = peak_ic; unless in drop mode max(peak_ic, w_i / (2 pi) peak_total_c)
 *     G_igc = u_igc; unless in drop mode max(u_igc, w_i / (2 pi) sum over k of u_kgc)
 *     U_gc = sum over k of u_kgc L_kc + e_gc
 *
 * over channels c and the file's grounds g. No sum over dropped lights of b_i is above the budget;
 * each pixel changes by no more than that sum:
 *   - The object's light changes by what is taken, at most gain L_i peak_i each, less what comes
 *     back, at most gain L_i w_i / (2 pi) peak_total each; of two sums that are not negative the
 *     difference is at most the larger.
 *   - 1 - ratio is the mean of v over the ground's light, weighted by u L, with e as light of v 0.
 *     Light before and after are two mixtures that share the kept lights, of weight K; D was taken
 *     and A came back. Where 0 <= v <= 1 their means differ by at most
 *     max(D / (K + D), A / (K + A)) <= max(D, A) / (K + D), which is at most the sum of the shares.
 * Where the object also throws light at the ground, v >= -n, it is at most 1 + n times that;
 * receivers with a u of their own (D and U) are reckoned as ground.
 *   - In mode harmonics what comes back is at most gain (m + s max q) peak_total to the object and
 *     sum over j of u_j (m + s q_j) to the ground. Both are convex in s and ambient's for s = 0, so
 *     that the s at which a straight line between the bounds of 0 and of the s above meets the
 *     budget keeps it.
 *   - coverage and the background are at most 1, and clipping brings no two values further apart.
 * Bounds are rounded up to 2^-40 and summed exactly. What the basis file itself declares as its
 * errors comes on top.
 *
 * The first choice leaves out the most lights whose bounds fit; what was left out stays so until
 * their bounds exceed the budget, or 7/8 of it would hold more lights. Then the most that fit into
 * 15/16 of it are: so the set does not change with noise of a sixteenth.
 */
void light_selection_choose(struct light_selection *selection, const struct basis *basis, int pose,
			    const float (*radiance)[3], double threshold, enum threshold_mode mode,
			    double gain);

#endif
