/* SPDX-License-Identifier: MIT */
/* The best few patterns for a set of columns: a truncated singular value decomposition over the
 * coarse lights, quantised as the file has it. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_RANK_H
#define INLAY_BAKE_ENCODE_ENCODE_RANK_H

#include "bake/encode/encode_part.h"

#define RANK_MOST 48
#define RANK_FEW 16 /* that are looked for first: more are seldom worth it */
/* How much the mean of a group's lights counts, per weight that these have lost. Of 1, 4 and 16 it
 * reads least (spot, 1,626 lights, 64x48: 0.87, 0.83 and 0.88 MB a frame in the museum, without
 * means 1.06). */
#define RANK_MEAN_WEIGHT 4

/* How much an error at each light and pixel counts, and what that means for the coarse lights. */
struct rank_metric {
	const float *weight; /* [lights]: of a squared error, > 0 */
	int pixels;
	float root[PART_PIXELS]; /* of pixels' weights, > 0 */
	float *factor; /* [K][K], row by row: lower Cholesky factor of P W P^T, means included;
			  NULL where K is N, and there are no means */
	/* A group's lights that count less than they do in the part count by their mean instead. */
	float *mean_weight; /* [K]: of a squared error of the mean; 0: there is none */
	float *mean_share;  /* [lights]: of their group's mean */
};

struct rank_patterns {
	int count; /* the best first */
	int rows;
	int stride;	    /* of pattern */
	float *at_light;    /* [RANK_MOST][lights]: pattern times its step */
	float *coefficient; /* [RANK_MOST][rows]: as stored, times its step */
	int16_t *pattern;   /* [RANK_MOST][stride]: as stored, over the coarse lights */
	int16_t *stored;    /* [RANK_MOST][rows]: coefficients as stored */
	float scale[RANK_MOST];
};

struct rank_scratch {
	float *coarse;	     /* [K][rows] */
	float *left, *right; /* [K or rows][RANK_MOST + more] */
	float *mixed;
};

int rank_metric_create(struct rank_metric *metric, const struct encode_settings *settings);
/* weight [lights] must stay; pixels as the part has it. -EDOM: they are no numbers. */
int rank_metric_set(struct rank_metric *metric, const struct encode_settings *settings,
		    const struct part *part, const float *weight);
void rank_metric_free(struct rank_metric *metric);

int rank_patterns_create(struct rank_patterns *patterns, const struct encode_settings *settings);
void rank_patterns_free(struct rank_patterns *patterns);

int rank_scratch_create(struct rank_scratch *scratch, const struct encode_settings *settings);
void rank_scratch_free(struct rank_scratch *scratch);

/* The best most (up to RANK_MOST) of value [lights][rows]. Fewer where the rest is nothing or
 * cannot be stored. */
void rank_find(struct rank_patterns *patterns, const struct encode_settings *settings,
	       const struct rank_metric *metric, struct rank_scratch *scratch, const float *value,
	       int rows, int most);

#endif
