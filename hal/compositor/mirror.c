/* SPDX-License-Identifier: MIT */
#include "hal/compositor/mirror.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#include "hal/compositor/kernels/kernels.h"

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
		mirror_light factor, struct tile_values *values)
{
	for (uint32_t i = plan->first[tile]; i < plan->first[tile + 1]; i++) {
		const struct basis_mirror *m = &plan->mirror[i];
		const int p = m->y % BASIS_TILE * BASIS_TILE + m->x % BASIS_TILE;
		const mirror_light throughput = {m->throughput[0], m->throughput[1],
						 m->throughput[2], 0};
		const mirror_light light = mirror_map_look(map, m) * (throughput * factor);

		for (int c = 0; c < 3; c++) {
			const float most = KERNEL_LIMIT; /* rounded up by 1 at most */
			const int64_t sum = values->object[c][p] +
					    lrintf(light[c] < most ? light[c] : most);

			values->object[c][p] = (int32_t)(sum > KERNEL_LIMIT ? KERNEL_LIMIT : sum);
		}
	}
}
