/* SPDX-License-Identifier: MIT */
/*
 * A basis file, read and checked: everything is validated before basis_open() returns, so whoever
 * reads blocks afterwards needs no checks. Layout: basis_format.h.
 */
#ifndef INLAY_HAL_BASIS_BASIS_H
#define INLAY_HAL_BASIS_BASIS_H

#include <stdbool.h>
#include <stddef.h>

#include "hal/base/fault.h"
#include "hal/basis/basis_format.h"

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
	const int16_t *coefficient; /* [channels][panels16][patterns][32] */
	const uint16_t *light;	    /* [columns] */
	const float *column_scale;  /* [columns] */
	const int16_t *column16;    /* [channels][panels16][columns][32]; NULL unless bits is 16 */
	const uint32_t *record_at;  /* [columns]; NULL unless bits is 8 */
	const uint8_t *record;	    /* basis_lines.h; NULL unless bits is 8 */
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

/* Of a file that holds several, only those that are in memory have blocks and coverage:
 * basis_pose_load(). */
struct basis_pose {
	const uint16_t *coverage;	 /* [height][width] */
	const float (*peak)[3];		 /* [lights + 1] */
	const struct basis_glass *glass; /* [glass_count] */
	size_t glass_count;		 /* 0: nothing is seen through the object */
	struct basis_layer shown;
	struct basis_layer exact; /* tiles is NULL where the file has none or was opened without */
	unsigned turn;		  /* how often its blocks have come into memory, or left it */
};

struct basis {
	struct basis_info_chunk info;
	const struct basis_light *lights;
	const double *ground;		     /* [grounds][3][lights] */
	const struct basis_coarse *coarse;   /* [lights]; NULL: each light is its own */
	const struct basis_pose_name *names; /* [poses]; NULL: they have none */
	const char *camera;		     /* INI text, NUL-terminated; empty when absent */
	const char *provenance;
	int tiles_across, tiles_down;
	struct basis_pose *poses;
	/* private */
	void *map;
	size_t map_bytes;
	struct basis_store *store; /* NULL: all poses lie in place */
};

enum basis_part {
	BASIS_SHOWN,	  /* the exact layer, if there is one, is neither read nor checked */
	BASIS_WITH_EXACT, /* -ENODATA when a pose has none */
	BASIS_ALL,	  /* the exact layer where there is one */
};

/* The file is read into memory, and whatever becomes of it changes nothing; but for BASIS_ALL it is
 * mapped, and has to stay as it is. -ENOENT..., -EBADMSG for a file that is
 * damaged, truncated, inconsistent or not one of ours (the fault says what and where), -ENOTSUP for
 * another version, -ENODATA as above. Nothing is left open on failure. */
int basis_open(struct basis *basis, const char *path, enum basis_part part, struct fault *fault);

/* The same from memory, which must stay (for tests and fuzzing). data is page-aligned or at least
 * aligned to BASIS_ALIGN. */
int basis_open_memory(struct basis *basis, const void *data, size_t bytes, const char *name,
		      enum basis_part part, struct fault *fault);

void basis_close(struct basis *basis); /* idempotent; zeroed is fine */

/* "" where it has none. */
const char *basis_pose_name(const struct basis *basis, int pose);

/* The pose of that number or name; -EINVAL. */
int basis_find_pose(const struct basis *basis, const char *text, struct fault *fault);

/*
 * Poses of a file that holds several lie packed in it; pose 0 is in memory when the file is opened.
 * One thread at a time uses the poses: loads them, expects others, reads blocks.
 *
 * Load: the pose is in memory from here on, until another set is expected without it. It may have
 * been unpacked ahead; else all processors do it now. -ENOMEM; -EIO..., -EBADMSG if the file was
 * changed since it was checked. What has failed fails again at once, until poses are expected anew.
 */
int basis_pose_load(const struct basis *basis, int pose, struct fault *fault);

/* Expect: these poses, some of which may be in use, will be needed in this order: a thread unpacks
 * what is not there yet, what could not be loaded before too, and all others are dropped. At most
 * BASIS_EXPECT_MAX count. */
#define BASIS_EXPECT_MAX 8
void basis_poses_expect(const struct basis *basis, const int *poses, int count);

/* Whether loading it takes no longer than a lock. It comes to be so only of those that are
 * expected, and stays so as long as they are. One that cannot be unpacked is ready to fail. */
bool basis_pose_ready(const struct basis *basis, int pose);

/* The tile of a pixel that is seen through. */
static inline int basis_glass_tile(const struct basis *basis, const struct basis_glass *glass)
{
	return glass->y / BASIS_TILE * basis->tiles_across + glass->x / BASIS_TILE;
}

const double *basis_ground(const struct basis *basis, int ground, int channel); /* [lights] */

#endif
