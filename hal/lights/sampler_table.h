/* SPDX-License-Identifier: MIT */
/*
 * Which pixels make up which light, with what weight, in the order in which a picture is read.
 *
 * A picture is taken in strips of rows, each decoded to planes of linear light that stay in the
 * cache. A part is what one light has in one strip: spans of pixels with a weight each.
 */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_TABLE_H
#define INLAY_HAL_LIGHTS_SAMPLER_TABLE_H

#include "hal/lights/sampler_kernels.h"
#include "hal/lights/sampler_shares.h"

enum { SAMPLER_STRIP_ROWS = 16 };

/* Weights of a light are in units of its largest over SAMPLER_WEIGHT_MAX; where that is too coarse
 * (README.md), a second sum has the next SAMPLER_FINE_BITS bits of each. */
#define SAMPLER_WEIGHT_MAX 32767
#define SAMPLER_FINE_BITS 15

struct sampler_part {
	int sum; /* which one it adds to */
	int first_span, spans;
	size_t first_weight;
};

/* Pixels of a strip that are needed. */
struct sampler_segment {
	uint16_t row, x, count;
};

struct sampler_strip {
	int first_part, parts, first_segment, segments;
};

struct sampler_light {
	int sum, fine;	 /* indices of its sums; fine: -1 where it has none, both -1: unseen */
	double whole[2]; /* the weights of each, added up */
	/*
	 * Where the lens passes less light than on its axis, weights are larger by as much; this
	 * makes up for what that adds to whole: the weights with it over those without, 1 for a
	 * lens without falloff.
	 */
	double brighter;
};

struct sampler_table {
	int lights, sums, strips, parts;
	int row_stride; /* values from a row of a strip's planes to the next */
	struct sampler_light *light;
	struct sampler_strip *strip;
	struct sampler_part *part;
	struct sampler_span *span;
	struct sampler_segment *segment;
	uint16_t *weight; /* 64-byte aligned */
	int unseen;	  /* lights without pixels */
};

/* -ENOMEM. Zeroed on failure. */
int sampler_table_create(struct sampler_table *table, const struct sampler_shares *shares,
			 const struct fisheye *lens, int lights, int width, int height);
void sampler_table_free(struct sampler_table *table); /* idempotent; zeroed is fine */

#endif
