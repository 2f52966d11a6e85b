/*
 * A basis file, mapped and checked: everything is validated before basis_open() returns, so whoever
 * reads blocks afterwards needs no checks. Layout: basis_format.h.
 */
#ifndef INLAY_HAL_BASIS_BASIS_H
#define INLAY_HAL_BASIS_BASIS_H

#include <stdbool.h>
#include <stddef.h>

#include "hal/basis/basis_format.h"
#include "hal/fault.h"

/* One block, its arrays located (basis_format.h). */
struct basis_block {
	enum basis_kind kind;
	int pixels, channels, bits, ground;
	int patterns, columns;
	int stride;		    /* of a pattern */
	const uint16_t *pixel;	    /* [pixels] */
	const uint16_t *tint;	    /* [3][pixels]; NULL: 1 */
	const float *pattern_scale; /* [patterns] */
	const int16_t *pattern;	    /* [patterns][stride] */
	const int16_t *coefficient; /* [panels16][channels][patterns][32] */
	const uint16_t *light;	    /* [columns] */
	const float *column_scale;  /* [columns] */
	const int16_t *column16;    /* [panels16][channels][columns][32]; NULL unless bits is 16 */
	const int8_t *column8;	    /* [panels8][channels][columns][64]; NULL unless bits is 8 */
	size_t bytes;
};

struct basis_tile {
	int x, y, width, height; /* the tile's rectangle in the picture */
	const struct basis_block *blocks;
	int block_count; /* 0: the object changes nothing here */
	size_t bytes;
};

/* All tiles of a pose in one encoding. */
struct basis_layer {
	struct basis_tile *tiles; /* [tiles_down][tiles_across] */
	struct basis_block *blocks;
	int block_count;
};

struct basis_pose {
	const uint16_t *coverage; /* [height][width] */
	const float (*peak)[3];	  /* [lights + 1] */
	struct basis_layer shown;
	struct basis_layer exact; /* tiles is NULL where the file has none or was opened without */
};

struct basis {
	struct basis_info_chunk info;
	const struct basis_light *lights;
	const double *ground;		   /* [grounds][3][lights] */
	const struct basis_coarse *coarse; /* [lights]; NULL: each light is its own */
	const char *camera;		   /* INI text, NUL-terminated; empty when absent */
	const char *provenance;
	int tiles_across, tiles_down;
	struct basis_pose *poses;
	/* private */
	void *map;
	size_t map_bytes;
};

enum basis_part {
	BASIS_SHOWN,	  /* the exact layer, if there is one, is neither read nor checked */
	BASIS_WITH_EXACT, /* -ENODATA when a pose has none */
	BASIS_ALL,	  /* the exact layer where there is one */
};

/* -ENOENT..., -EBADMSG for a file that is damaged, truncated, inconsistent or not one of ours (the
 * fault says what and where), -ENOTSUP for another version, -ENODATA as above. Nothing is left open
 * on failure. */
int basis_open(struct basis *basis, const char *path, enum basis_part part, struct fault *fault);

/* The same from memory, which must stay (for tests and fuzzing). data is page-aligned or at least
 * aligned to BASIS_ALIGN. */
int basis_open_memory(struct basis *basis, const void *data, size_t bytes, const char *name,
		      enum basis_part part, struct fault *fault);

void basis_close(struct basis *basis); /* idempotent; zeroed is fine */

const double *basis_ground(const struct basis *basis, int ground, int channel); /* [lights] */

#endif
