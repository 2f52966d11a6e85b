/* SPDX-License-Identifier: MIT */
/*
 * Which columns of its blocks a light vector needs. Private to hal/compositor.
 *
 * Most of a file's columns change nothing that can be seen in a frame. So they are not asked one by
 * one: each light has a list of its columns, those first that reach farthest, which is left where
 * the light stops to count; what was met on the way is sorted by blocks. A frame takes as long as
 * it has columns that count, and lights.
 */
#ifndef INLAY_HAL_COMPOSITOR_COLUMN_CHOICE_H
#define INLAY_HAL_COMPOSITOR_COLUMN_CHOICE_H

#include <stdbool.h>
#include <stdint.h>

#include "hal/compositor/light/light_vector.h"
#include "hal/compositor/plan.h"

/* One column of a light. */
struct light_column {
	float scale;
	uint32_t block; /* of those that choose: block_plan's number */
	uint32_t place; /* in the block: of 16 bits its number, of 8 where its record begins */
	uint32_t bytes; /* of the record */
};

struct light_columns {
	uint32_t light; /* its place among what the light vector sends */
	uint32_t first; /* where they begin */
	float most;	/* no column of this light reaches farther */
};

struct choosing_block {
	float reach;  /* block_plan's */
	uint32_t end; /* where its chosen columns end; those of the next begin there */
};

struct chosen_column {
	uint32_t place;
	/* light_columns'; of the record */
	uint32_t light : 20, bytes : 12;
	float scale;
};

struct column_choice {
	struct chosen_column *chosen; /* by blocks, ascending in each */
	int left_out;		      /* columns that were not chosen */
	/* private */
	struct light_columns *light;  /* [lights + 1]; lights: those that have columns */
	struct light_column *column;  /* by lights */
	struct choosing_block *block; /* [1 + blocks]; the first is none */
	int lights, blocks;
};

/* Of the layer's blocks of this kind and ground that have columns: from then on these choose
 * (block_plan's choice), and the choice must stay where it is. -ENOMEM. */
int column_choice_create(struct column_choice *choice, struct block_plan *plan, int count,
			 enum basis_kind kind, int ground, const struct basis_groups *groups);
void column_choice_free(struct column_choice *choice); /* zeroed is fine */

/* Chooses what may change what can be seen under this light, which was made with `cut`. */
void column_choice_make(struct column_choice *choice, const struct light_vector *light);

/* Where the columns chosen for a block lie, and how many there are. */
static inline const struct chosen_column *columns_chosen(const struct block_plan *plan, int *count)
{
	const struct choosing_block *block = plan->choice->block + plan->number;

	*count = (int)(block[1].end - block[0].end);
	return plan->choice->chosen + block[0].end;
}

/* Whether anything of the block counts in this frame: it has patterns, or columns that do. */
static inline bool block_counts(const struct block_plan *plan)
{
	int count;

	if (plan->block->patterns || !plan->choice)
		return true;
	columns_chosen(plan, &count);
	return count > 0;
}

#endif
