/* SPDX-License-Identifier: MIT */
/* Writes finished tiles, in their order, to a basis file, and sums their statistics. */
#ifndef INLAY_BAKE_TILES_ASSEMBLY_H
#define INLAY_BAKE_TILES_ASSEMBLY_H

#include <stdbool.h>

#include "bake/tiles/finished_tile.h"
#include "bake/tiles/plan.h"
#include "hal/base/fault.h"

/* Tiles whose measured error is larger than was asked for (struct encode_target). */
struct assembly_miss {
	int tiles;		       /* number of these; 0: nothing below is set */
	int pose, x, y, width, height; /* pose and rectangle of the worst tile, in pixels */
	const char *what, *option;     /* name of its worst error, and the option of its target */
	double error, target;	       /* that error and target, in 8-bit levels */
};

struct assembly_report {
	uint64_t rays;
	struct basis_info_chunk info;	   /* includes the declared errors */
	uint64_t shown_bytes, exact_bytes; /* sizes of all blocks */
	bool object_seen;		   /* some pixel shows the object */
	struct assembly_miss miss;
};

struct assembly;

/* Begins a basis file, which appears at path when it is finished. plan must outlive the
 * assembly. The target of assembly_miss is read from the plan's provenance, which shards hold
 * too. */
int assembly_open(struct assembly **assembly, const struct plan *plan, const char *path,
		  struct fault *fault);

/* Adds the next tile. All sums are made in the order of tiles, so that the file does not depend on
 * threads or shards. */
int assembly_add(struct assembly *assembly, const struct finished_tile *tile, struct fault *fault);

/* Ends a pose after its last tile; the next tile is the first of the next pose. peak [lights +
 * 1][3] is that of BASIS_CHUNK_PEAK. If foot is NULL for one pose, the file has no footprints. */
int assembly_pose_end(struct assembly *assembly, const float (*peak)[3],
		      const struct basis_footprint *foot, struct fault *fault);

/* Finishes the file after the last pose. Frees the assembly, also on failure. */
int assembly_finish(struct assembly *assembly, struct assembly_report *report, struct fault *fault);

/* Logs by how much tiles of the file at path missed the target, and which option helps. Returns the
 * exit status of the command: EXIT_SUCCESS or EXIT_MISSED. */
int assembly_conclude(const struct assembly_miss *miss, const char *path);

/* Drops the file and frees the assembly. NULL is harmless. */
void assembly_abandon(struct assembly *assembly);

#endif
