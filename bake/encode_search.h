/* How many patterns, and which lights get a column: the cheapest that holds the error asked for.
 * Private to the encoder. */
#ifndef INLAY_BAKE_ENCODE_SEARCH_H
#define INLAY_BAKE_ENCODE_SEARCH_H

#include "bake/encode_split.h"

struct plan {
	enum split_way way;
	int mono_rank, colour_rank;
	int columns[COLUMN_FORMS];
	size_t bytes, pattern_bytes; /* of all; of patterns and their coefficients */
	double excess;		     /* of the skies' errors over what is asked; up to 1: held */
};

/* A block to be: which patterns and which columns are in it. */
struct plan_block {
	bool mono;
	int patterns, bits;
	enum column_form form; /* of its columns; COLUMN_NONE: it has none */
	int columns;
};

#define PLAN_BLOCKS_MAX 4

/* Those that hold anything. */
int plan_blocks(const struct plan *plan, struct plan_block *blocks);

struct search {
	const struct encode_settings *settings;
	const struct levels *levels;
	struct encode_target target;
	float *sky_x;	    /* [skies][3][lights]: of what no column puts right */
	float *column_x;    /* [skies][3][lights], by number of column: of what it leaves */
	float *column_left; /* [used_columns][rows] */
	int used_columns;
	size_t left_room;
	float *sky_sum; /* [skies][3 * pixels] */
	float *sky_mono;
};

int search_create(struct search *search, const struct encode_settings *settings,
		  const struct levels *levels);
void search_free(struct search *search); /* zeroed is fine */

/* The best plan for the part, its split ready and its ranks set. -ENOMEM. */
int search_best(struct search *search, struct split *split, const struct part *part,
		struct plan *best);

/* The light's column at the ranks that are set; its form is COLUMN_NONE where it needs none. left
 * [rows]: what it and the patterns leave. */
void search_column(const struct split *split, int light, float *left, struct split_column *column);

#endif
