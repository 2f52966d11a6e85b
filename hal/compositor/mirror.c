/* SPDX-License-Identifier: MIT */
#include "hal/compositor/mirror.h"

#include <errno.h>
#include <stdlib.h>

#include "hal/compositor/kernels/kernels.h"

/* Light beyond it, 4096 in Q24, is cut before the gain: even the least gain that 8 bits show leaves
 * it white. */
#define LIGHT_MOST (UINT64_C(1) << 36)

int mirror_plan_create(struct mirror_plan *plan, const struct basis *basis,
		       const struct basis_pose *pose)
{
	const size_t tiles = (size_t)basis->tiles_across * (size_t)basis->tiles_down;

	*plan = (struct mirror_plan){.mirror = pose->mirror};
	if (!pose->mirror_count)
		return 0;
	plan->first = calloc(tiles + 1, sizeof(*plan->first));
	if (!plan->first)
		return -ENOMEM;
	for (size_t i = 0; i < pose->mirror_count; i++)
		plan->first[basis_tile_of(basis, pose->mirror[i].x, pose->mirror[i].y) + 1]++;
	for (size_t t = 0; t < tiles; t++)
		plan->first[t + 1] += plan->first[t];
	return 0;
}

void mirror_plan_free(struct mirror_plan *plan)
{
	free(plan->first);
	*plan = (struct mirror_plan){.mirror = NULL};
}

void mirror_add(const struct mirror_plan *plan, int tile, const struct mirror_map *map,
		const uint32_t gain[3], struct tile_values *values)
{
	for (uint32_t i = plan->first[tile]; i < plan->first[tile + 1]; i++) {
		const struct basis_mirror *m = &plan->mirror[i];
		const int p = m->y % BASIS_TILE * BASIS_TILE + m->x % BASIS_TILE;
		uint64_t seen[3];

		mirror_map_look(map, m, seen);
		for (int c = 0; c < 3; c++) {
			const uint64_t share = m->throughput[c] + (m->throughput[c] >> 15u);
			const uint64_t light =
				(seen[c] + (1u << (MIRROR_LOOK_BITS - 25))) >> (MIRROR_LOOK_BITS - 24);
			uint64_t sum = (light * share + 32768) >> 16;
			int64_t total;

			sum = sum > LIGHT_MOST ? LIGHT_MOST : sum;
			sum = (sum * gain[c] + (1u << 19)) >> 20;
			total = values->object[c][p] + (int64_t)sum;
			values->object[c][p] =
				(int32_t)(total > KERNEL_LIMIT ? KERNEL_LIMIT : total);
		}
	}
}
