/* SPDX-License-Identifier: MIT */
/*
 * The background seen through the object (struct basis_glass): what arrives of it is added to what
 * the object gives off, so that mixing needs to know nothing of it. Private to hal/compositor.
 */
#ifndef INLAY_HAL_COMPOSITOR_GLASS_H
#define INLAY_HAL_COMPOSITOR_GLASS_H

#include "hal/compositor/backdrop.h"
#include "hal/compositor/tile.h"

/* Of one pose. */
struct glass_plan {
	const struct basis_glass *glass; /* in the order of tiles */
	uint32_t *first;		 /* [tiles + 1]: a tile's; NULL: nothing is seen through */
	/* Tiles side by side that are looked at from elsewhere, each no wider than GLASS_SPAN. */
	struct area *source;
	int source_count;
};

#define GLASS_SPAN 128 /* pixels, whole tiles */

/* -ENOMEM. */
int glass_plan_create(struct glass_plan *plan, const struct basis *basis,
		      const struct basis_pose *pose);
void glass_plan_free(struct glass_plan *plan); /* idempotent; zeroed is fine */

/* Adds to values->object what arrives of the picture through a tile's pixels. decode: [256] linear
 * light, 65535 = 1. values->taken is complete. */
void glass_add(const struct glass_plan *plan, int tile, const struct picture *picture,
	       const uint16_t *decode, struct tile_values *values);

#endif
