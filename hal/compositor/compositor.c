/* SPDX-License-Identifier: MIT */
#include "hal/compositor/compositor_parts.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const char *const compositor_mode_names[] = {"fast", "exact", NULL};

/* Runs for each thread: several, so that other threads take over from one that is delayed. */
#define RUNS_A_THREAD 8
/* First estimate of the time to copy or mix a tile, in bytes of basis read in the same time. */
#define COPY_COST 1024
#define MIX_COST 8192

static int layer_divide(struct compositor *c, struct layer *layer)
{
	const int most = c->workers > 1 ? c->workers * RUNS_A_THREAD : 1;
	double *cost = calloc((size_t)c->tiles, sizeof(*cost));
	int ret;

	if (!cost)
		return -ENOMEM;
	for (int t = 0; t < c->tiles; t++)
		cost[t] = layer->plan.tiles[t].plain
				  ? COPY_COST
				  : MIX_COST + (double)layer->basis->tiles[t].bytes;
	ret = division_create(&layer->division, most < c->tiles ? most : c->tiles, c->tiles, cost);
	free(cost);
	return ret;
}

/* Adds what a block needs to the layer's list of light vectors; creates a vector at its first use.
 * */
static int need_light(struct compositor *c, struct layer *layer, const struct basis_block *b,
		      bool cut)
{
	struct light_vector *vector = b->kind == BASIS_KIND_V ? &c->ground[b->ground]
							      : &c->vector[b->kind];
	struct light_order *order;
	int k = 0, ret;

	while (k < layer->light_count && layer->light[k].vector != vector)
		k++;
	order = &layer->light[k].order;
	if (k == layer->light_count) {
		layer->light[layer->light_count++].vector = vector;
		*order = (struct light_order){.kind = b->kind, .ground = b->ground};
		ret = vector->lights ? 0 : light_vector_create(vector, &c->terms);
		if (ret < 0)
			return ret;
	}
	order->patterns |= b->patterns > 0;
	order->cut |= cut && b->columns > 0 && (b->kind == BASIS_KIND_T || b->kind == BASIS_KIND_V);
	order->groups |= order->cut && block_has_groups(c->basis, b);
	return 0;
}

static int need_choice(struct compositor *c, struct layer *layer, struct layer_light *light)
{
	if (!light->order.cut)
		return 0;
	return column_choice_create(&light->choice, layer->plan.blocks, layer->basis->block_count,
				    light->order.kind, light->order.ground, &c->terms);
}

static int create_layer(struct compositor *c, struct layer *layer, const struct basis_pose *pose,
			enum compositor_mode mode)
{
	const struct basis_layer *basis = mode == COMPOSITOR_EXACT ? &pose->exact : &pose->shown;
	const bool cut = mode == COMPOSITOR_FAST;
	int ret;

	layer->basis = basis;
	if (!basis->tiles)
		return 0;
	if (c->sky) {
		ret = near_layer_create(&layer->near, c->sky, (int)(pose - c->basis->poses), basis,
					c->pool);
		if (ret < 0)
			return ret;
		basis = layer->basis = &layer->near.layer;
	}
	ret = layer_plan_create(&layer->plan, c->basis, pose, basis);
	if (ret < 0)
		return ret;
	layer->untried = calloc((size_t)c->tiles, sizeof(*layer->untried));
	layer->light = calloc(BASIS_KIND_COUNT + (size_t)c->basis->info.grounds,
			      sizeof(*layer->light));
	if (!layer->untried || !layer->light)
		return -ENOMEM;
	for (int n = 0; ret == 0 && n < basis->block_count; n++)
		ret = need_light(c, layer, &basis->blocks[n], cut);
	for (int k = 0; ret == 0 && k < layer->light_count; k++)
		ret = need_choice(c, layer, &layer->light[k]);
	return ret < 0 ? ret : layer_divide(c, layer);
}

