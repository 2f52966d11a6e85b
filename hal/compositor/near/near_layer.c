/* SPDX-License-Identifier: MIT */
#include "hal/compositor/near/near_layer.h"

#include <errno.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"
#include "hal/basis/basis_places.h"

#define PIXELS (BASIS_TILE * BASIS_TILE)
#define COLUMN_MOST 32767
enum { POINTS = NEAR_GRID * NEAR_GRID, STEP = BASIS_TILE / (NEAR_GRID - 1) };
/* Bytes of a block's lights, scales and pixels before its columns. */
#define LAMP_HEAD (LAMPS_MAX * (sizeof(uint16_t) + sizeof(float)) + PIXELS * sizeof(uint16_t) + 16)
_Static_assert(LAMP_HEAD % BASIS_ALIGN == 0, "columns are aligned");

/* A piece of the layer's memory; its bytes follow at BASIS_ALIGN. */
struct near_memory {
	struct near_memory *next;
};

/* Threads may call it at once. */
static void *near_memory_take(struct near_layer *near, size_t bytes)
{
	const size_t whole = (bytes + 2 * BASIS_ALIGN - 1) / BASIS_ALIGN * BASIS_ALIGN;
	struct near_memory *memory = aligned_alloc(BASIS_ALIGN, whole);

	if (!memory)
		return NULL;
	memset(memory, 0, whole);
	memory->next = atomic_load(&near->memory);
	while (!atomic_compare_exchange_weak(&near->memory, &memory->next, memory))
		;
	return (char *)memory + BASIS_ALIGN;
}

void near_layer_free(struct near_layer *near)
{
	for (struct near_memory *memory = near->memory, *next; memory; memory = next) {
		next = memory->next;
		free(memory);
	}
	*near = (struct near_layer){.memory = NULL};
}

/* The light of one lamp at the pixels of a tile: amount[k][p] is w_i L_i of light[k] at pixel p. */
struct near_light {
	int count, room;
	int *light;
	float (*amount)[PIXELS];
	int16_t *slot; /* [lights]: k of each light; -1: it sends none */
};

/* The scratch memory of one thread. */
struct near_work {
	const struct near_sky *sky;
	const struct basis_tile *tile;
	float *const *distance; /* near_job.distance */
	int err;		/* the first of this thread; 0: none */
	int places;
	double place[PIXELS][3];
	bool known[PIXELS];
	struct near_hint hint[LAMPS_MAX];
	struct near_light light;
	float value[LAMPS_MAX][3][PIXELS];
	float object[NEAR_SKIES][3][PIXELS]; /* near_object.t */
};

/* ---- the light at the pixels ---- */

static int light_grow(struct near_light *light)
{
	const int room = light->room ? 2 * light->room : 32;
	int *list = realloc(light->light, (size_t)room * sizeof(*list));
	float(*amount)[PIXELS];

	if (!list)
		return -ENOMEM;
	light->light = list;
	amount = realloc(light->amount, (size_t)room * sizeof(*amount));
	if (!amount)
		return -ENOMEM;
	light->amount = amount;
	light->room = room;
	return 0;
}

static int light_add(struct near_light *light, const struct near_share *share, int pixel)
{
	int16_t *slot = &light->slot[share->light];

	if (*slot < 0) {
		if (light->count == light->room && light_grow(light) < 0)
			return -ENOMEM;
		*slot = (int16_t)light->count;
		light->light[light->count] = share->light;
		memset(light->amount[light->count++], 0, sizeof(*light->amount));
	}
	light->amount[*slot][pixel] += (float)share->amount;
	return 0;
}

static void light_clear(struct near_light *light)
{
	while (light->count)
		light->slot[light->light[--light->count]] = -1;
}

static void find_points(struct near_work *w)
{
	w->places = POINTS;
	for (int k = 0; k < POINTS; k++)
		w->known[k] = near_sky_ground(w->sky, w->tile->x + k % NEAR_GRID * STEP,
					      w->tile->y + k / NEAR_GRID * STEP, w->place[k]);
}

