/* SPDX-License-Identifier: MIT */
/* Finds the low-rank basis (patterns and coefficients) of a matrix of lights by rows: a truncated,
 * weighted singular value decomposition over the coarse lights, quantised as in the file. Private
 * to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_RANK_H
#define INLAY_BAKE_ENCODE_ENCODE_RANK_H

#include "bake/judge/part.h"

struct rank_patterns {
	int count; /* number of patterns; their singular values fall */
	int rows;
	int stride;	    /* values from one pattern to the next */
	float *at_light;    /* [RANK_MOST][lights]: pattern times its step */
	float *coefficient; /* [RANK_MOST][rows]: as stored, times its step */
	int16_t *pattern;   /* [RANK_MOST][stride]: as stored, over the coarse lights */
	int16_t *stored;    /* [RANK_MOST][PART_ROWS]: coefficients as stored */
	float scale[RANK_MOST];
};

/* State and memory of rank_find(). */
struct rank_finder {
	const struct encode_settings *settings;
	const struct part *part;
	float root[PART_PIXELS]; /* square root of each pixel's weight, > 0 */
	float *factor; /* [K][K], row by row: lower Cholesky factor of P W P^T; NULL where K is N */
	float *coarse; /* Z, [K][rows] */
	float *left, *right; /* [RANK_MOST + spare] of [K] and of [rows]: left and right vectors */
	float *mixed;	     /* room to multiply either of them in */
};

int rank_patterns_create(struct rank_patterns *patterns, const struct encode_settings *settings);
void rank_patterns_free(struct rank_patterns *patterns);

int rank_finder_create(struct rank_finder *finder, const struct encode_settings *settings);
void rank_finder_free(struct rank_finder *finder); /* zeroed is fine */

/* Prepares the finder for a part's weights; the part is borrowed. -EDOM: they are not finite. */
int rank_weigh(struct rank_finder *finder, const struct part *part);

/* Finds the `most` (at most RANK_MOST) leading patterns of value [lights][rows]. There are fewer if
 * the rest is 0 or cannot be stored. */
void rank_find(struct rank_patterns *patterns, struct rank_finder *finder, const float *value,
	       int rows, int most);

#endif