static void forget_pose(struct pose *pose)
{
	glass_plan_free(&pose->glass);
	mirror_plan_free(&pose->mirrors);
	for (int mode = 0; mode < COMPOSITOR_MODE_COUNT; mode++) {
		struct layer *l = &pose->layer[mode];

		for (int k = 0; k < l->light_count; k++)
			column_choice_free(&l->light[k].choice);
		layer_plan_free(&l->plan);
		near_layer_free(&l->near);
		division_free(&l->division);
		free(l->light);
		free(l->untried);
	}
	*pose = (struct pose){.made = false};
}

/* Plans a pose, which must be in memory. */
static int make_pose(struct compositor *c, int index)
{
	const struct basis_pose *basis = &c->basis->poses[index];
	struct pose *pose = &c->poses[index];
	int ret = glass_plan_create(&pose->glass, c->basis, basis);

	if (ret == 0)
		ret = mirror_plan_create(&pose->mirrors, c->basis, basis);
	pose->made = true;
	pose->turn = basis->turn;
	for (int mode = 0; ret == 0 && mode < COMPOSITOR_MODE_COUNT; mode++)
		ret = create_layer(c, &pose->layer[mode], basis, (enum compositor_mode)mode);
	if (ret < 0)
		forget_pose(pose);
	return ret;
}

static int create_behind(struct compositor *c)
{
	const struct basis_info_chunk *info = &c->basis->info;

	for (uint32_t p = 0; p < info->poses && !c->behind; p++)
		if (c->basis->poses[p].glass_count) {
			c->behind = malloc((size_t)info->width * info->height * 4);
			if (!c->behind)
				return -ENOMEM;
		}
	return 0;
}

static int create_poses(struct compositor *c)
{
	int ret = 0;

	c->pose = -1;
	c->poses = calloc(c->basis->info.poses, sizeof(*c->poses));
	c->ground = calloc(c->basis->info.grounds + (size_t)1, sizeof(*c->ground));
	if (!c->poses || !c->ground)
		return -ENOMEM;
	for (int p = 0; ret == 0 && p < (int)c->basis->info.poses; p++)
		if (c->basis->poses[p].shown.tiles)
			ret = make_pose(c, p);
	return ret;
}

/* Returns zeroed memory, aligned to a cache line. */
static void *aligned_zeros(size_t bytes)
{
	void *memory = aligned_alloc(BASIS_ALIGN,
				     (bytes + BASIS_ALIGN - 1) / BASIS_ALIGN * BASIS_ALIGN);

	return memory ? memset(memory, 0, bytes) : NULL;
}

static int create_workers(struct compositor *c)
{
	const size_t row = c->basis->info.width,
		     span = (size_t)SPAN_TILES * BASIS_TILE * BASIS_TILE;

	c->worker = calloc((size_t)c->workers, sizeof(*c->worker));
	if (!c->worker)
		return -ENOMEM;
	for (int w = 0; w < c->workers; w++) {
		c->worker[w] = aligned_zeros(sizeof(**c->worker));
		if (!c->worker[w])
			return -ENOMEM;
		c->worker[w]->rows = aligned_zeros(4 * (row > span ? row : span));
		if (!c->worker[w]->rows ||
		    block_work_create(&c->worker[w]->tile.block, c->basis) < 0)
			return -ENOMEM;
	}
	return 0;
}

/* Places are unpacked when lamps ask for them, behind their checksum. */
static const char *trouble_of(int err)
{
	return err == -EBADMSG ? "the basis file's places are damaged"
			       : "the compositor is out of memory";
}

