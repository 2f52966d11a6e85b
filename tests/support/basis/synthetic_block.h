/* SPDX-License-Identifier: MIT */
/* Random blocks for synthetic_basis.h, and the values of a block in double precision. */
#ifndef INLAY_TESTS_SUPPORT_BASIS_SYNTHETIC_BLOCK_H
#define INLAY_TESTS_SUPPORT_BASIS_SYNTHETIC_BLOCK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "hal/basis/basis.h"
#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_writer.h"
#include "tests/support/chance.h"

#define SYNTHETIC_PIXELS (BASIS_TILE * BASIS_TILE)
#define SYNTHETIC_LAYERS_MAX 4

struct synthetic_options {
	int width, height, lights, grounds;
	int coarse;   /* K, number of coarse lights; 0: each light is its own */
	int patterns; /* of each block */
	int columns;  /* of each block, for random lights; negative: for all lights. All, too,
				  where there would be neither patterns nor columns */
	int bits;     /* of a column's values: 8 or 16; 0: 16 */
	int layers;   /* blocks of a kind over the same pixels (U: always one); 0: 1 */
	bool grey;    /* blocks have one channel for all three ... */
	bool tinted;  /* ... times each pixel's tint */
	bool vary;    /* each block draws its own of the above six, up to these values */
	bool exact;   /* write an exact layer too */
	double object_share;   /* share of the pixels with a T row ... */
	double ground_share;   /* ... with a V row ... */
	double stand_in_share; /* ... with D and U rows; no pixel has both V and D */
	double glass_share;    /* share of the pixels that show the background through glass */
	double mirror_share;   /* share of the pixels that mirror the sky, twice */
	double unlit_share;    /* share of the pixels with D and U whose U is 0 */
	double peak;	       /* largest object radiance of a pixel under L_i = 1 */
	double bounce;	       /* v and d / u lie in -bounce..1 */
	double column_cut;     /* what the file declares */
	double cut_share;      /* of each block; 0: blocks take turns with various shares */
	int groups;	       /* the last columns of T and V are of groups, with any values */
	uint64_t seed;
};

/* A block in the making. The payload is the maker's until it is written. */
struct synthetic_block {
	struct basis_block_entry entry;
	struct basis_layout at;
	uint8_t *payload;
};

/* Pixels that blocks share: of one kind and, if that is V, one ground term. */
struct synthetic_group {
	enum basis_kind kind;
	int ground, pixels;
	uint16_t pixel[SYNTHETIC_PIXELS];
	double factor[SYNTHETIC_PIXELS]; /* v or d / u, in -bounce..1; T and U: 1 */
	bool unlit[SYNTHETIC_PIXELS];
};

/* The state of writing a file, tile by tile. */
struct synthetic_maker {
	const struct synthetic_options *options;
	const struct basis_light *light;
	const struct basis_coarse *gather; /* NULL: each light is its own coarse light */
	struct basis_writer *writer;
	struct basis_info_chunk info;
	uint16_t *coverage; /* [height][width] */
	float (*peak)[3];   /* [lights + 1]: the last is under all lights */
	int shapes;	    /* how many blocks have been shaped */
	struct chance chance;
};

/* calloc() that aborts the program when there is no memory. */
void *synthetic_zeros(size_t count, size_t size);

/*
 * value[pixels][3][lights] += what a block says of each light, per unit of X_i, in double precision
 * as basis_format.h defines it.
 */
void synthetic_add_values(const struct basis_block *b, int lights,
			  const struct basis_coarse *gather, double *value);

/* A random block of values 0..most, without the pixels' factors. */
struct synthetic_block synthetic_make(struct synthetic_maker *m, uint32_t tile,
				      const struct synthetic_group *group, double most);

/* The block as the reader would locate it; it points into the payload. */
struct basis_block synthetic_view(const struct synthetic_block *b);

/* Multiplies each pixel's values by its factor, in -1..1; values without a pixel become 0. */
void synthetic_scale_pixels(struct synthetic_block *b, const double *factor);

/* Makes the blocks of a group that lie over each other: random ones or, where `of` is not NULL,
 * changes of that one. Returns their number. */
int synthetic_layers(struct synthetic_maker *m, uint32_t tile, const struct synthetic_group *group,
		     const struct synthetic_block *of, struct synthetic_block *blocks);

/* One block of 16-bit columns for all lights that says value[pixels][3][lights]. Raises *error to
 * the largest difference. */
struct synthetic_block synthetic_exact(const struct synthetic_maker *m, uint32_t tile,
				       const struct synthetic_group *group, const double *value,
				       double *error);

#endif
