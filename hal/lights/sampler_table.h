/* SPDX-License-Identifier: MIT */
/*
 * The sampler's table: the pixels of each light with their weights, in the order in which a picture
 * is read.
 *
 * A picture is read in strips of rows. Each strip is decoded to planes of linear light that stay in
 * the cache. A part is one light in one strip: spans of pixels with a weight each.
 */
#ifndef INLAY_HAL_LIGHTS_SAMPLER_TABLE_H
#define INLAY_HAL_LIGHTS_SAMPLER_TABLE_H

#include "hal/lights/sampler_kernels.h"
#include "hal/lights/sampler_shares.h"

enum { SAMPLER_STRIP_ROWS = 16 };

/* The unit of a light's weights is (its largest weight) / SAMPLER_WEIGHT_MAX. Where that is too
 * coarse (README.md), a second sum has the next SAMPLER_FINE_BITS bits of each weight. */
#define SAMPLER_WEIGHT_MAX 32767
#define SAMPLER_FINE_BITS 15

struct sampler_part {
	int sum; /* index of the sum that it adds to */
	int first_span, spans;
	size_t first_weight;
};

/* A run of pixels of a strip that some light needs. */
struct sampler_segment {
	uint16_t row, x, count;
};

struct sampler_strip {
	int first_part, parts, first_segment, segments;
};

struct sampler_light {
	int sum, fine;	 /* indices of its sums; fine -1: it has only one; both -1: unseen */
	double whole[2]; /* sum of the weights of each */
	/*
	 * Weights are divided by the lens's falloff, which makes whole larger. This factor undoes
	 * that: (sum of weights / falloff) / (sum of weights); 1 for a lens without falloff.
	 */
	double brighter;
};

struct sampler_table {
	int lights, sums, strips, parts;
	int row_stride; /* values from one row of a strip's planes to the next */
	struct sampler_light *light;
	struct sampler_strip *strip;
	struct sampler_part *part;
	struct sampler_span *span;
	struct sampler_segment *segment;
	uint16_t *weight; /* 64-byte aligned */
};

/* 0 or -ENOMEM; zeroed on failure. */
int sampler_table_create(struct sampler_table *table, const struct sampler_shares *shares,
			 int lights, int width, int height);
void sampler_table_free(struct sampler_table *table); /* idempotent; zeroed is fine */

#endif