static void find_pixels(struct near_work *w, enum basis_kind kind, const bool *listed)
{
	const float *distance = w->distance[kind == BASIS_KIND_T ? BASIS_OBJECT : BASIS_RECEIVER];

	w->places = PIXELS;
	for (int p = 0; p < PIXELS; p++) {
		const int x = w->tile->x + p % BASIS_TILE, y = w->tile->y + p / BASIS_TILE;
		const size_t at = (size_t)y * w->sky->basis->info.width + (size_t)x;

		if (!listed[p])
			w->known[p] = false;
		else if (kind == BASIS_KIND_V)
			w->known[p] = near_sky_ground(w->sky, x + 0.5, y + 0.5, w->place[p]);
		else
			w->known[p] = distance[at] > 0 &&
				      near_sky_surface(w->sky, x + 0.5, y + 0.5,
						       (double)distance[at], w->place[p]);
	}
}

/* Finds the light of a lamp at these places. */
static int light_fill(struct near_work *w, int lamp)
{
	struct near_share share[NEAR_SHARES];

	light_clear(&w->light);
	for (int k = 0; k < w->places; k++) {
		const int count = w->known[k] ? near_sky_shares(w->sky, lamp, w->place[k],
								&w->hint[lamp], share)
					      : 0;

		for (int n = 0; n < count; n++)
			if (light_add(&w->light, &share[n], k) < 0)
				return -ENOMEM;
	}
	return 0;
}

/* ---- the values of a block in this light ---- */

/* X of a light for w_i L_i = 1, in the unit of the lamp's column. */
static float light_factor(const struct near_sky *sky, enum basis_kind kind, int lamp, int light,
			  int c)
{
	if (kind != BASIS_KIND_V)
		return 1;
	if (!(sky->ground[lamp][c] > 0))
		return 0;
	return (float)(basis_ground(sky->basis, 0, c)[light] /
		       sky->basis->lights[light].solid_angle_sr / sky->ground[lamp][c]);
}

/* What light i gives pattern j: the pattern over the coarse lights that it goes to. */
static float pattern_of(const struct basis *basis, const struct basis_block *b, int j, int i)
{
	const int16_t *row = b->pattern + (size_t)j * (size_t)b->stride;
	double sum = 0;

	if (!basis->coarse)
		return (float)((double)b->pattern_scale[j] * row[i]);
	for (int k = 0; k < 3; k++)
		sum += (double)row[basis->coarse[i].index[k]] * basis->coarse[i].weight[k];
	return (float)((double)b->pattern_scale[j] * sum / BASIS_COARSE_ONE);
}

static float coefficient_of(const struct basis_block *b, int panels, int c, int n, int pattern)
{
	const int line = (int)basis_line16(panels, b->patterns, b->channels == 3 ? c : 0,
					   n / BASIS_LINE16, pattern);

	return b->coefficient[line * BASIS_LINE16 + n % BASIS_LINE16];
}

static int column_of(const struct basis_block *b, int panels, int c, int n, int column)
{
	const int channel = b->channels == 3 ? c : 0;
	const int line = (int)basis_line16(panels, b->columns, channel, n / BASIS_LINE16, column);

	return b->bits == 8 ? basis_column8_value(b, column, channel, n)
			    : b->column16[line * BASIS_LINE16 + n % BASIS_LINE16];
}

static float tint_of(const struct basis_block *b, int c, int n)
{
	return b->tint ? (float)b->tint[c * b->pixels + n] / BASIS_TINT_ONE : 1;
}

static void add_patterns(const struct near_work *w, const struct basis_block *b, int lamp, int c,
			 float *value)
{
	const int panels = basis_panels16(b->pixels);

	for (int j = 0; j < b->patterns; j++) {
		float y[PIXELS] = {0};

		for (int k = 0; k < w->light.count; k++) {
			const int i = w->light.light[k];
			const float of = pattern_of(w->sky->basis, b, j, i) *
					 light_factor(w->sky, b->kind, lamp, i, c);

			for (int p = 0; p < PIXELS; p++)
				y[p] += of * w->light.amount[k][p];
		}
		for (int n = 0; n < b->pixels; n++)
			value[n] += y[b->pixel[n]] * coefficient_of(b, panels, c, n, j);
	}
}

/* The column of a light; -1: there is none. */
static int find_column(const struct basis_block *b, int light)
{
	int low = 0, high = b->columns;

	while (low < high) {
		const int middle = (low + high) / 2;

		if (b->light[middle] < light)
			low = middle + 1;
		else
			high = middle;
	}
	return low < b->columns && b->light[low] == light ? low : -1;
}

