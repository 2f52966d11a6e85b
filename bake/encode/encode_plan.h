/* SPDX-License-Identifier: MIT */
/* A plan: how many patterns, and which lights get a residual column; what it costs, and whether it
 * holds the error asked for. Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_PLAN_H
#define INLAY_BAKE_ENCODE_ENCODE_PLAN_H

#include "bake/encode/encode_column.h"
#include "bake/encode/encode_expose.h"

struct encode_plan {
	enum split_way way;
	int most; /* patterns that were searched for */
	int mono_rank, colour_rank;
	int columns[COLUMN_FORMS];	   /* number of columns, by form */
	size_t column_bytes[COLUMN_FORMS]; /* their bytes */
	size_t bytes, pattern_bytes;	   /* of all; of patterns and coefficients */
	double read;			   /* bytes of columns in a frame: mean over the skies */
	int blocks;
	double excess; /* largest error under a sky over that asked for; <= 1: the plan holds */
};

/* Patterns and columns of one block to be built. */
struct encode_plan_block {
	bool mono;
	int patterns, bits;
	enum column_form form; /* of its columns; COLUMN_NONE: it has none */
	int columns;
};

/* A column of a light or of a group, in a plan. */
struct found_column {
	int number; /* as in the file: of a light, or number of lights + that of a group */
	enum column_form form;
	double reach; /* largest change by it, per unit of X */
	size_t bytes;
	bool second; /* second column of the light of the column before it */
};

/* The columns of mono, or of colour, of the lights of one group. */
struct found_group {
	int columns;  /* how many lights have one; 0: the other members are not set */
	double reach; /* sum of its lights' reaches times their shares */
	size_t value; /* offset in group_value of the sum of columns times shares */
	int number;   /* index of its column among those found; -1: it has none */
};

/* Least columns and reach of a group that has a column. Fewer columns have nothing in common; with
 * less reach it is hardly ever read, as S is small. */
#define FOUND_GROUP_COLUMNS 2
#define FOUND_GROUP_REACH (1.0 / BASIS_GROUP_MOST)
/* Largest reach of a group's column of 8 bits; rounding would exceed a quarter of the cut
 * beyond. */
#define FOUND_GROUP_NARROW 1.0

#define PLAN_BLOCKS_MAX (COLUMN_FORMS - 1)

/* Lists the blocks of a plan that are not empty. Returns how many. */
int encode_plan_blocks(const struct encode_plan *plan, struct encode_plan_block *blocks);

/* Bytes of the block's columns of 8 bits, in a file. */
uint32_t encode_plan_record_bytes(const struct encode_plan *plan,
				  const struct encode_plan_block *block);

/* State of the search for a plan (encode_search.h). */
struct search {
	const struct encode_settings *settings;
	const struct levels *levels;
	struct encode_target target;
	float *sky_x;	    /* [skies][3][lights]: X of the residuals of the patterns */
	float *column_x;    /* [skies][3][most_columns]: X of the residuals of the columns */
	float *column_left; /* [used_columns][rows]: residuals of the columns */
	int most_columns;   /* that all lights together may have */
	int used_columns;
	/* Columns of the plan that was evaluated last: of lights, then of groups. */
	struct found_column *found; /* [most_columns + 2 groups] */
	int found_groups;
	struct found_group *group[2]; /* of mono, of colour: [groups] */
	float *group_value;	      /* [used_columns][rows] */
	size_t left_room;
	float *sky_sum; /* [skies][3 * pixels] */
	float *sky_mono;
	float *weight, *next_weight; /* [lights]: weights of the best plan, of the next to try */
	float *miss; /* [lights]: residual of the patterns as a multiple of its limit */
};

/* Sets the split's ranks and evaluates the plan that follows: columns, bytes and excess. best: the
 * plan to beat, or NULL; where the new one costs more, its excess becomes infinite. */
void encode_plan_evaluate(struct search *search, struct split *split, int mono_rank,
			  int colour_rank, const struct encode_plan *best,
			  struct encode_plan *plan);

/* Cost of a plan: bytes of the file plus bytes that a frame reads, which are all patterns, and
 * columns of bright lights. */
double encode_plan_cost(const struct encode_plan *plan);

/* Tells whether a is better than b: it alone holds, both hold and it costs less, or neither holds
 * and its excess is smaller. */
bool encode_plan_better(const struct encode_plan *a, const struct encode_plan *b);

/* Finds the light's columns at the ranks that are set. Returns how many, 0..LIGHT_COLUMNS_MAX. left
 * [LIGHT_COLUMNS_MAX][rows]: the residual after each column; without columns left[0] is that of the
 * patterns. */
int search_light(const struct split *split, int light, float *left,
		 struct split_column column[LIGHT_COLUMNS_MAX]);

/* Quantises the column of one of the groups found. It has 8 bits, whatever its lights need, as its
 * light is never large (BASIS_GROUP_MOST); 16 where it reaches beyond FOUND_GROUP_NARROW, as that
 * of a mirror does, or where all columns have 16. */
void search_group(const struct search *search, const struct split *split, bool colour, int group,
		  struct split_column *column);

#endif
