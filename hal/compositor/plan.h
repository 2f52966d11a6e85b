/* SPDX-License-Identifier: MIT */
/*
 * Properties of each block that do not depend on the light, computed once for a pose: bounds,
 * fraction bits, and which blocks share their sums. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_PLAN_H
#define INLAY_HAL_COMPOSITOR_PLAN_H

#include <stdbool.h>

#include "hal/basis/basis.h"

struct column_choice;

/* The magnitude of a sum stays below 2^PLAN_SUM_BITS. */
#define PLAN_SUM_BITS 60

/*
 * A group of blocks (not of lights) is consecutive blocks of a tile that add up: they have one kind
 * and ground. Consecutive blocks of a group share their sums if they list the same pixels without a
 * tint.
 */
struct block_plan {
	const struct basis_block *block;
	int group;    /* in the first block of a group: number of its blocks; else 0 */
	bool joins;   /* its sums are added to those of the block before */
	bool single;  /* the whole group shares its sums, without a tint */
	int fraction; /* of the group: fraction bits that the roundings of its weights need */
	double most;  /* of the group: largest value per unit of light */
	int bound;    /* of the group: most <= 2^bound */
	bool whole;   /* lists all BASIS_TILE^2 pixels of its tile */
	uint16_t row[BASIS_TILE]; /* bit x of row[y]: the pixel is listed */
	int column_shift; /* weights of columns have so many bits less than those of patterns */
	bool follows;	  /* groups of lights span it and the block before */
	bool grouped;	  /* it, or a block that groups of lights span with it, has their columns */
	bool lamps;	  /* its columns are those of lamps (near/near_layer.h) */
	float reach;	  /* reach of a column / cut_share = column_scale * this; tint included */
	/* In bounded tiles: the largest |coefficient| of each pattern times its scale, by channel.
	 */
	float (*farthest)[3];
	/* T and V blocks whose columns may be left out: what chooses among the columns, and the
	 * block's number there (column_choice.h). NULL: all columns count whose light is not 0. */
	const struct column_choice *choice;
	int number;
};

/* The plans of a tile's blocks, in their order. */
struct tile_plan {
	const struct block_plan *blocks;
	int block_count;
	bool bare;	    /* coverage and O are 0 */
	bool plain;	    /* the object changes nothing here */
	bool object, taken; /* whether blocks or glass add to O; to 1 - ratio */
	bool bounded;	    /* bare, with blocks of V alone, without a tint */
};

/* The plans of all blocks and tiles of a layer. */
struct layer_plan {
	struct tile_plan *tiles;
	struct block_plan *blocks; /* in the layer's order */
	float (*farthest)[3];	   /* of the blocks' patterns, in that order */
};

/* -ENOMEM. */
int layer_plan_create(struct layer_plan *plan, const struct basis *basis,
		      const struct basis_pose *pose, const struct basis_layer *layer);
/* Whether a block has columns of groups of lights; whether its columns are those of lamps. */
bool block_has_groups(const struct basis *basis, const struct basis_block *block);
bool block_has_lamps(const struct basis *basis, const struct basis_block *block);

void layer_plan_free(struct layer_plan *plan); /* zeroed is fine */

#endif
