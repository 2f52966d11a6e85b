/* SPDX-License-Identifier: MIT */
/*
 * A basis file, read and checked. basis_open() validates everything before it returns, so code that
 * reads blocks needs no checks. Layout: basis_format.h.
 */
#ifndef INLAY_HAL_BASIS_BASIS_H
#define INLAY_HAL_BASIS_BASIS_H

#include <stdbool.h>
#include <stddef.h>

#include "hal/base/fault.h"
#include "hal/basis/basis_format.h"

/* One block, with pointers to its arrays (basis_format.h). */
struct basis_block {
	enum basis_kind kind;
	int pixels, channels, bits, ground;
	int patterns, columns;
	int stride;		    /* int16 values of one pattern, padding included */
	const uint16_t *pixel;	    /* [pixels] */
	const uint16_t *tint;	    /* [3][pixels]; NULL: 1 everywhere */
	const float *pattern_scale; /* [patterns] */
	const int16_t *pattern;	    /* [patterns][stride] */
	const int16_t *coefficient; /* [channels][panels16][patterns][32] */
	const uint16_t *light;	    /* [columns] */
	const float *column_scale;  /* [columns] */
	float cut_share;	    /* in (0, 1], of column_cut and of the cut of groups */
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

/* All tiles of a pose in one encoding, shown or exact. */
struct basis_layer {
	struct basis_tile *tiles; /* [tiles_down][tiles_across] */
	struct basis_block *blocks;
	int block_count;
};

/* Only poses in memory have blocks and coverage: see basis_pose_load(). */
struct basis_pose {
	const uint16_t *coverage;	   /* [height][width] */
	const float (*peak)[3];		   /* [lights + 1] */
	const struct basis_glass *glass;   /* [glass_count] */
	size_t glass_count;		   /* 0: the object shows no background */
	const struct basis_mirror *mirror; /* [mirror_count] */
	size_t mirror_count; /* 0: the object mirrors nothing of the fisheye's picture */
	const struct basis_places *places; /* NULL: they are not known (basis_places.h) */
	struct basis_layer shown;
	struct basis_layer exact; /* tiles is NULL where it is absent or was not opened */
	unsigned turn;		  /* counts how often its blocks entered or left memory */
};

struct basis {
	struct basis_info_chunk info;
	const struct basis_light *lights;
	const double *ground;		     /* [grounds][3][lights] */
	const struct basis_coarse *coarse;   /* [lights]; NULL: each light is a coarse light */
	const struct basis_pose_name *names; /* [poses]; NULL: no pose has a name */
	const struct basis_footprint *feet;  /* [poses]; NULL: they are not known */
	const char *camera;		     /* INI text, NUL-terminated; empty when absent */
	const char *provenance;
	int tiles_across, tiles_down;
	struct basis_pose *poses;
	/* private */
	void *map;
	size_t map_bytes;
	struct basis_store *store; /* NULL: no pose is packed */
};

enum basis_part {
	BASIS_SHOWN,	  /* the exact layer is neither read nor checked */
	BASIS_WITH_EXACT, /* -ENODATA when a pose has none */
	BASIS_ALL,	  /* the exact layer too, where there is one */
};

/*
 * Opens and checks a file. It is read into memory, so later changes of the file have no effect.
 * With BASIS_ALL it is mapped instead and must not change while it is open. Errors: -ENOENT and
 * others of open() and read(), -EBADMSG for a file that is damaged, truncated, inconsistent or no
 * basis file (the fault says what and where), -ENOTSUP for another version, -ENODATA as above,
 * -ENOMEM. On failure nothing stays open.
 */
int basis_open(struct basis *basis, const char *path, enum basis_part part, struct fault *fault);

/* The same for a file in memory, for tests and fuzzing. data must be aligned to BASIS_ALIGN and
 * stay valid and unchanged until basis_close(). */
int basis_open_memory(struct basis *basis, const void *data, size_t bytes, const char *name,
		      enum basis_part part, struct fault *fault);

void basis_close(struct basis *basis); /* idempotent; zeroed is fine */

/* Whether the provenance has BASIS_PREVIEW_LINE. */
bool basis_is_preview(const struct basis *basis);

/* Name of a pose; "" where it has none. */
const char *basis_pose_name(const struct basis *basis, int pose);

/* Counts the pixels that mirror the fisheye's picture. */
long basis_pose_mirrored(const struct basis_pose *pose);

/* Returns the pose of that number or name; -EINVAL: there is none. */
int basis_find_pose(const struct basis *basis, const char *text, struct fault *fault);

/*
 * A file of several poses holds them packed; basis_open() unpacks pose 0. Only one thread at a time
 * may call the functions below or read blocks.
 *
 * Brings a pose into memory, where it stays until basis_poses_expect() is called without it. Waits
 * for all processors to unpack it, unless it was unpacked ahead. -ENOMEM; -EIO and the like;
 * -EBADMSG if the file has changed since it was checked. A failure is remembered and returned at
 * once by further calls, until the next basis_poses_expect().
 */
int basis_pose_load(const struct basis *basis, int pose, struct fault *fault);

/* Announces the poses that will be needed, in this order; they may include the one in use. A thread
 * unpacks those that are not in memory, also those that failed before. All other poses are dropped.
 * Entries beyond BASIS_EXPECT_MAX are ignored. */
#define BASIS_EXPECT_MAX 8
void basis_poses_expect(const struct basis *basis, const int *poses, int count);

/* Whether basis_pose_load() would return at once, with success or failure. An expected pose becomes
 * ready and stays ready as long as it is expected. */
bool basis_pose_ready(const struct basis *basis, int pose);

/* Index of the tile that contains this pixel. */
static inline int basis_tile_of(const struct basis *basis, int x, int y)
{
	return y / BASIS_TILE * basis->tiles_across + x / BASIS_TILE;
}

static inline int basis_glass_tile(const struct basis *basis, const struct basis_glass *glass)
{
	return basis_tile_of(basis, glass->x, glass->y);
}

/* Ground term u of a channel: [lights]. */
const double *basis_ground(const struct basis *basis, int ground, int channel);

#endif
