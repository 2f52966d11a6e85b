/* SPDX-License-Identifier: MIT */
/* One frame: light vectors and chosen columns first, then runs of tiles, shared by the threads. */
#include <errno.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/compositor/backdrop.h"
#include "hal/compositor/compositor_parts.h"
#include "hal/compositor/live/lit_rows.h"
#include "hal/compositor/steady.h"

/* Total lights of all vectors from which several threads are faster, waking them included. */
#define SHARED_LIGHTS 12000

/* ---- a run of tiles ---- */

/* Takes from a tile's values what people hide. Returns what mix_tile() needs to know of them, or
 * NULL: nobody is in the tile. */
static struct veiled_tile *veil_tile(const struct compositor *c, int t, struct compositor_worker *w)
{
	const struct veil *veil = c->settings.veil;

	if (!veil || !veil->tile[t])
		return NULL;
	veiled_tile_read(&w->veiled, veil, &c->layer->basis->tiles[t], (int)c->basis->info.width);
	return &w->veiled;
}

static uint8_t *tile_out(const struct compositor *c, const struct basis_tile *tile)
{
	return c->out + (size_t)tile->y * c->out_stride + (size_t)tile->x * 4;
}

static void mix_tile(const struct compositor *c, int t, struct compositor_worker *w,
		     struct veiled_tile *veiled, struct backdrop_rows rows)
{
	const struct basis_tile *tile = &c->layer->basis->tiles[t];
	const struct tile_plan *plan = &c->layer->plan.tiles[t];
	const size_t width = c->basis->info.width;
	struct kernel_row row = {
		.count = tile->width,
		.rows = tile->height,
		.coverage = plan->bare ? NULL : c->coverage + (size_t)tile->y * width + tile->x,
		.background = rows.pixels,
		.curves = &c->curves,
		.out = tile_out(c, tile),
		.value_step = BASIS_TILE,
		.coverage_step = (ptrdiff_t)width,
		.background_step = rows.stride,
		.out_step = (ptrdiff_t)c->out_stride,
	};

	for (int k = 0; k < 3; k++) {
		row.object[k] = plan->object ? w->values.object[k] : tile_nothing;
		row.taken[k] = plan->taken ? w->values.taken[k] : tile_nothing;
	}
	if (veiled)
		veiled_tile_show(veiled, &row);
	if (c->settings.grain)
		grain_add(c->settings.grain, c->kernels, t, &row, &w->grain);
	c->kernels->mix(&row);
}

/* Prefetches what mixing will read: the rows of a tile are too far apart for the processor's own
 * prefetcher. Forced inline because gcc 12 drops calls of functions that only prefetch. */
static inline __attribute__((always_inline)) void fetch_ahead(const struct compositor *c, int t,
							      struct backdrop_rows rows)
{
	const struct basis_tile *tile = &c->layer->basis->tiles[t];

	for (int y = 0; y < tile->height; y++) {
		const uint8_t *row = rows.pixels + y * rows.stride;

		__builtin_prefetch(row);
		__builtin_prefetch(row + tile->width * 4 - 1); /* it may lie across two lines */
		if (!c->layer->plan.tiles[t].bare)
			__builtin_prefetch(c->coverage +
					   (size_t)(tile->y + y) * c->basis->info.width + tile->x);
	}
}

/* Returns the area of the adjacent tiles first..end - 1. */
static struct area area_of(const struct basis_tile *tiles, int first, int end)
{
	const struct basis_tile *a = &tiles[first], *b = &tiles[end - 1];

	return (struct area){a->x, a->y, b->x + b->width - a->x, a->height};
}

/* What copied codes become; NULL: they stay as they are. */
static const uint8_t *recode_of(const struct compositor *c)
{
	return transfer_curve_same(&c->settings.background, &c->settings.output) ? NULL
										 : c->curves.recode;
}

static void copy_span(const struct compositor *c, int first, int end, struct compositor_worker *w)
{
	const struct area area = area_of(c->layer->basis->tiles, first, end);

	backdrop_copy(c->backdrop, area, recode_of(c), w->rows,
		      c->out + (size_t)area.y * c->out_stride + (size_t)area.x * 4, c->out_stride);
}

/* A tile that was not steady is computed without a trial in so many more frames, and in up to as
 * many again, so that not all are tried in the same frame. A trial takes a fifth of a tile's time,
 * so that those in vain take two hundredths. */
#define UNTRIED 7

/* Whether the tile may be copied. People, whom veil_values() takes from values, and grain, which
 * needs values of KERNEL_FAINT, do not change that; what near_divide() makes of values might. */
static bool is_steady(const struct compositor *c, int t, struct backdrop_rows rows,
		      struct compositor_worker *w)
{
	const struct basis_tile *tile = &c->layer->basis->tiles[t];
	const struct tile_plan *plan = &c->layer->plan.tiles[t];
	uint8_t *untried = &c->layer->untried[t];