static void add_columns(const struct near_work *w, const struct basis_block *b, int lamp, int c,
			float *value)
{
	const int panels = basis_panels16(b->pixels);

	for (int k = 0; k < w->light.count; k++) {
		const int n = find_column(b, w->light.light[k]);
		const float scale = n < 0 ? 0
					  : b->column_scale[n] * light_factor(w->sky, b->kind, lamp,
									      w->light.light[k], c);

		for (int p = 0; n >= 0 && p < b->pixels; p++)
			value[p] += scale * w->light.amount[k][b->pixel[p]] *
				    (float)column_of(b, panels, c, p, n);
	}
}

/* Whether a block gives all channels the same, but for its tint. */
static bool is_alike(const struct near_layer *near, const struct basis_block *b)
{
	return b->channels == 1 && (b->kind != BASIS_KIND_V || near->channels == 1);
}

static void add_block(const struct near_layer *near, struct near_work *w,
		      const struct basis_block *b, int lamp)
{
	float value[3][PIXELS] = {{0}};

	for (int c = 0; c < 3; c++) {
		if (c && is_alike(near, b)) {
			memcpy(value[c], value[0], sizeof(value[c]));
		} else {
			add_patterns(w, b, lamp, c, value[c]);
			add_columns(w, b, lamp, c, value[c]);
		}
		for (int n = 0; n < b->pixels; n++)
			w->value[lamp][c][b->pixel[n]] += value[c][n] * tint_of(b, c, n);
	}
}

/* ---- bounced light ---- */

/* w_i L_i of a light of near_object's skies. */
static float sky_light(const struct near_sky *near, int sky, int light)
{
	const struct basis_light *l = &near->basis->lights[light];

	return (float)(near_sky_radiance(sky, l->direction) * l->solid_angle_sr);
}

/* Adds what a block of the object shows under near_object's skies. */
static void add_skies(struct near_work *w, const struct basis_block *b)
{
	const struct basis *basis = w->sky->basis;
	const int panels = basis_panels16(b->pixels), lights = (int)basis->info.lights;
	float value[NEAR_SKIES][3][PIXELS] = {{{0}}}, light[NEAR_SKIES];

	for (int j = 0; j < b->patterns; j++) {
		memset(light, 0, sizeof(light));
		for (int i = 0; i < lights; i++) {
			const float pattern = pattern_of(basis, b, j, i);

			for (int k = 0; k < NEAR_SKIES; k++)
				light[k] += pattern * sky_light(w->sky, k, i);
		}
		for (int n = 0; n < b->channels * b->pixels; n++)
			for (int k = 0, c = n / b->pixels; k < NEAR_SKIES; k++)
				value[k][c][n % b->pixels] +=
					light[k] * coefficient_of(b, panels, c, n % b->pixels, j);
	}
	for (int j = 0; j < b->columns && b->light[j] < lights; j++) {
		for (int k = 0; k < NEAR_SKIES; k++)
			light[k] = b->column_scale[j] * sky_light(w->sky, k, b->light[j]);
		for (int n = 0; n < b->channels * b->pixels; n++) {
			const int c = n / b->pixels, p = n % b->pixels;
			const float column = (float)column_of(b, panels, c, p, j);

			for (int k = 0; k < NEAR_SKIES; k++)
				value[k][c][p] += light[k] * column;
		}
	}
	for (int k = 0; k < NEAR_SKIES; k++)
		for (int c = 0; c < 3; c++)
			for (int n = 0; n < b->pixels; n++)
				w->object[k][c][b->pixel[n]] +=
					value[k][b->channels == 3 ? c : 0][n] * tint_of(b, c, n);
}

static void correct_bounced(struct near_work *w, const struct basis_block *b, int count)
{
	memset(w->object, 0, sizeof(w->object));
	for (int k = 0; k < count; k++)
		add_skies(w, &b[k]);
	for (int p = 0; p < PIXELS; p++) {
		const int x = w->tile->x + p % BASIS_TILE, y = w->tile->y + p / BASIS_TILE;
		const float over_share =
			w->known[p] ? w->distance[BASIS_BOUNCED]
						 [(size_t)y * w->sky->basis->info.width + (size_t)x]
				    : 0;
		struct near_object object = {.share = 1 / (double)over_share};

		for (int k = 0; over_share > 0 && k < 3 * NEAR_SKIES; k++)
			object.t[k / 3][k % 3] = (double)w->object[k / 3][k % 3][p];
		for (int k = 0; over_share > 0 && k < 3 * w->sky->lamps.count; k++) {
			float *value = &w->value[k / 3][k % 3][p];

			*value -= (float)near_sky_bounced(w->sky, k / 3, w->place[p], &object,
							  k % 3, (double)*value);
		}
	}
}

