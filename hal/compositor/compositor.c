#include "hal/compositor/compositor_parts.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

const char *const compositor_mode_names[] = {"fast", "exact", NULL};
const char *const compositor_reuse_names[] = {"auto", "never", "always", NULL};

/* Several for each thread, so that one held up by the system is helped by the others. */
#define RUNS_A_THREAD 8
/* What a tile takes, in bytes of basis that take as long to read: copied, and mixed. */
#define COPY_COST 1024
#define MIX_COST 8192

static int divide(struct compositor *c, struct layer *layer)
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

static int create_layer(struct compositor *c, struct layer *layer, const struct basis_pose *pose,
			enum compositor_mode mode)
{
	const struct basis_layer *basis = mode == COMPOSITOR_EXACT ? &pose->exact : &pose->shown;
	int ret;

	layer->basis = basis;
	if (!basis->tiles)
		return 0;
	ret = layer_plan_create(&layer->plan, c->basis, pose, basis, mode == COMPOSITOR_FAST);
	if (ret < 0)
		return ret;
	layer->needs_ground = calloc(c->basis->info.grounds + (size_t)1,
				     sizeof(*layer->needs_ground));
	if (!layer->needs_ground)
		return -ENOMEM;
	for (int n = 0; n < basis->block_count; n++) {
		const struct basis_block *b = &basis->blocks[n];

		layer->needs[b->kind] = true;
		if (b->kind == BASIS_KIND_V)
			layer->needs_ground[b->ground] = true;
	}
	return divide(c, layer);
}

static int create_poses(struct compositor *c)
{
	int ret = 0;

	c->poses = calloc(c->basis->info.poses, sizeof(*c->poses));
	if (!c->poses)
		return -ENOMEM;
	for (uint32_t p = 0; p < c->basis->info.poses; p++) {
		for (int mode = 0; ret == 0 && mode < COMPOSITOR_MODE_COUNT; mode++)
			ret = create_layer(c, &c->poses[p].layer[mode], &c->basis->poses[p],
					   (enum compositor_mode)mode);
	}
	return ret;
}

static bool any_needs(const struct compositor *c, enum basis_kind kind, uint32_t ground)
{
	for (uint32_t p = 0; p < c->basis->info.poses; p++) {
		for (int mode = 0; mode < COMPOSITOR_MODE_COUNT; mode++) {
			const struct layer *l = &c->poses[p].layer[mode];

			if (l->basis->tiles &&
			    (kind == BASIS_KIND_V ? l->needs_ground[ground] : l->needs[kind]))
				return true;
		}
	}
	return false;
}

static int create_vectors(struct compositor *c)
{
	int ret = 0;

	c->ground = calloc(c->basis->info.grounds + (size_t)1, sizeof(*c->ground));
	if (!c->ground)
		return -ENOMEM;
	for (int k = 0; ret == 0 && k < BASIS_KIND_COUNT; k++) {
		if (k != BASIS_KIND_V && any_needs(c, (enum basis_kind)k, 0))
			ret = light_vector_create(&c->vector[k], c->basis);
	}
	for (uint32_t g = 0; ret == 0 && g < c->basis->info.grounds; g++) {
		if (any_needs(c, BASIS_KIND_V, g))
			ret = light_vector_create(&c->ground[g], c->basis);
	}
	return ret;
}

/* Zeros, at a cache line. */
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
	c->workers = c->pool ? pool_threads(c->pool) : 1;
	c->tiles = basis->tiles_across * basis->tiles_down;
	c->settings = (struct compositor_settings){.reuse = REUSE_NEVER,
						   .background = TRANSFER_SRGB,
						   .output = TRANSFER_SRGB,
						   .gain = 1,
						   .object = true};
	ret = create_poses(c);
	if (ret == 0)
		ret = create_vectors(c);
	if (ret == 0)
		ret = create_workers(c);
	if (ret < 0) {
		compositor_destroy(c);
		return fault_say(fault, ret, "the compositor is out of memory");
	}
	kernel_curves_fill(&c->curves, TRANSFER_SRGB, TRANSFER_SRGB);
	*compositor = c;
	return 0;
}

/* Room for the sums of any pose in this mode. Without it nothing is kept, and the pictures are the
 * same. */
static void make_room(struct compositor *c, enum compositor_mode mode)
{
	size_t size = 0, blocks = 0;

	for (uint32_t p = 0; p < c->basis->info.poses; p++) {
		const struct layer *l = &c->poses[p].layer[mode];

		size = l->plan.kept_size > size ? l->plan.kept_size : size;
		if (l->plan.kept_blocks && (size_t)l->basis->block_count > blocks)
			blocks = (size_t)l->basis->block_count;
	}
	if (size <= c->kept_size && blocks <= c->kept_count)
		return;
	free(c->kept);
	free(c->kept_blocks);
	c->kept_of = NULL;
	c->kept_size = size;
	c->kept_count = blocks;
	c->kept = aligned_alloc(BASIS_ALIGN, size * sizeof(*c->kept));
	c->kept_blocks = calloc(blocks, sizeof(*c->kept_blocks));
	if (!c->before)
		c->before = calloc(c->basis->info.lights, sizeof(*c->before));
	if (!c->kept || !c->kept_blocks || !c->before) {
		free(c->kept);
		c->kept = NULL;
	}
}

void compositor_set(struct compositor *c, const struct compositor_settings *settings)
{
	const bool same = settings->background == c->settings.background &&
			  settings->output == c->settings.output;

	c->settings = *settings;
	if (!same)
		kernel_curves_fill(&c->curves, settings->background, settings->output);
	if (settings->reuse != REUSE_NEVER)
		make_room(c, settings->mode);
}

struct compositor_frame compositor_last(const struct compositor *c)
{
	return c->last;
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
	for (uint32_t p = 0; c->poses && p < c->basis->info.poses; p++) {
		for (int mode = 0; mode < COMPOSITOR_MODE_COUNT; mode++) {
			struct layer *l = &c->poses[p].layer[mode];

			layer_plan_free(&l->plan);
			division_free(&l->division);
			free(l->needs_ground);
		}
	}
	free(c->poses);
	for (int k = 0; k < BASIS_KIND_COUNT; k++)
		light_vector_free(&c->vector[k]);
	for (uint32_t g = 0; c->ground && g < c->basis->info.grounds; g++)
		light_vector_free(&c->ground[g]);
	free(c->ground);
	for (int w = 0; c->worker && w < c->workers && c->worker[w]; w++) {
		block_work_free(&c->worker[w]->tile.block);
		free(c->worker[w]->rows);
		free(c->worker[w]);
	}
	free(c->worker);
	free(c->kept);
	free(c->kept_blocks);
	free(c->before);
	free(c);
}
