#include "hal/compositor/compositor.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/compositor/tile.h"

/* Several for each thread, so that one held up by the system is helped by the others. */
#define ITEMS_A_THREAD 8

/* What a tile's own pixels cost, in bytes of basis that take as long to read: copied, and mixed. */
#define COPY_COST 8192
#define MIX_COST 32768

/* A pose's tiles, divided into runs of about equal bytes. */
struct division {
	int *first;  /* [items + 1]: of each run; the last is the number of tiles */
	bool *plain; /* [tiles]: the object changes nothing here */
};

struct compositor {
	const struct basis *basis;
	struct pool *pool;
	struct compositor_settings settings;
	int tiles, items, workers;
	bool receivers;		    /* some pose has a D block */
	struct division *divisions; /* [poses] */
	struct weights object[3], receiver[3];
	struct weights (*ground)[3];   /* [grounds] */
	struct tile_scratch **scratch; /* [workers] */
	struct transfer_tables decode, encode;
	uint8_t recode[256];
	struct tile_frame frame;
};

static bool is_plain(const struct basis *basis, int pose, const struct basis_tile *tile)
{
	const uint16_t *coverage = basis->poses[pose].coverage;

	if (tile->block_count)
		return false;
	for (int y = 0; y < tile->height; y++) {
		const uint16_t *a = coverage + (size_t)(tile->y + y) * basis->info.width + tile->x;

		for (int x = 0; x < tile->width; x++) {
			if (a[x])
				return false;
		}
	}
	return true;
}

static uint64_t tile_cost(const struct basis_tile *tile, bool plain)
{
	return tile->bytes + (plain ? COPY_COST : MIX_COST);
}

static void divide(const struct compositor *c, int pose, struct division *division)
{
	const struct basis_tile *tiles = c->basis->poses[pose].tiles;
	uint64_t all = 0, before = 0;
	int item = 0;

	for (int t = 0; t < c->tiles; t++) {
		division->plain[t] = is_plain(c->basis, pose, &tiles[t]);
		all += tile_cost(&tiles[t], division->plain[t]);
	}
	for (int t = 0; t < c->tiles; t++) {
		while (item < c->items && before >= all / (unsigned)c->items * (unsigned)item)
			division->first[item++] = t;
		before += tile_cost(&tiles[t], division->plain[t]);
	}
	while (item <= c->items)
		division->first[item++] = c->tiles;
}

static bool has_receivers(const struct basis *basis)
{
	for (uint32_t p = 0; p < basis->info.poses; p++) {
		for (int b = 0; b < basis->poses[p].block_count; b++) {
			if (basis->poses[p].blocks[b].kind == BASIS_KIND_D)
				return true;
		}
	}
	return false;
}

static int create_divisions(struct compositor *c)
{
	const int poses = (int)c->basis->info.poses;

	c->divisions = calloc((size_t)poses, sizeof(*c->divisions));
	if (!c->divisions)
		return -ENOMEM;
	for (int p = 0; p < poses; p++) {
		struct division *d = &c->divisions[p];

		d->first = calloc((size_t)c->items + 1, sizeof(*d->first));
		d->plain = calloc((size_t)c->tiles, sizeof(*d->plain));
		if (!d->first || !d->plain)
			return -ENOMEM;
		divide(c, p, d);
	}
	return 0;
}

static int create_weights(struct compositor *c)
{
	const int n = (int)c->basis->info.lights;
	int ret = 0;

	c->ground = calloc(c->basis->info.grounds + (size_t)1, sizeof(*c->ground));
	if (!c->ground)
		return -ENOMEM;
	for (int k = 0; ret == 0 && k < 3; k++) {
		ret = weights_create(&c->object[k], n);
		if (ret == 0 && c->receivers)
			ret = weights_create(&c->receiver[k], n);
		for (uint32_t g = 0; ret == 0 && g < c->basis->info.grounds; g++)
			ret = weights_create(&c->ground[g][k], n);
	}
	return ret;
}

static int create_scratch(struct compositor *c)
{
	c->scratch = calloc((size_t)c->workers, sizeof(*c->scratch));
	if (!c->scratch)
		return -ENOMEM;
	for (int w = 0; w < c->workers; w++) {
		c->scratch[w] = tile_scratch_create((int)c->basis->info.lights);
		if (!c->scratch[w])
			return -ENOMEM;
	}
	return 0;
}

