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
	int tiles;		       /* how many; 0: none, and nothing below is set */
	int pose, x, y, width, height; /* the worst one: its pose and rectangle, in pixels */
	const char *what, *option;     /* its largest error, as a multiple of the target; which
					  option sets this target */
	double error, target;	       /* this error, in 8-bit levels */
};

struct assembly_report {
	uint64_t rays;
	struct basis_info_chunk info;	   /* with the declared errors */
	uint64_t shown_bytes, exact_bytes; /* of all blocks */
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

/* Ends a pose after its last tile; the next tile is the first of the next pose. peak: [lights +
 * 1][3] (BASIS_CHUNK_PEAK). foot: NULL where it is not known; then the file has none of any pose. */
int assembly_pose_end(struct assembly *assembly, const float (*peak)[3],
		      const struct basis_footprint *foot, struct fault *fault);

/* Finishes the file after the last pose. Frees the assembly, also on failure. */
int assembly_finish(struct assembly *assembly, struct assembly_report *report, struct fault *fault);

/* Logs what missed the target in the file at path, and what helps. Returns the exit status of the
 * command: EXIT_SUCCESS or EXIT_MISSED. */
int assembly_conclude(const struct assembly_miss *miss, const char *path);

/* Drops the file and frees the assembly. NULL is harmless. */
void assembly_abandon(struct assembly *assembly);

#endif