/* ---- the ground ---- */

/* Where less light than this arrives, none is taken. */
#define LEAST 0x1p-20F

/* Whether the ground's u has one colour, whatever the light. */
static bool has_one_colour(const struct basis *basis)
{
	const double *u[3];

	for (int c = 0; c < 3; c++)
		u[c] = basis_ground(basis, 0, c);
	for (uint32_t i = 0; i < basis->info.lights; i++)
		for (int c = 1; c < 3; c++)
			if (fabs(u[c][i] * u[0][0] - u[0][i] * u[c][0]) > 1e-6 * u[c][i] * u[0][0])
				return false;
	return true;
}

static float *even_of(const struct near_layer *near, int tile, int lamps)
{
	return near->even + (size_t)tile * (size_t)(near->channels * lamps * POINTS);
}

/* Finds the light of a lamp on the ground at the points of the tile's grid. */
static void find_even(struct near_layer *near, const struct near_work *w, int lamp)
{
	const int tile = w->tile->y / BASIS_TILE * w->sky->basis->tiles_across +
			 w->tile->x / BASIS_TILE,
		  lamps = w->sky->lamps.count;

	near->ground[tile] = true;
	for (int c = 0; c < near->channels; c++) {
		float *to = even_of(near, tile, lamps) + (c * lamps + lamp) * POINTS;

		for (int n = 0; n < w->light.count; n++) {
			const float factor = light_factor(w->sky, BASIS_KIND_V, lamp,
							  w->light.light[n], c);

			for (int k = 0; k < POINTS; k++)
				to[k] += factor * w->light.amount[n][k];
		}
	}
}

/* ---- the block of the lamps ---- */

/* Whether a lamp gives all channels the same, to half a step of its column. */
static bool is_grey(const float (*value)[PIXELS], float step)
{
	for (int c = 1; c < 3; c++)
		for (int p = 0; p < PIXELS; p++)
			if (fabsf(value[c][p] - value[0][p]) > step / 2)
				return false;
	return true;
}

/* Rounds the values of the listed pixels to columns. Lamps of which nothing arrives have none. */
static int write_columns(struct near_layer *near, const struct near_work *w,
			 const struct basis_block *first, const uint16_t *pixel, int pixels,
			 struct basis_block *to)
{
	const struct basis_info_chunk *info = &w->sky->basis->info;
	const int panels = basis_panels16(pixels);
	float step[LAMPS_MAX] = {0};
	int columns = 0, channels = 1, n = 0;
	uint16_t *light, *list;
	int16_t *column;
	float *scale;

	for (int l = 0; l < w->sky->lamps.count; l++) {
		float most = 0;

		for (int c = 0; c < 3; c++)
			for (int p = 0; p < PIXELS; p++)
				most = fmaxf(most, fabsf(w->value[l][c][p]));
		step[l] = fminf(most, (float)BASIS_VALUE_MAX) / COLUMN_MOST;
		columns += step[l] > 0;
		channels = is_grey(w->value[l], step[l]) ? channels : 3;
	}
	*to = (struct basis_block){.columns = columns};
	if (!columns)
		return 0;
	to->bytes = (size_t)(channels * panels * columns) * BASIS_LINE16 * sizeof(*column);
	/* In the order of a file's payload, which prefetching relies on. */
	light = near_memory_take(near, LAMP_HEAD + to->bytes);
	if (!light)
		return -ENOMEM;
	scale = (float *)(void *)(light + LAMPS_MAX);
	list = (uint16_t *)(void *)(scale + LAMPS_MAX);
	column = (int16_t *)(void *)((char *)light + LAMP_HEAD);
	memcpy(list, pixel, sizeof(*list) * (size_t)pixels);
	for (int l = 0; l < w->sky->lamps.count; l++) {
		if (!(step[l] > 0))
			continue;
		light[n] = (uint16_t)(info->lights + info->coarse + (uint32_t)l);
		scale[n] = step[l];
		for (int c = 0; c < channels; c++)
			for (int p = 0; p < pixels; p++) {
				const int line = (int)basis_line16(panels, columns, c,
								   p / BASIS_LINE16, n);
				const float steps = w->value[l][c][pixel[p]] / step[l];

				column[line * BASIS_LINE16 + p % BASIS_LINE16] = (int16_t)lrintf(
					fmaxf(fminf(steps, COLUMN_MOST), -COLUMN_MOST));
			}
		n++;
	}
	to->kind = first->kind;
	to->pixels = pixels;
	to->channels = channels;
	to->bits = 16;
	to->stride = first->stride;
	to->pixel = list;
	to->pattern_scale = (const float *)(const void *)light;
	to->light = light;
	to->column_scale = scale;
	to->cut_share = 1;
	to->column16 = column;
	return 0;
}