int compositor_create(struct compositor **compositor, const struct basis *basis,
		      const struct compositor_options *options, struct fault *fault)
{
	const struct kernels *kernels = kernels_choose(options->kernel);
	struct compositor *c;
	int ret;

	*compositor = NULL;
	if (!kernels)
		return fault_say(fault, -ENOTSUP, "this processor has no kernel called \"%s\"",
				 options->kernel ? options->kernel : "auto");
	c = aligned_zeros(sizeof(*c));
	if (!c)
		return fault_say(fault, -ENOMEM, "the compositor is out of memory");
	c->basis = basis;
	c->kernels = kernels;
	c->pool = options->pool;
	c->workers = pool_threads(c->pool);
	c->tiles = basis->tiles_across * basis->tiles_down;
	c->settings = (struct compositor_settings){.gain = 1, .object = true};
	ret = near_sky_create(&c->sky, basis, options->lamps, fault);
	if (ret < 0) {
		compositor_destroy(c);
		return ret;
	}
	ret = light_terms_create(&c->terms, basis);
	if (c->sky) {
		c->terms.lamps = c->sky->lamps.count;
		memcpy(c->terms.lamp_ground, c->sky->ground, sizeof(c->terms.lamp_ground));
	}
	if (ret == 0)
		ret = create_poses(c);
	if (ret == 0)
		ret = create_behind(c);
	if (ret == 0)
		ret = create_workers(c);
	if (ret < 0) {
		compositor_destroy(c);
		return fault_say(fault, ret, "%s", trouble_of(ret));
	}
	kernel_curves_fill(&c->curves, &c->settings.background, &c->settings.output);
	*compositor = c;
	return 0;
}

void compositor_set(struct compositor *c, const struct compositor_settings *settings)
{
	const bool same = transfer_curve_same(&settings->background, &c->settings.background) &&
			  transfer_curve_same(&settings->output, &c->settings.output);

	c->settings = *settings;
	if (!same)
		kernel_curves_fill(&c->curves, &settings->background, &settings->output);
}

static void forget_others(struct compositor *c)
{
	for (uint32_t p = 0; p < c->basis->info.poses; p++) {
		const struct basis_pose *basis = &c->basis->poses[p];

		if (c->poses[p].made && (!basis->shown.tiles || basis->turn != c->poses[p].turn))
			forget_pose(&c->poses[p]);
	}
}

int compositor_take_pose(struct compositor *c, int pose, struct fault *fault)
{
	int ret;

	if (pose == c->pose && c->poses[pose].made &&
	    c->poses[pose].turn == c->basis->poses[pose].turn)
		return 0;
	ret = basis_pose_load(c->basis, pose, fault);
	if (ret < 0)
		return ret;
	forget_others(c);
	if (!c->poses[pose].made)
		ret = make_pose(c, pose);
	c->pose = ret < 0 ? -1 : pose;
	return ret < 0 ? fault_say(fault, ret, "%s", trouble_of(ret)) : 0;
}

struct compositor_frame compositor_last(const struct compositor *c)
{
	return c->last;
}

int compositor_lamps(const struct compositor *c)
{
	return c->terms.lamps;
}

const char *compositor_kernel(const struct compositor *c)
{
	return c->kernels->name;
}

bool compositor_has_kernel(const char *name)
{
	return kernels_choose(name) != NULL;
}

void compositor_destroy(struct compositor *c)
{
	if (!c)
		return;
	for (uint32_t p = 0; c->poses && p < c->basis->info.poses; p++)
		forget_pose(&c->poses[p]);
	free(c->poses);
	for (int k = 0; k < BASIS_KIND_COUNT; k++)
		light_vector_free(&c->vector[k]);
	for (uint32_t g = 0; c->ground && g < c->basis->info.grounds; g++)
		light_vector_free(&c->ground[g]);
	free(c->ground);
	light_terms_free(&c->terms);
	near_sky_destroy(c->sky);
	for (int w = 0; c->worker && w < c->workers && c->worker[w]; w++) {
		block_work_free(&c->worker[w]->tile.block);
		free(c->worker[w]->rows);
		free(c->worker[w]);
	}
	free(c->worker);
	free(c->behind);
	mirror_map_free(&c->lights_map);
	free(c);
}
