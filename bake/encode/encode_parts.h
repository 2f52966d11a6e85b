/* SPDX-License-Identifier: MIT */
/* Private to the encoder: its parts, in the order in which a tile takes them. */
#ifndef INLAY_BAKE_ENCODE_ENCODE_PARTS_H
#define INLAY_BAKE_ENCODE_ENCODE_PARTS_H

#include "bake/encode/encode_rank.h"
#include "bake/judge/expose.h"
#include "bake/judge/measure.h"
#include "bake/judge/shade.h"
#include "hal/basis/basis_lines.h"
#include "hal/basis/basis_writer.h"

/* Limits of residuals, and weights of lights and pixels. A residual within its limits keeps the
 * error asked for while its light shines alone. */

/* Sets the limits and weights of a part. Call it after parts_expose(), and whenever its light_share
 * has changed. */
void part_limit(struct part *part, const struct encode_settings *settings,
		const struct levels *levels);

/* Tells whether a light's residual left [rows] is within its limits. */
bool part_cell_holds(const struct part *part, int light, const float *left);

/*
 * The low-rank part of one set of samples. It is the sum of two bases: mono has one channel, which
 * is multiplied by a tint to give three, and colour has three channels. Either may be absent.
 */

struct low_rank {
	const struct encode_settings *settings;
	const struct part *part;
	bool mono, colour; /* tell which of the two exist */
	bool tinted;	   /* mono has a tint */
	bool found;	   /* fit_find() was called for this part */
	uint16_t tint[3][PART_PIXELS];
	float tint_share[3][PART_PIXELS]; /* tint / 2^15; 1 where there is no tint */
	const float *mono_value;	  /* [lights][pixels] */
	const float *colour_value;	  /* [lights][rows] */
	float *own_mono, *own_colour;	  /* their memory, where it is not the part's */
	struct rank_finder finder;
	struct rank_patterns mono_patterns, colour_patterns;
	float *tinted_rows; /* [RANK_MOST][rows]: mono's coefficients times the tint */
	int mono_rank, colour_rank;
	double excess;	  /* largest estimated error under a sky, as a multiple of the target */
	double cut_share; /* the blocks' share of the cut (basis_format.h) */
	float *left;	  /* [lights][rows]: residual after mono_rank and colour_rank patterns */
	size_t mono_room, colour_room, left_room;
};

int fit_create(struct low_rank *fit, const struct encode_settings *settings);
void fit_free(struct low_rank *fit); /* zeroed is fine */

/* Splits a part into mono and colour. -ENOMEM. */
int fit_begin(struct low_rank *fit, const struct part *part);

/* Finds the patterns that leave the least weighted squared error. -EDOM: weights are not finite. */
int fit_find(struct low_rank *fit);

/* Sets the ranks, lowered to the number of patterns found, and computes the residual. */
void fit_set_ranks(struct low_rank *fit, int mono_rank, int colour_rank);

/* Returns the residual [rows] of a light. */
static inline const float *fit_left(const struct low_rank *fit, int light)
{
	return fit->left + (size_t)light * (size_t)fit->part->rows;
}

/* Finds the channel one[pixels] that, times the tint, is nearest to three[3 * pixels] (least
 * squares). */
void fit_untint(const struct low_rank *fit, const float *three, float *one);

/* Residual columns: the residuals that a fit's patterns leave of single lights, and of groups of
 * lights, quantised as in the file. */

/* One column as stored: scale * value. */
struct column {
	int number; /* index of its light, or number of lights + index of its group */
	int channels, bits;
	bool second; /* it holds the residual that the light's column before it leaves */
	float scale;
	size_t bytes;			  /* bytes that its values take in a file */
	uint8_t code[BASIS_RECORD_LINES]; /* if bits is 8: codes of its lines (basis_lines.h) */
	int16_t *value;			  /* [channels * pixels] */
};

/* The columns of a part: those of lights, ascending, then those of groups. */
struct columns {
	struct column *column;
	int count, room;
	int16_t *value; /* memory of the columns' values */
};

/* A group has a column only if this many of its lights have one, as otherwise there is nothing in
 * common, and if it reaches at least this far, times the block's share of the cut: S is at most
 * BASIS_GROUP_MOST times the cut, so that it would never be read. */
#define COLUMN_GROUP_LIGHTS 2
#define COLUMN_GROUP_REACH (1.0 / BASIS_GROUP_MOST)

