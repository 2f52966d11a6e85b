/* SPDX-License-Identifier: MIT */
/* Finds the low-rank basis (patterns and coefficients) of a matrix of lights by rows: a truncated,
 * weighted singular value decomposition over the coarse lights, quantised as in the file. Private
 * to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_RANK_H
#define INLAY_BAKE_ENCODE_ENCODE_RANK_H

#include "bake/encode/encode_part.h"

#define RANK_MOST 48
#define RANK_FEW 16 /* rank that is tried first: more is seldom worth its bytes */
/* Weight of the mean of a group's lights, per weight that these have lost. Of 1, 4 and 16 it makes
 * a frame read least (spot, 1,626 lights, 64x48: 0.87, 0.83 and 0.88 MB a frame in the museum,
 * without means 1.06). */
#define RANK_MEAN_WEIGHT 4

/* Weights of squared errors by light and pixel, and the metric over coarse lights that follows. */
struct rank_metric {
	const float *weight; /* [lights]: weight of a squared error, > 0 */
	int pixels;
	float root[PART_PIXELS]; /* square root of each pixel's weight, > 0 */
	float *factor; /* [K][K], row by row: lower Cholesky factor of P W P^T, means included;
			  NULL where K is N, and there are no means */
	/* Weight that lights of a group have lost, against the part's, goes to their mean. */
	float *mean_weight; /* [K]: weight of a squared error of the mean; 0: no mean */
	float *mean_share;  /* [lights]: share of the light in its group's mean */
};

struct rank_patterns {
	int count; /* in order of falling singular value */
	int rows;
	int stride;	    /* of pattern, in values */
	float *at_light;    /* [RANK_MOST][lights]: pattern times its step */
	float *coefficient; /* [RANK_MOST][rows]: as stored, times its step */
	int16_t *pattern;   /* [RANK_MOST][stride]: as stored, over the coarse lights */
	int16_t *stored;    /* [RANK_MOST][rows]: coefficients, as stored */
	float scale[RANK_MOST];
};

struct rank_scratch {
	float *coarse;	     /* [K][rows] */
	float *left, *right; /* [K or rows][RANK_MOST + more] */
	float *mixed;
};

int rank_metric_create(struct rank_metric *metric, const struct encode_settings *settings);
/* Sets the weights: weight [lights], which must outlive the metric's use, and the part's pixels.
 * -EDOM: weights are not finite. */
int rank_metric_set(struct rank_metric *metric, const struct encode_settings *settings,
		    const struct part *part, const float *weight);
void rank_metric_free(struct rank_metric *metric);

int rank_patterns_create(struct rank_patterns *patterns, const struct encode_settings *settings);
void rank_patterns_free(struct rank_patterns *patterns);

int rank_scratch_create(struct rank_scratch *scratch, const struct encode_settings *settings);
void rank_scratch_free(struct rank_scratch *scratch);

/* Finds the `most` leading patterns of value [lights][rows], up to RANK_MOST; fewer where the rest
 * is 0 or cannot be stored. */
void rank_find(struct rank_patterns *patterns, const struct encode_settings *settings,
	       const struct rank_metric *metric, struct rank_scratch *scratch, const float *value,
	       int rows, int most);

#endif