	if (!plan->bounded || c->sky)
		return false;
	if (*untried) {
		--*untried;
		return false;
	}
	if (steady_tile(&c->light, plan, &c->curves, rows, tile->width, tile->height,
			&w->tile.block))
		return true;
	*untried = (uint8_t)(UNTRIED + t % UNTRIED);
	return false;
}

/* Copies the steady ones of adjacent tiles. Returns the others, a bit each. */
static unsigned copy_steady(const struct compositor *c, int first, int end,
			    struct backdrop_rows rows, struct compositor_worker *w)
{
	unsigned left = 0;

	for (int t = end; t < c->tiles && t < end + SPAN_TILES; t++) /* the next span */
		if (c->layer->plan.tiles[t].bounded && !c->sky)
			steady_fetch(&c->layer->plan.tiles[t]);
	for (int t = first; t < end; t++, rows.pixels += BASIS_TILE * 4) {
		const struct basis_tile *tile = &c->layer->basis->tiles[t];

		if (is_steady(c, t, rows, w))
			backdrop_copy_rows(rows, tile->width, tile->height, recode_of(c),
					   tile_out(c, tile), c->out_stride);
		else
			left |= 1U << (t - first);
	}
	return left;
}

/* Returns the first block from tile t on, or the end of all. */
static const struct block_plan *block_from(const struct compositor *c, int t)
{
	while (t < c->tiles && !c->layer->plan.tiles[t].block_count)
		t++;
	return t < c->tiles ? c->layer->plan.tiles[t].blocks : c->light.end;
}

static void mix_span(const struct compositor *c, int first, int end, struct compositor_worker *w)
{
	const struct basis_tile *tiles = c->layer->basis->tiles;
	struct backdrop_rows rows = backdrop_rows(c->backdrop, area_of(tiles, first, end), w->rows);
	unsigned left = copy_steady(c, first, end, rows, w);

	for (int t = first; left; t++, left >>= 1, rows.pixels += BASIS_TILE * 4) {
		const struct tile_plan *plan = &c->layer->plan.tiles[t];
		const int next = left > 1 ? t + __builtin_ctz(left & ~1U) : end;
		struct veiled_tile *veiled;

		if (!(left & 1))
			continue;
		veiled = veil_tile(c, t, w);
		fetch_ahead(c, t, rows);
		tile_compute(&c->light, plan, block_from(c, next), &w->tile, &w->values);
		if (c->shown.mirrors)
			mirror_add(c->shown.mirrors, t, c->shown.sky, c->shown.factor, &w->values);
		if (c->settings.rows && plan->object)
			lit_rows_apply(w->values.object, c->settings.rows + tiles[t].y,
				       tiles[t].height);
		if (c->sky && plan->taken && c->layer->near.ground[t])
			near_divide(&c->layer->near, t, c->terms.lamps,
				    (const float(*)[3])c->ground[0].lamp_share, c->kernels,
				    w->values.taken);
		if (veiled && plan->taken)
			veil_values(w->values.taken, veiled->anybody);
		if (c->shown.glass)
			glass_add(c->shown.glass, t, &c->shown.through, c->curves.decode,
				  &w->values);
		if (veiled && plan->object)
			veil_values(w->values.object, veiled->front);
		mix_tile(c, t, w, veiled, rows);
	}
}

static bool is_copied(const struct compositor *c, int tile)
{
	return !c->settings.object || c->layer->plan.tiles[tile].plain;
}

static void make_run(struct compositor *c, int run, struct compositor_worker *w)
{
	const struct division *d = &c->layer->division;
	const int end = d->first[run + 1];
	int t = d->first[run];

	while (t < end) {
		const bool copied = is_copied(c, t);
		const int across = c->basis->tiles_across, row_end = (t / across + 1) * across;
		int last = t + 1;

		while (last < end && last < row_end && is_copied(c, last) == copied &&
		       (copied || last - t < SPAN_TILES))
			last++;
		if (copied)
			copy_span(c, t, last, w);
		else
			mix_span(c, t, last, w);
		t = last;
	}
}

static void frame_run(void *context, int run, int worker)
{
	struct compositor *c = context;
	const int64_t start = clock_now_ns();

	make_run(c, run, c->worker[worker]);
	if (c->settings.object)
		division_took(&c->layer->division, run, clock_now_ns() - start);
}

/* ---- a frame ---- */

static void make_light(void *context, int item, int worker)
{
	const struct compositor *c = context;
	struct layer_light *light = &c->layer->light[item];
	struct light_order order = light->order;

	(void)worker;
	order.gain = c->settings.gain;
	light_vector_make(light->vector, &order, c->lights);
	if (order.cut)
		column_choice_make(&light->choice, light->vector);
}

