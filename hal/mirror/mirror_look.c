/* SPDX-License-Identifier: MIT */
#include "hal/mirror/mirror_look.h"

/* Finds the texel at a place of one axis, and the share of the next one. */
static int find_texel(uint16_t place, int level, int *share)
{
	const int last = (BASIS_MIRROR_SIDE >> level) - 1;
	/* in 1/2^16 texels, from the middle of the first */
	const int at = (int)((uint32_t)place << (BASIS_MIRROR_BITS - level)) - 32768;
	const int within = at < 0 ? 0 : at > last << 16 ? last << 16 : at;

	*share = within & 65535;
	return within >> 16;
}

int mirror_look_places(const struct basis_mirror *m, int least, struct mirror_place place[2])
{
	const int first = least * BASIS_MIRROR_STEP;
	const int steps = m->level > first ? m->level : first, next = steps % BASIS_MIRROR_STEP;

	for (int k = 0; k < 2; k++) {
		struct mirror_place *to = &place[k];

		to->level = steps / BASIS_MIRROR_STEP + (k && next);
		to->x = find_texel(m->u, to->level, &to->right);
		to->y = find_texel(m->v, to->level, &to->down);
	}
	return next;
}

/* Codes are differences of rounded sums, so that the sum of all is MIRROR_LOOK_ONE. */
static uint16_t next_code(uint64_t *sum, uint64_t more)
{
	/* 2^40 = 1 */
	const uint64_t half = UINT64_C(1) << 39, before = (*sum * MIRROR_LOOK_ONE + half) >> 40;

	*sum += more;
	return (uint16_t)(((*sum * MIRROR_LOOK_ONE + half) >> 40) - before);
}

void mirror_look_aim(struct mirror_look *look, const struct basis_mirror *m, int least)
{
	struct mirror_place place[2];
	const int next = mirror_look_places(m, least, place);
	uint64_t sum = 0;

	for (int k = 0; k < 2; k++) {
		const struct mirror_place *p = &place[k];
		const uint64_t level = (uint64_t)(k ? next : BASIS_MIRROR_STEP - next);
		const uint64_t across[2] = {(uint64_t)(65536 - p->right), (uint64_t)p->right};
		const uint64_t down[2] = {(uint64_t)(65536 - p->down), (uint64_t)p->down};

		look->at[k] = (uint32_t)(mirror_level_at(p->level) + p->y * MIRROR_STRIDE + p->x) *
			      (uint32_t)sizeof(mirror_light);
		for (int n = 0; n < 4; n++)
			look->weight[4 * k + n] = next_code(&sum,
							    across[n % 2] * down[n / 2] * level);
	}
	memcpy(look->throughput, m->throughput, sizeof(look->throughput));
}