static void fill_tables(struct compositor *c)
{
	transfer_tables_fill(&c->decode, c->settings.background);
	transfer_tables_fill(&c->encode, c->settings.output);
	for (int code = 0; code < 256; code++)
		c->recode[code] = c->encode.encode[c->decode.decode[code]];
}

int compositor_create(struct compositor **compositor, const struct basis *basis, struct pool *pool,
		      struct fault *fault)
{
	struct compositor *c = calloc(1, sizeof(*c));
	int ret;

	*compositor = NULL;
	if (!c)
		return fault_say(fault, -ENOMEM, "the compositor is out of memory");
	c->basis = basis;
	c->pool = pool;
	c->workers = pool ? pool_threads(pool) : 1;
	c->tiles = basis->tiles_across * basis->tiles_down;
	c->receivers = has_receivers(basis);
	c->items = c->workers * ITEMS_A_THREAD;
	c->settings = (struct compositor_settings){
		.background = TRANSFER_SRGB, .output = TRANSFER_SRGB, .gain = 1, .object = true};
	ret = create_divisions(c);
	if (ret == 0)
		ret = create_weights(c);
	if (ret == 0)
		ret = create_scratch(c);
	if (ret < 0) {
		compositor_destroy(c);
		return fault_say(fault, ret, "the compositor is out of memory");
	}
	fill_tables(c);
	*compositor = c;
	return 0;
}

void compositor_set(struct compositor *c, const struct compositor_settings *settings)
{
	const bool same = settings->background == c->settings.background &&
			  settings->output == c->settings.output;

	c->settings = *settings;
	if (!same)
		fill_tables(c);
}

static void fill_weights(struct compositor *c, const struct light_selection *lights)
{
	for (int k = 0; k < 3; k++) {
		weights_object(&c->object[k], lights, k, c->settings.gain);
		if (c->receivers)
			weights_receiver(&c->receiver[k], lights, k);
		for (uint32_t g = 0; g < c->basis->info.grounds; g++)
			weights_ground(&c->ground[g][k], lights, k,
				       basis_ground(c->basis, (int)g, k));
	}
}

static void work(void *context, int item, int worker)
{
	struct compositor *c = context;
	const struct division *d = &c->divisions[c->frame.pose];
	const struct basis_tile *tiles = c->basis->poses[c->frame.pose].tiles;

	for (int t = d->first[item]; t < d->first[item + 1]; t++) {
		if (d->plain[t] || !c->settings.object)
			tile_copy(&c->frame, &tiles[t]);
		else
			tile_composite(&c->frame, &tiles[t], c->scratch[worker]);
	}
}

int compositor_run(struct compositor *c, int pose, const struct light_selection *lights,
		   const struct picture *background, uint8_t *out, size_t out_stride)
{
	const struct basis_info_chunk *info = &c->basis->info;

	if (pose < 0 || (uint32_t)pose >= info->poses || background->width != (int)info->width ||
	    background->height != (int)info->height || lights->count != (int)info->lights ||
	    out_stride < (size_t)info->width * 4)
		return -EINVAL;
	if (c->settings.object)
		fill_weights(c, lights);
	c->frame = (struct tile_frame){
		.basis = c->basis,
		.pose = pose,
		.object = c->object,
		.receiver = c->receiver,
		.ground = (const struct weights(*)[3])c->ground,
		.decode = c->decode.decode,
		.encode = c->encode.encode,
		.recode = c->recode,
		.same_codes = c->settings.background == c->settings.output,
		.background = *background,
		.out = out,
		.out_stride = out_stride,
	};
	if (c->pool) {
		pool_run(c->pool, c->items, work, c);
	} else {
		for (int item = 0; item < c->items; item++)
			work(c, item, 0);
	}
	return 0;
}

void compositor_destroy(struct compositor *c)
{
	if (!c)
		return;
	for (uint32_t p = 0; c->divisions && p < c->basis->info.poses; p++) {
		free(c->divisions[p].first);
		free(c->divisions[p].plain);
	}
	free(c->divisions);
	for (int k = 0; k < 3; k++) {
		weights_free(&c->object[k]);
		weights_free(&c->receiver[k]);
		for (uint32_t g = 0; c->ground && g < c->basis->info.grounds; g++)
			weights_free(&c->ground[g][k]);
	}
	free(c->ground);
	for (int w = 0; c->scratch && w < c->workers; w++)
		tile_scratch_destroy(c->scratch[w]);
	free(c->scratch);
	free(c);
}