/* Makes the block of all lamps beside `count` blocks of one kind. to->columns is 0 where no lamp
 * sends light. */
static int make_block(struct near_layer *near, struct near_work *w, const struct basis_block *b,
		      int count, struct basis_block *to)
{
	bool listed[PIXELS] = {false};
	uint16_t pixel[PIXELS];
	int pixels = 0;

	for (int k = 0; k < count; k++)
		for (int n = 0; n < b[k].pixels; n++)
			listed[b[k].pixel[n]] = true;
	for (int p = 0; p < PIXELS; p++)
		if (listed[p])
			pixel[pixels++] = (uint16_t)p;
	memset(w->value, 0, sizeof(w->value));
	if (b->kind == BASIS_KIND_V) {
		find_points(w);
		for (int l = 0; l < w->sky->lamps.count; l++) {
			if (light_fill(w, l) < 0)
				return -ENOMEM;
			find_even(near, w, l);
		}
	}
	find_pixels(w, b->kind, listed);
	for (int l = 0; l < w->sky->lamps.count; l++) {
		if (light_fill(w, l) < 0)
			return -ENOMEM;
		for (int k = 0; k < count; k++)
			add_block(near, w, &b[k], l);
	}
	if (b->kind == BASIS_KIND_T)
		correct_bounced(w, b, count);
	return write_columns(near, w, b, pixel, pixels, to);
}

/* ---- a frame ---- */

void near_divide(const struct near_layer *near, int tile, int lamps, const float (*share)[3],
		 const struct kernels *kernels, int32_t (*taken)[PIXELS])
{
	const float *even = even_of(near, tile, lamps);

	for (int c = 0; c < 3; c++) {
		const float *own = near->channels == 3 ? even + c * lamps * POINTS : even;
		float grid[POINTS];

		for (int k = 0; k < POINTS; k++)
			grid[k] = 1;
		for (int l = 0; l < lamps; l++)
			for (int k = 0; k < POINTS; k++)
				grid[k] += share[l][c] * (own[l * POINTS + k] - 1);
		for (int k = 0; k < POINTS; k++)
			grid[k] = grid[k] > LEAST ? grid[k] : LEAST;
		kernels->divide(taken[c], grid);
	}
}

/* ---- a layer ---- */

/* What threads share that make a layer. */
struct near_job {
	struct near_layer *near;
	const struct basis_layer *from;
	float *distance[BASIS_SURFACES]; /* [height][width] */
	struct near_work *work;		 /* [threads] */
};

static int near_job_create(struct near_job *job, const struct near_sky *sky, int pose, int threads)
{
	const struct basis_info_chunk *info = &sky->basis->info;
	int ret = 0;

	job->work = calloc((size_t)threads, sizeof(*job->work));
	if (!job->work)
		return -ENOMEM;
	for (int s = 0; ret == 0 && s < BASIS_SURFACES; s++) {
		job->distance[s] = calloc((size_t)info->width * info->height, sizeof(float));
		ret = job->distance[s] ? basis_places_read(sky->basis, pose, (enum basis_surface)s,
							   job->distance[s])
				       : -ENOMEM;
	}
	for (int k = 0; ret == 0 && k < threads; k++) {
		struct near_work *w = &job->work[k];

		w->sky = sky;
		w->distance = job->distance;
		w->light.slot = malloc(info->lights * sizeof(*w->light.slot));
		for (uint32_t i = 0; w->light.slot && i < info->lights; i++)
			w->light.slot[i] = -1;
		ret = w->light.slot ? 0 : -ENOMEM;
	}
	return ret;
}