/* Returns the largest integer that a column of 8 or 16 bits stores. */
static inline int column_most(int bits)
{
	return bits == 8 ? INT8_MAX : INT16_MAX;
}

int columns_create(struct columns *columns, const struct encode_settings *settings);
void columns_free(struct columns *columns); /* zeroed is fine */

/*
 * Finds the columns that a fit needs at its ranks: none for a light whose residual is within its
 * limits, else the cheapest that bring it there, or the finest.
 */
void columns_find(struct columns *columns, const struct low_rank *fit);

/* Chooses the ranks of a fit: the cheapest, by estimates, whose estimated errors under the tried
 * skies are within those asked for. */

/* A plan: a pair of ranks and a share of the cut, with the estimates for it. */
struct rank_plan {
	int mono_rank, colour_rank;
	double cost;	  /* bytes of the file plus weighted bytes that a frame reads */
	double excess;	  /* largest error under a sky, as a multiple of the target */
	double cut_share; /* the blocks' share of the cut (basis_format.h) */
};

/* A column of a light whose residual is beyond its limits. */
struct estimate_column {
	int light;
	bool mono;   /* it has one channel */
	float reach; /* largest |residual| */
	float bytes;
};

/* Sums over the columns of a group's lights that have the same number of channels. */
struct estimate_group {
	int columns; /* number of these columns */
	float reach; /* largest |value| that the group's column can have: sum of q_i reach_i */
	float bytes;
};

/* The largest shares of the cut at which a frame reads a column under a sky, and its group's
 * column; 0 where there is none. */
struct estimate_use {
	float own, group;
};

struct choose {
	const struct encode_settings *settings;
	const struct levels *levels;
	const struct shade *shade;
	struct encode_target asked;
	struct estimate_column *column; /* [lights] */
	int columns;
	struct estimate_use *use;	 /* [tried][lights]: by sky and place in column */
	struct estimate_group *group[2]; /* [groups]: sums of colour columns, of mono columns */
	/* These are about the skies that are tried. */
	int order[ENSEMBLE_SKIES_MAX]; /* the sky for which the cut was lowered last is first */
	float *gain;		       /* [tried][3][pixels]: levels per unit of a residual sum */
	float *mono_sky, *colour_sky;  /* [tried][3][RANK_MOST]: the sky's light times a pattern */
};

int choose_create(struct choose *choose, const struct encode_settings *settings,
		  const struct levels *levels);
void choose_free(struct choose *choose); /* zeroed is fine */

/* Finds the fit's patterns and sets its ranks. asked: the errors to keep under the skies that shade
 * tries. -EDOM: weights are not finite. */
int choose_ranks(struct choose *choose, struct low_rank *fit, const struct shade *shade,
		 const struct encode_target *asked);

/* The allowance of each part of a tile: the errors that its ranks and columns aim at. They are the
 * target at first, and smaller where the measured errors are too large. */

struct allowance {
	struct encode_target asked; /* errors under skies that ranks are chosen for */
	bool chosen;		    /* the ranks are chosen and stay as they are */
};

/* The parts of a tile, with their allowances. */
struct allowed {
	struct part *part;
	const struct low_rank *fit;
	struct allowance *allowance;
	int count;
	const struct encode_settings *settings;
	const struct shade *shade;
};

/* Sets the allowances of the first attempt. */
void allow_target(const struct allowed *allowed);

/* Lowers the allowances after an attempt (0, 1, ...) whose errors are too large. */
void allow_less(const struct allowed *allowed, const struct measure *measure, int attempt);

/* A list of blocks. Their memory is kept for the next tile. */
struct block_list {
	struct basis_block_payload *block; /* [count] */
	struct block_room {
		void *data;
		size_t bytes;
	} * room;
	int count, places; /* blocks in use, and elements of both arrays */
};

void block_list_free(struct block_list *list); /* zeroed is fine */

/* Adds the blocks that hold a fit's patterns, at its ranks, and the columns. -ENOMEM. */
int block_build(struct block_list *list, const struct low_rank *fit, const struct columns *columns,
		int tile);

/* Adds one block that has every light's column in 16 bits, for the exact layer. Adds none for a
 * part that is 0 everywhere, unless it is of kind U. -ENOMEM. */
int block_build_exact(struct block_list *list, const struct encode_settings *settings,
		      const struct part *part, int tile);

/* Adds a block of zeros, for a U without blocks whose D has some. -ENOMEM. */
int block_build_zero(struct block_list *list, const struct encode_settings *settings,
		     const struct part *part, int tile);

#endif
