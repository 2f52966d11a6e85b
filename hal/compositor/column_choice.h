/* SPDX-License-Identifier: MIT */
/*
 * Chooses the columns that count in a frame, for one light vector. Private to hal/compositor.
 *
 * In a frame most columns of a file are below the cut. To avoid testing each, every light has a
 * list of its columns, sorted by falling reach. A frame reads each list until the columns are below
 * the cut, and sorts the chosen columns by block. The time is proportional to the number of lights
 * and of columns that count.
 *
 * Here, reach is divided by the cut_share of the block, so all columns of a light have one limit:
 * those with strength * reach < 1 are left out.
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
	uint32_t block; /* block_plan.number */
	uint32_t place; /* in the block: 16 bits: column number; 8 bits: offset of its record */
	uint32_t bytes; /* length of the record */
};

/* The columns of one light. */
struct light_columns {
	uint32_t light; /* index in light_vector.sent */
	uint32_t first; /* its first column in column_choice.column */
	float most;	/* largest reach of its columns */
};

/* A block that takes part in the choice. */
struct choosing_block {
	float reach;  /* block_plan.reach */
	uint32_t end; /* end of its chosen columns; those of the next block begin there */
};

/* A column that counts in this frame. */
struct chosen_column {
	uint32_t place;
	/* light: as in light_columns; bytes: length of the record */
	uint32_t light : 20, bytes : 12;
	float scale;
};

struct column_choice {
	struct chosen_column *chosen; /* sorted by block, then by light */
	int left_out;		      /* number of columns that were not chosen */
	/* private */
	struct light_columns *light;  /* [lights + 1]; lights: how many have columns */
	struct light_column *column;  /* sorted by light */
	struct choosing_block *block; /* [1 + blocks]; the first entry is a sentinel */
	int lights, blocks;
};

/* Lists the columns of the layer's blocks of this kind and ground. Sets block_plan.choice of these
 * blocks to `choice`, which must not move afterwards. -ENOMEM. */
int column_choice_create(struct column_choice *choice, struct block_plan *plan, int count,
			 enum basis_kind kind, int ground, const struct light_terms *terms);
void column_choice_free(struct column_choice *choice); /* zeroed is fine */

/* Chooses the columns that are not below the cut in this light, which was made with order.cut. */
void column_choice_make(struct column_choice *choice, const struct light_vector *light);

/* Returns the columns chosen for a block; *count: how many. */
static inline const struct chosen_column *columns_chosen(const struct block_plan *plan, int *count)
{
	const struct choosing_block *block = plan->choice->block + plan->number;

	*count = (int)(block[1].end - block[0].end);
	return plan->choice->chosen + block[0].end;
}

/* Whether the block counts in this frame: it has patterns, or chosen columns. */
static inline bool block_counts(const struct block_plan *plan)
{
	int count;

	if (plan->block->patterns || !plan->choice)
		return true;
	columns_chosen(plan, &count);
	return count > 0;
}

#endif
