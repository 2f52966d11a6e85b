/* SPDX-License-Identifier: MIT */
#include "hal/compositor/glass.h"

#include <errno.h>
#include <stdlib.h>

#include "hal/compositor/kernels/fixed.h"
#include "hal/compositor/kernels/kernels.h"

#define RATIO_MAX ((int64_t)COMPOSITOR_RATIO_MAX << 24)

/* ---- creation ---- */

static int clamped_to(int at, int count)
{
	return at < 0 ? 0 : at >= count ? count - 1 : at;
}

/* The rectangle along one axis: its ends in steps, and the first and last pixel that it cuts. */
struct side {
	int from, to, first, last;
};

static int pixel_of_steps(int steps)
{
	return (steps - (steps & (BASIS_GLASS_STEP - 1))) / BASIS_GLASS_STEP;
}

static struct side side_of(int pixel, int offset, int spread)
{
	const int length = BASIS_GLASS_STEP + spread * (BASIS_GLASS_STEP / BASIS_GLASS_SPREAD);
	const int from = pixel * BASIS_GLASS_STEP + BASIS_GLASS_STEP / 2 + offset - length / 2;
	const int to = from + length;

	return (struct side){from, to, pixel_of_steps(from), pixel_of_steps(to - 1)};
}

/* Returns how many steps of a pixel are in the rectangle. */
static int weight_in(const struct side *side, int pixel)
{
	const int from = pixel * BASIS_GLASS_STEP, to = from + BASIS_GLASS_STEP;

	return (to < side->to ? to : side->to) - (from > side->from ? from : side->from);
}

/* Marks the tiles that a glass pixel shows. */
static void mark_looked_at(const struct basis *basis, const struct basis_glass *g,
			   uint8_t *looked_at)
{
	const int width = (int)basis->info.width, height = (int)basis->info.height;
	const struct side across = side_of(g->x, g->dx, g->spread[0]);
	const struct side down = side_of(g->y, g->dy, g->spread[1]);
	const int right = clamped_to(across.last, width) / BASIS_TILE;
	const int bottom = clamped_to(down.last, height) / BASIS_TILE;

	for (int y = clamped_to(down.first, height) / BASIS_TILE; y <= bottom; y++)
		for (int x = clamped_to(across.first, width) / BASIS_TILE; x <= right; x++)
			looked_at[y * basis->tiles_across + x] = 1;
}

/* Lists runs of marked tiles as areas. */
static int list_sources(struct glass_plan *plan, const struct basis *basis,
			const uint8_t *looked_at)
{
	const int tiles = basis->tiles_across * basis->tiles_down;

	plan->source = calloc((size_t)tiles, sizeof(*plan->source));
	if (!plan->source)
		return -ENOMEM;
	for (int t = 0; t < tiles; t++) {
		const int x = t % basis->tiles_across * BASIS_TILE;
		const int y = t / basis->tiles_across * BASIS_TILE;
		const int width = (int)basis->info.width - x, height = (int)basis->info.height - y;
		const struct area area = {x, y, width < BASIS_TILE ? width : BASIS_TILE,
					  height < BASIS_TILE ? height : BASIS_TILE};
		struct area *last = plan->source_count ? &plan->source[plan->source_count - 1]
						       : NULL;

		if (!looked_at[t])
			continue;
		if (last && last->y == y && last->x + last->width == x && last->width < GLASS_SPAN)
			last->width += area.width;
		else
			plan->source[plan->source_count++] = area;
	}
	return 0;
}

int glass_plan_create(struct glass_plan *plan, const struct basis *basis,
		      const struct basis_pose *pose)
{
	const int tiles = basis->tiles_across * basis->tiles_down;
	uint8_t *looked_at;
	int ret = -ENOMEM;

	*plan = (struct glass_plan){.glass = pose->glass};
	if (!pose->glass_count)
		return 0;
	looked_at = calloc((size_t)tiles, 1);
	plan->first = calloc((size_t)tiles + 1, sizeof(*plan->first));
	if (plan->first && looked_at) {
		for (size_t i = 0; i < pose->glass_count; i++) {
			plan->first[basis_glass_tile(basis, &pose->glass[i]) + 1]++;
			mark_looked_at(basis, &pose->glass[i], looked_at);
		}
		for (int t = 0; t < tiles; t++)
			plan->first[t + 1] += plan->first[t];
		ret = list_sources(plan, basis, looked_at);
	}
	free(looked_at);
	if (ret < 0)
		glass_plan_free(plan);
	return ret;
}

void glass_plan_free(struct glass_plan *plan)
{
	free(plan->first);
	free(plan->source);
	*plan = (struct glass_plan){.glass = NULL};
}

/* ---- each frame ---- */

/* Computes the mean linear light of the picture over the rectangle of a glass pixel, 65535 = 1. */
static void glass_light(const struct picture *p, const struct basis_glass *g,
			const uint16_t *decode, uint64_t light[3])
{
	const struct side across = side_of(g->x, g->dx, g->spread[0]);
	const struct side down = side_of(g->y, g->dy, g->spread[1]);
	const uint64_t area = (uint64_t)(across.to - across.from) * (uint64_t)(down.to - down.from);
	uint64_t sum[3] = {0, 0, 0};

	for (int y = down.first; y <= down.last; y++) {
		const uint8_t *row = p->origin + clamped_to(y, p->height) * p->y_step;
		const uint64_t height = (uint64_t)weight_in(&down, y);

		for (int x = across.first; x <= across.last; x++) {
			const uint8_t *at = row + clamped_to(x, p->width) * p->x_step;
			const uint64_t weight = height * (uint64_t)weight_in(&across, x);

			for (int c = 0; c < 3; c++)
				sum[c] += weight * decode[at[2 - c]];
		}
	}
	for (int c = 0; c < 3; c++)
		light[c] = (sum[c] + area / 2) / area;
}

void glass_add(const struct glass_plan *plan, int tile, const struct picture *picture,
	       const uint16_t *decode, struct tile_values *values)
{
	for (uint32_t i = plan->first[tile]; i < plan->first[tile + 1]; i++) {
		const struct basis_glass *g = &plan->glass[i];
		const int p = g->y % BASIS_TILE * BASIS_TILE + g->x % BASIS_TILE;
		uint64_t light[3];

		glass_light(picture, g, decode, light);
		for (int c = 0; c < 3; c++) {
			const uint64_t passes = g->transmission[c] + (g->transmission[c] >> 15u);
			const uint64_t arrives = (passes * light[c] * 256 + 32767) / 65535;
			int64_t ratio = (INT64_C(1) << 24) - values->taken[c][p];
			int64_t sum;

			ratio = ratio < 0 ? 0 : ratio > RATIO_MAX ? RATIO_MAX : ratio;
			sum = values->object[c][p] + round_shift(ratio * (int64_t)arrives, 24);
			values->object[c][p] = (int32_t)(sum > KERNEL_LIMIT ? KERNEL_LIMIT : sum);
		}
	}
}
