/* SPDX-License-Identifier: MIT */
/*
 * The background seen through the object (struct basis_glass). Its light is added to O, so the
 * mixing kernel needs no case for it. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_GLASS_H
#define INLAY_HAL_COMPOSITOR_GLASS_H

#include "hal/compositor/backdrop.h"
#include "hal/compositor/tile.h"

/* The glass of one pose. */
struct glass_plan {
	const struct basis_glass *glass; /* sorted by tile */
	uint32_t *first;		 /* [tiles + 1]: first entry of each tile; NULL: no glass */
	/* Areas of adjacent tiles that glass pixels show, each at most GLASS_SPAN wide. */
	struct area *source;
	int source_count;
};

#define GLASS_SPAN 128 /* in pixels; whole tiles */

/* -ENOMEM. */
int glass_plan_create(struct glass_plan *plan, const struct basis *basis,
		      const struct basis_pose *pose);
void glass_plan_free(struct glass_plan *plan); /* idempotent; zeroed is fine */

/* Adds to values->object the light of the background that arrives through the pixels of a tile.
 * decode: [256] linear light, 65535 = 1. values->taken must be complete. */
void glass_add(const struct glass_plan *plan, int tile, const struct picture *picture,
	       const uint16_t *decode, struct tile_values *values);

#endif
