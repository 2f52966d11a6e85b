/* SPDX-License-Identifier: MIT */
/* Finished tiles, in their order, to a basis file; and what they come to together. */
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
	bool object_seen;		   /* some pixel shows it */
};

struct assembly;

/* The file appears when it is whole. plan must outlive the assembly. */
int assembly_open(struct assembly **assembly, const struct plan *plan, const char *path,
		  struct fault *fault);

/* The next tile. All sums are made in the order of tiles, so that the file does not depend on who
 * made them. */
int assembly_add(struct assembly *assembly, const struct finished_tile *tile, struct fault *fault);

/* After the last tile of a pose; the next tile is the first of the next one. peak: [lights + 1][3]
 * (BASIS_CHUNK_PEAK). */
int assembly_pose_end(struct assembly *assembly, const float (*peak)[3], struct fault *fault);

/* After the last pose. Frees the assembly, also on failure. */
int assembly_finish(struct assembly *assembly, struct assembly_report *report, struct fault *fault);

void assembly_abandon(struct assembly *assembly); /* NULL is harmless */

#endif