static void near_job_free(struct near_job *job, int threads)
{
	for (int k = 0; job->work && k < threads; k++) {
		free(job->work[k].light.slot);
		free(job->work[k].light.light);
		free(job->work[k].light.amount);
	}
	for (int s = 0; s < BASIS_SURFACES; s++)
		free(job->distance[s]);
	free(job->work);
}

/* Copies the blocks of a tile, with those of the lamps after each kind, to where there is room for
 * them. */
static int fill_tile(struct near_layer *near, struct near_work *w, struct basis_tile *to)
{
	const struct basis_tile *from = w->tile;
	struct basis_block *block = near->layer.blocks + (to->blocks - near->layer.blocks);
	int made = 0;

	for (int n = 0, next; n < from->block_count; n = next) {
		const struct basis_block *b = &from->blocks[n];

		for (next = n + 1; next < from->block_count && from->blocks[next].kind == b->kind;)
			next++;
		memcpy(block + made, b, sizeof(*b) * (size_t)(next - n));
		made += next - n;
		if (make_block(near, w, b, next - n, &block[made]) < 0)
			return -ENOMEM;
		to->bytes += block[made].bytes;
		made += block[made].columns > 0;
	}
	to->block_count = made;
	return 0;
}

static void near_tile(void *context, int t, int worker)
{
	const struct near_job *job = context;
	struct near_work *w = &job->work[worker];

	w->tile = &job->from->tiles[t];
	if (w->err == 0)
		w->err = fill_tile(job->near, w, &job->near->layer.tiles[t]);
}

/* Makes each tile where there is room for all that it may have, and then closes the gaps. */
static int near_job_run(struct near_job *job, int tiles, struct pool *pool)
{
	struct basis_layer *layer = &job->near->layer;
	struct basis_block *room = layer->blocks;
	int ret = 0;

	for (int t = 0; t < tiles; t++) {
		layer->tiles[t] = job->from->tiles[t];
		layer->tiles[t].blocks = room;
		room += layer->tiles[t].block_count + BASIS_KIND_COUNT;
	}
	pool_run(pool, tiles, near_tile, job);
	for (int k = 0; ret == 0 && k < pool_threads(pool); k++)
		ret = job->work[k].err;
	for (int t = 0; ret == 0 && t < tiles; t++) {
		struct basis_block *to = layer->blocks + layer->block_count;
		const int count = layer->tiles[t].block_count;

		memmove(to, layer->tiles[t].blocks, sizeof(*to) * (size_t)count);
		layer->tiles[t].blocks = to;
		layer->block_count += count;
	}
	return ret;
}

int near_layer_create(struct near_layer *near, const struct near_sky *sky, int pose,
		      const struct basis_layer *layer, struct pool *pool)
{
	const int tiles = sky->basis->tiles_across * sky->basis->tiles_down;
	const size_t most = (size_t)layer->block_count + (size_t)tiles * BASIS_KIND_COUNT;
	struct near_job job = {.near = near, .from = layer};
	int ret = -ENOMEM;

	*near = (struct near_layer){.memory = NULL};
	near->layer.tiles = near_memory_take(near, sizeof(*near->layer.tiles) * (size_t)tiles);
	near->layer.blocks = near_memory_take(near, sizeof(*near->layer.blocks) * most);
	near->channels = sky->basis->info.grounds && !has_one_colour(sky->basis) ? 3 : 1;
	near->even = near_memory_take(near,
				      sizeof(*near->even) * (size_t)tiles *
					      (size_t)(near->channels * sky->lamps.count * POINTS));
	near->ground = near_memory_take(near, sizeof(*near->ground) * (size_t)tiles);
	if (near->layer.tiles && near->layer.blocks && near->even && near->ground)
		ret = near_job_create(&job, sky, pose, pool_threads(pool));
	if (ret == 0)
		ret = near_job_run(&job, tiles, pool);
	near_job_free(&job, pool_threads(pool));
	if (ret < 0)
		near_layer_free(near);
	return ret;
}
