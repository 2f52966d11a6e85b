/* SPDX-License-Identifier: MIT */
/* Writes finished tiles, in their order, to a basis file, and sums their statistics. */
#ifndef INLAY_BAKE_TILES_ASSEMBLY_H
#define INLAY_BAKE_TILES_ASSEMBLY_H

#include <stdbool.h>

#include "bake/tiles/finished_tile.h"
#include "bake/tiles/plan.h"
#include "hal/base/fault.h"

struct assembly_report {
	uint64_t rays;
	struct basis_info_chunk info;	   /* with the declared errors */
	uint64_t shown_bytes, exact_bytes; /* of all blocks */
	bool object_seen;		   /* some pixel shows the object */
};

struct assembly;

/* Begins a basis file, which appears at path when it is finished. plan must outlive the
 * assembly. */
int assembly_open(struct assembly **assembly, const struct plan *plan, const char *path,
		  struct fault *fault);

/* Adds the next tile. All sums are made in the order of tiles, so that the file does not depend on
 * threads or shards. */
int assembly_add(struct assembly *assembly, const struct finished_tile *tile, struct fault *fault);

/* Ends a pose after its last tile; the next tile is the first of the next pose. peak: [lights +
 * 1][3] (BASIS_CHUNK_PEAK). */
int assembly_pose_end(struct assembly *assembly, const float (*peak)[3], struct fault *fault);

/* Finishes the file after the last pose. Frees the assembly, also on failure. */
int assembly_finish(struct assembly *assembly, struct assembly_report *report, struct fault *fault);

/* Drops the file and frees the assembly. NULL is harmless. */
void assembly_abandon(struct assembly *assembly);

#endif