static void make_behind(void *context, int item, int worker)
{
	const struct compositor *c = context;
	const struct area *a = &c->shown.glass->source[item];
	const size_t stride = (size_t)c->basis->info.width * 4;

	(void)worker;
	c->backdrop->make(c->backdrop->context, a->x, a->y, a->width, a->height,
			  c->behind + (size_t)a->y * stride + (size_t)a->x * 4, stride);
}

/* Provides the background that the object shows. A tile may show any other, so all of it is made
 * before the first tile. */
static void look_behind(struct compositor *c, const struct glass_plan *glass)
{
	const int width = (int)c->basis->info.width, height = (int)c->basis->info.height;

	c->shown.glass = glass->first ? glass : NULL;
	c->shown.through = c->backdrop->picture;
	if (!c->shown.glass || !c->backdrop->make)
		return;
	c->shown.through = (struct picture){c->behind, 4, (ptrdiff_t)width * 4, width, height};
	pool_run(c->pool, glass->source_count, make_behind, c);
}

/* Provides the sky that the object mirrors. -ENOMEM. */
static int look_up(struct compositor *c, struct mirror_plan *mirrors,
		   const struct light_selection *lights)
{
	int ret;

	c->shown.mirrors = mirrors->first ? mirrors : NULL;
	if (!c->shown.mirrors)
		return 0;
	for (int k = 0; k < 3; k++)
		c->shown.factor[k] = (float)(0x1p24 / 65535 / MIRROR_LOOK_ONE * c->settings.gain *
					     lights->mirror_gain[k]);
	if (!lights->mirror) {
		ret = c->lights_map.cell ? 0 : mirror_map_create(&c->lights_map, c->basis, NULL);
		if (ret < 0)
			return ret;
		mirror_map_fill(&c->lights_map, (const double(*)[3])lights->radiance,
				lights->ambient);
	}
	c->shown.sky = lights->mirror ? lights->mirror : &c->lights_map;
	mirror_plan_aim(mirrors, c->shown.sky);
	return 0;
}

/* Makes the light vectors of the layer, and chooses columns. */
static void make_lights(struct compositor *c)
{
	const int count = c->layer->light_count;

	pool_run(c->lights->count * count >= SHARED_LIGHTS ? c->pool : NULL, count, make_light, c);
}

static void begin_frame(struct compositor *c, const struct light_selection *lights)
{
	c->lights = lights;
	make_lights(c);
	c->light = (struct frame_light){
		.kernels = c->kernels,
		.object = &c->vector[BASIS_KIND_T],
		.taken = &c->vector[BASIS_KIND_D],
		.own = &c->vector[BASIS_KIND_U],
		.ground = c->ground,
		.gain_bits = gain_bits(c->settings.gain),
		.end = c->layer->plan.blocks + c->layer->basis->block_count,
	};
	for (int w = 0; w < c->workers; w++)
		block_work_begin(&c->worker[w]->tile.block);
}

static void end_frame(struct compositor *c)
{
	for (int w = 0; w < c->workers; w++) {
		const struct compositor_frame *counts = &c->worker[w]->tile.block.counts;

		c->last.basis_bytes += counts->basis_bytes;
		c->last.columns += counts->columns;
	}
	for (int k = 0; k < c->layer->light_count; k++)
		c->last.columns_left_out += c->layer->light[k].choice.left_out;
	division_settle(&c->layer->division);
}

int compositor_run(struct compositor *c, int pose, const struct light_selection *lights,
		   const struct backdrop *background, uint8_t *out, size_t out_stride)
{
	const struct basis_info_chunk *info = &c->basis->info;
	int ret;

	if (pose < 0 || (uint32_t)pose >= info->poses || background->width != (int)info->width ||
	    background->height != (int)info->height || lights->count != (int)info->lights ||
	    out_stride < (size_t)info->width * 4)
		return -EINVAL;
	ret = compositor_take_pose(c, pose, NULL);
	if (ret < 0)
		return ret;
	c->layer = &c->poses[pose].layer[c->settings.mode];
	if (!c->layer->basis->tiles)
		return -ENODATA;
	c->coverage = c->basis->poses[pose].coverage;
	c->backdrop = background;
	c->out = out;
	c->out_stride = out_stride;
	c->last = (struct compositor_frame){0};
	if (c->settings.object) {
		begin_frame(c, lights);
		look_behind(c, &c->poses[pose].glass);
		ret = look_up(c, &c->poses[pose].mirrors, lights);
		if (ret < 0)
			return ret;
	}
	pool_run(c->pool, c->layer->division.runs, frame_run, c);
	if (c->settings.object)
		end_frame(c);
	return 0;
}
