/* SPDX-License-Identifier: MIT */
#include "hal/compositor/mirror.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/kernels/kernels.h"

/* Look-ups ahead of that which is read whose texels are fetched. */
#define FETCH_AHEAD 8

int mirror_plan_create(struct mirror_plan *plan, const struct basis *basis,
		       const struct basis_pose *pose)
{
	const size_t tiles = (size_t)basis->tiles_across * (size_t)basis->tiles_down;

	*plan = (struct mirror_plan){.mirror = pose->mirror, .least = -1};
	if (!pose->mirror_count)
		return 0;
	plan->count = pose->mirror_count;
	plan->first = calloc(tiles + 1, sizeof(*plan->first));
	plan->look = calloc(plan->count + FETCH_AHEAD, sizeof(*plan->look));
	if (!plan->first || !plan->look) {
		mirror_plan_free(plan);
		return -ENOMEM;
	}
	for (size_t i = 0; i < plan->count; i++) {
		const int x = plan->mirror[i].x, y = plan->mirror[i].y;

		plan->first[basis_tile_of(basis, x, y) + 1]++;
		plan->look[i].pixel = (uint16_t)(y % BASIS_TILE * BASIS_TILE + x % BASIS_TILE);
	}
	for (size_t t = 0; t < tiles; t++)
		plan->first[t + 1] += plan->first[t];
	return 0;
}

void mirror_plan_free(struct mirror_plan *plan)
{
	free(plan->first);
	free(plan->look);
	*plan = (struct mirror_plan){.mirror = NULL};
}

void mirror_plan_aim(struct mirror_plan *plan, const struct mirror_map *map)
{
	if (plan->least == map->least)
		return;
	for (size_t i = 0; i < plan->count; i++)
		mirror_look_aim(&plan->look[i], &plan->mirror[i], map->least);
	plan->least = map->least;
}

/* Light in Q24, rounded, at most KERNEL_LIMIT. */
static inline mirror_integers round_light(mirror_light light)
{
	const mirror_light limit = {KERNEL_LIMIT, KERNEL_LIMIT, KERNEL_LIMIT, KERNEL_LIMIT};
	const mirror_integers below = light < limit;

	return __builtin_convertvector((mirror_light)(((mirror_integers)light & below) |
						      ((mirror_integers)limit & ~below)) +
					       0.5F,
				       mirror_integers);
}

void mirror_add(const struct mirror_plan *plan, int tile, const struct mirror_map *map,
		mirror_light factor, struct tile_values *values)
{
	mirror_light sum[BLOCK_PIXELS];
	mirror_integers more[BLOCK_PIXELS];

	if (plan->first[tile] == plan->first[tile + 1])
		return;
	memset(sum, 0, sizeof(sum));
	for (uint32_t i = plan->first[tile]; i < plan->first[tile + 1]; i++) {
		mirror_look_fetch(map, &plan->look[i + FETCH_AHEAD]);
		sum[plan->look[i].pixel] += mirror_look_read(map, &plan->look[i]);
	}
	for (int p = 0; p < BLOCK_PIXELS; p++)
		more[p] = round_light(sum[p] * factor);
	for (int c = 0; c < 3; c++)
		for (int p = 0; p < BLOCK_PIXELS; p++) {
			const int32_t value = values->object[c][p];
			const int32_t room = KERNEL_LIMIT - (value > 0 ? value : 0);

			values->object[c][p] = value + (more[p][c] < room ? more[p][c] : room);
		}
}
