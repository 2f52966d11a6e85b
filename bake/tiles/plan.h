/* SPDX-License-Identifier: MIT */
/* The plan of a bake is made before its first tile: all parts of the basis file that no tile
 * changes. */
#ifndef INLAY_BAKE_TILES_PLAN_H
#define INLAY_BAKE_TILES_PLAN_H

#include "bake/encode/encode.h"
#include "hal/base/fault.h"
#include "hal/basis/basis_format.h"
#include "hal/optics/dome.h"

#define PLAN_TEXT_MAX 4096

struct plan {
	struct basis_info_chunk info;  /* without errors and noise, which come with the tiles */
	struct basis_light *light;     /* [info.lights] */
	double *ground;		       /* [info.grounds][3][info.lights]; NULL: none */
	struct basis_coarse *gather;   /* [info.lights]; NULL where info.coarse is info.lights */
	struct basis_pose_name *names; /* [info.poses]; NULL: poses have no names */
	char camera[PLAN_TEXT_MAX];    /* INI text */
	/* Lines "key = value", which are the same in each run. */
	char provenance[PLAN_TEXT_MAX];
};

/* Sets the lights and the coarse lights, their members of info, and info.column_cut if it is
 * negative (by the number of lights). coarse is the frequency of the coarse dome; 0:
 * COARSE_FREQUENCY. -ENOMEM. */
int plan_set_lights(struct plan *plan, const struct dome *dome, int coarse, struct fault *fault);

void plan_free(struct plan *plan); /* idempotent; zeroed is fine */

/* Returns the number of tiles of a pose. */
int plan_tiles(const struct plan *plan);

/* Finds the rectangle of a tile in the picture, in pixels. */
void plan_rectangle(const struct plan *plan, int tile, int *x, int *y, int *width, int *height);

/* The line of the provenance that has the errors asked for: three numbers, of struct
 * encode_target. */
#define PLAN_TARGET_LINE "target_levels = rms %g, max %g, cell %g\n"

/* Returns the errors asked for, from that line, or infinite ones if the provenance has none. */
struct encode_target plan_target(const struct plan *plan);

#endif
