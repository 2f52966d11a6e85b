/* SPDX-License-Identifier: MIT */
/*
 * What the object mirrors of the sky (struct basis_mirror). Its light is added to O. Private to
 * hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_MIRROR_H
#define INLAY_HAL_COMPOSITOR_MIRROR_H

#include "hal/compositor/tile.h"
#include "hal/mirror/mirror_map.h"

/* The mirrors of one pose. */
struct mirror_plan {
	const struct basis_mirror *mirror; /* sorted by tile */
	uint32_t *first;		   /* [tiles + 1]: first of each tile; NULL: none */
};

/* -ENOMEM. */
int mirror_plan_create(struct mirror_plan *plan, const struct basis *basis,
		       const struct basis_pose *pose);
void mirror_plan_free(struct mirror_plan *plan); /* idempotent; zeroed is fine */

/* Adds to values->object. factor: of each channel, of throughput times light: the gain as
 *     2^24 / 65535 * gain */
void mirror_add(const struct mirror_plan *plan, int tile, const struct mirror_map *map,
		mirror_light factor, struct tile_values *values);

#endif
