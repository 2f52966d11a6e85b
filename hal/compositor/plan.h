/* SPDX-License-Identifier: MIT */
/*
 * What is found out about each block once, when the compositor is created. Private to
 * hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_PLAN_H
#define INLAY_HAL_COMPOSITOR_PLAN_H

#include <stdbool.h>

#include "hal/basis/basis.h"

struct column_choice;

/* The bits of a sum of light in a block: its magnitude stays below 2^PLAN_SUM_BITS. */
#define PLAN_SUM_BITS 60

/*
 * Blocks of a tile that follow each other and add up, being of one kind (and ground), are a group.
 * Those of a group that list the same pixels without a tint share their sums.
 */
struct block_plan {
	const struct basis_block *block;
	int group;    /* how many blocks, of the first of a group; else 0 */
	bool joins;   /* its sums go on top of those of the block before it */
	bool single;  /* the whole group shares its sums, without a tint */
	int fraction; /* of the group: bits that the roundings of so many weights need */
	double most;  /* of the group: no value per unit of light exceeds it ... */
	int bound;    /* ... nor this power of two */
	bool whole;   /* lists every pixel of a whole tile */
	uint16_t row[BASIS_TILE]; /* bit x of row y: that pixel is listed */
	bool kept;		  /* its sums are worth keeping from frame to frame */
	int column_shift; /* weights of columns have so many bits less than those of patterns */
	bool follows;	  /* has columns of groups in common with the block before it */
	bool grouped;	  /* there are columns of groups in it, or in one that has them in common */
	float reach;	  /* a column's values reach column_scale times this, tint included */
	/* Of T and V blocks that need not use all their columns: what chooses among them, and their
	 * number there (column_choice.h). NULL: each column counts whose light is not 0. */
	const struct column_choice *choice;
	int number;
	size_t state; /* of kept blocks: offset in int64 into what is kept of the layer */
};

/* One tile: its blocks' plans, in their order. */
struct tile_plan {
	const struct block_plan *blocks;
	int block_count;
	bool plain;	    /* the object changes nothing here */
	bool object, taken; /* what its blocks, or glass, add to */
};

struct layer_plan {
	struct tile_plan *tiles;
	size_t kept_size; /* int64s */
	int kept_blocks;
	struct block_plan *blocks; /* in the layer's order */
};

/* cut: columns may be left out, so no sums are kept. -ENOMEM. */
int layer_plan_create(struct layer_plan *plan, const struct basis *basis,
		      const struct basis_pose *pose, const struct basis_layer *layer, bool cut);
void layer_plan_free(struct layer_plan *plan); /* zeroed is fine */

/* Lines of one panel and channel: patterns and columns. */
static inline int plan_lines(const struct block_plan *p)
{
	return p->block->patterns + p->block->columns;
}

/* What kept blocks keep: the weights of their lines, and their sums. */
#define PLAN_PANEL 64 /* pixels that sums are padded to */

static inline int plan_sums(const struct block_plan *p)
{
	return (p->block->pixels + PLAN_PANEL - 1) / PLAN_PANEL * PLAN_PANEL;
}

#endif
