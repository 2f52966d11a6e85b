/* SPDX-License-Identifier: MIT */
/*
 * What the object mirrors of the sky (struct basis_mirror). Its light is added to O. Private to
 * hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_MIRROR_H
#define INLAY_HAL_COMPOSITOR_MIRROR_H

#include "hal/compositor/tile.h"
#include "hal/mirror/mirror_look.h"

/* The mirrors of one pose. */
struct mirror_plan {
	const struct basis_mirror *mirror; /* [count]: sorted by tile */
	size_t count;
	struct mirror_look *look; /* [count]: and a few that are only fetched */
	uint32_t *first;	  /* [tiles + 1]: first of each tile; NULL: none */
	int least;		  /* the maps' first level that look is for; -1: none yet */
};

/* -ENOMEM. */
int mirror_plan_create(struct mirror_plan *plan, const struct basis *basis,
		       const struct basis_pose *pose);
void mirror_plan_free(struct mirror_plan *plan); /* idempotent; zeroed is fine */

/* Prepares the look-ups for a map, unless its first level is that of the map before. */
void mirror_plan_aim(struct mirror_plan *plan, const struct mirror_map *map);

/* Adds to values->object. factor: of each channel, of what is looked up: the gain as
 *     2^24 / 65535 / MIRROR_LOOK_ONE * gain */
void mirror_add(const struct mirror_plan *plan, int tile, const struct mirror_map *map,
		mirror_light factor, struct tile_values *values);

#endif
