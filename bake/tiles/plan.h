/* SPDX-License-Identifier: MIT */
/* What is settled before a bake's first tile: everything of a basis file that no tile changes. */
#ifndef INLAY_BAKE_TILES_PLAN_H
#define INLAY_BAKE_TILES_PLAN_H

#include "hal/base/fault.h"
#include "hal/basis/basis_format.h"
#include "hal/optics/dome.h"

#define PLAN_TEXT_MAX 4096

struct plan {
	struct basis_info_chunk info;	/* errors and noise come with the tiles */
	struct basis_light *light;	/* [info.lights] */
	double *ground;			/* [info.grounds][3][info.lights]; NULL: none */
	struct basis_coarse *gather;	/* [info.lights]; NULL where info.coarse is info.lights */
	struct basis_pose_name *names;	/* [info.poses]; NULL: they have none */
	char camera[PLAN_TEXT_MAX];	/* INI */
	char provenance[PLAN_TEXT_MAX]; /* key = value lines: nothing that differs from run to run
					 */
};

/* The lights, and the coarse ones that they are gathered in: those of a dome of frequency coarse;
 * 0: as is best. Sets what info says of them, and column_cut, where that is negative, to what fits
 * their number. -ENOMEM. */
int plan_set_lights(struct plan *plan, const struct dome *dome, int coarse, struct fault *fault);

void plan_free(struct plan *plan); /* idempotent; zeroed is fine */

/* Tiles of a pose. */
int plan_tiles(const struct plan *plan);

#endif
