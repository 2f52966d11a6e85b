/* SPDX-License-Identifier: MIT */
/* A plan: how many patterns, and which lights get a residual column; what it costs, and whether it
 * holds the error asked for. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_PLAN_H
#define INLAY_BAKE_ENCODE_ENCODE_PLAN_H

#include "bake/encode/encode_column.h"
#include "bake/encode/encode_expose.h"

struct encode_plan {
	enum split_way way;
	int most; /* patterns that were looked for */
	int mono_rank, colour_rank;
	int columns[COLUMN_FORMS];
	size_t column_bytes[COLUMN_FORMS];
	size_t bytes, pattern_bytes; /* of all; of patterns and their coefficients */
	double read;		     /* of columns, in a frame: mean over the skies */
	int blocks;
	double excess; /* of the skies' errors over what is asked; up to 1: held */
};

/* A block to be: which patterns and which columns are in it. */
struct encode_plan_block {
	bool mono;
	int patterns, bits;
	enum column_form form; /* of its columns; COLUMN_NONE: it has none */
	int columns;
};

/* A light's column, or a group's, among those of a plan. */
struct found_column {
	int number; /* as the file has it: of a light, or after these of a group */
	enum column_form form;
	double reach; /* what it changes by at most, per unit of X */
	size_t bytes;
	bool second; /* of the light that the one before it is of */
};

/* Columns of one channel, or of three, whose lights are of one group. */
struct found_group {
	int columns;  /* 0: none yet, and the rest means nothing */
	double reach; /* as far as its lights' together, each by its share */
	size_t value; /* [channels * pixels] of group_value: the sum of them, by shares */
	int number;   /* of its column among those found; -1: too few to have one */
};

/* Fewer have nothing in common; and what reaches less far hardly ever counts, as S is small. */
#define FOUND_GROUP_COLUMNS 2
#define FOUND_GROUP_REACH (1.0 / BASIS_GROUP_MOST)
/* What reaches farther has 16 bits: 8 would be rounded by more than a quarter of the cut. */
#define FOUND_GROUP_NARROW 1.0

#define PLAN_BLOCKS_MAX (COLUMN_FORMS - 1)

/* Those that hold anything. */
int encode_plan_blocks(const struct encode_plan *plan, struct encode_plan_block *blocks);

/* Of the block's columns of 8 bits, in a file. */
uint32_t encode_plan_record_bytes(const struct encode_plan *plan,
				  const struct encode_plan_block *block);

struct search {
	const struct encode_settings *settings;
	const struct levels *levels;
	struct encode_target target;
	float *sky_x;	    /* [skies][3][lights]: of what no column puts right */
	float *column_x;    /* [skies][3][most_columns], by number: of what it leaves */
	float *column_left; /* [used_columns][rows] */
	int most_columns;   /* that lights may have */
	int used_columns;
	/* Those of the plan that was evaluated last; of groups after those of lights. */
	struct found_column *found; /* [most_columns + 2 groups] */
	int found_groups;
	struct found_group *group[2]; /* of one channel, of three: [groups] */
	float *group_value;	      /* [used_columns][rows] */
	size_t left_room;
	float *sky_sum; /* [skies][3 * pixels] */
	float *sky_mono;
	float *weight, *next_weight; /* [lights]: of the best plan, of one to be tried */
	float *miss; /* [lights]: by how many times what may be left of it patterns miss a light */
};

/* Sets the split's ranks, and what comes of them: plan's columns, bytes and excess. best: what it
 * has to beat, or NULL; where it costs more, excess is infinite. */
void encode_plan_evaluate(struct search *search, struct split *split, int mono_rank,
			  int colour_rank, const struct encode_plan *best,
			  struct encode_plan *plan);

/* Bytes of the file and of a frame, which reads all patterns, and columns of bright lights. */
double encode_plan_cost(const struct encode_plan *plan);

/* The cheaper of those that hold, else the nearer. */
bool encode_plan_better(const struct encode_plan *a, const struct encode_plan *b);

/* The light's columns at the ranks that are set: returns how many. left [LIGHT_COLUMNS_MAX][rows]:
 * what each and those before it leave; the first, where there is none, what the patterns leave. */
int search_light(const struct split *split, int light, float *left,
		 struct split_column column[LIGHT_COLUMNS_MAX]);

/* The column of a group of those found, as it is stored: in 8 bits, whatever its lights need, as
 * its light is never large (BASIS_GROUP_MOST); in 16 where it reaches beyond FOUND_GROUP_NARROW, as
 * that of a mirror does, or where all columns are wide. */
void search_group(const struct search *search, const struct split *split, bool colour, int group,
		  struct split_column *column);

#endif
