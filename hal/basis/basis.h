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

/* One block, its arrays located. */
struct basis_block {
	enum basis_kind kind;
	enum basis_encoding encoding;
	int pixels, channels, lights, stride, ground;
	bool rest; /* the last of its lights is the rest (BASIS_ENCODING_DENSE) */
	const uint16_t *pixel;
	const uint16_t *light;
	const float *scale;
	const int32_t *total;
	const int16_t *row;
	size_t bytes;
};

struct basis_tile {
	int x, y, width, height; /* the tile's rectangle in the picture */
	const struct basis_block *blocks;
	int block_count; /* 0: the object changes nothing here */
	size_t bytes;
};

struct basis_pose {
	const uint16_t *coverage; /* [height][width] */
	const float (*peak)[3];	  /* [lights + 1] */
	struct basis_tile *tiles;
	struct basis_block *blocks;
	int block_count;
};

struct basis {
	struct basis_info_chunk info;
	const struct basis_light *lights;
	const double *ground; /* [grounds][3][lights] */
	const char *camera;   /* INI text, NUL-terminated; empty when absent */
	const char *provenance;
	int tiles_across, tiles_down;
	struct basis_pose *poses;
	/* private */
	void *map;
	size_t map_bytes;
};

/* -ENOENT..., -EBADMSG for a file that is damaged, truncated, inconsistent or not one of ours (the
 * fault says what and where), -ENOTSUP for a later version. Nothing is left open on failure. */
int basis_open(struct basis *basis, const char *path, struct fault *fault);

/* The same from memory, which must stay (for tests and fuzzing). data is page-aligned or at least
 * aligned to BASIS_ALIGN. */
int basis_open_memory(struct basis *basis, const void *data, size_t bytes, const char *name,
		      struct fault *fault);

void basis_close(struct basis *basis); /* idempotent; zeroed is fine */

const double *basis_ground(const struct basis *basis, int ground, int channel); /* [lights] */

#endif
