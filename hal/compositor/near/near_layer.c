/* SPDX-License-Identifier: MIT */
#include "hal/compositor/near/near_layer.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"
#include "hal/basis/basis_places.h"

#define PIXELS (BASIS_TILE * BASIS_TILE)
#define COLUMN_MOST 32767
/* Bytes of a block's lights, scales and pixels before its columns. */
#define LAMP_HEAD (LAMPS_MAX * (sizeof(uint16_t) + sizeof(float)) + PIXELS * sizeof(uint16_t) + 16)
_Static_assert(LAMP_HEAD % BASIS_ALIGN == 0, "columns are aligned");

/* A piece of the layer's memory; its bytes follow at BASIS_ALIGN. */
struct near_memory {
	struct near_memory *next;
};

static void *near_memory_take(struct near_layer *near, size_t bytes)
{
	const size_t whole = (bytes + 2 * BASIS_ALIGN - 1) / BASIS_ALIGN * BASIS_ALIGN;
	struct near_memory *memory = aligned_alloc(BASIS_ALIGN, whole);

	if (!memory)
		return NULL;
	memset(memory, 0, whole);
	memory->next = near->memory;
	near->memory = memory;
	return (char *)memory + BASIS_ALIGN;
}

void near_layer_free(struct near_layer *near)
{
	while (near->memory) {
		struct near_memory *next = near->memory->next;

		free(near->memory);
		near->memory = next;
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

struct near_work {
	const struct near_sky *sky;
	const struct basis_tile *tile;
	float *distance[BASIS_SURFACES]; /* [height][width] */
	struct near_light light;
	float value[LAMPS_MAX][3][PIXELS];
};

static int near_work_create(struct near_work *w, const struct near_sky *sky, int pose)
{
	const struct basis_info_chunk *info = &sky->basis->info;
	int ret = 0;

	*w = (struct near_work){.sky = sky};
	w->light.slot = malloc(info->lights * sizeof(*w->light.slot));
	for (int s = 0; s < BASIS_SURFACES; s++)
		w->distance[s] = calloc((size_t)info->width * info->height, sizeof(float));
	if (!w->light.slot || !w->distance[0] || !w->distance[1])
		return -ENOMEM;
	for (uint32_t i = 0; i < info->lights; i++)
		w->light.slot[i] = -1;
	for (int s = 0; ret == 0 && s < BASIS_SURFACES; s++)
		ret = basis_places_read(sky->basis, pose, (enum basis_surface)s, w->distance[s]);
	return ret;
}

static void near_work_free(struct near_work *w)
{
	for (int s = 0; s < BASIS_SURFACES; s++)
		free(w->distance[s]);
	free(w->light.slot);
	free(w->light.light);
	free(w->light.amount);
}

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

static bool place_of(const struct near_work *w, enum basis_kind kind, int pixel, double place[3])
{
	const int x = w->tile->x + pixel % BASIS_TILE, y = w->tile->y + pixel / BASIS_TILE;
	const size_t at = (size_t)y * w->sky->basis->info.width + (size_t)x;
	const float distance =
		w->distance[kind == BASIS_KIND_T ? BASIS_OBJECT : BASIS_RECEIVER][at];

	if (kind == BASIS_KIND_V)
		return near_sky_ground(w->sky, x + 0.5, y + 0.5, place);
	return distance > 0 && near_sky_surface(w->sky, x + 0.5, y + 0.5, (double)distance, place);
}

/* Finds the light of a lamp at the pixels that are set in listed. */
static int light_fill(struct near_work *w, enum basis_kind kind, int lamp, const bool *listed)
{
	struct near_share share[NEAR_SHARES];
	double place[3];

	light_clear(&w->light);
	for (int p = 0; p < PIXELS; p++) {
		const int count = listed[p] && place_of(w, kind, p, place)
					  ? near_sky_shares(w->sky, lamp, place, share)
					  : 0;

		for (int n = 0; n < count; n++)
			if (light_add(&w->light, &share[n], p) < 0)
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

static void add_patterns(const struct near_work *w, const struct basis_block *b, int lamp, int c,
			 float *value)
{
	const int panels = basis_panels16(b->pixels), channel = b->channels == 3 ? c : 0;

	for (int j = 0; j < b->patterns; j++) {
		float y[PIXELS] = {0};

		for (int k = 0; k < w->light.count; k++) {
			const int i = w->light.light[k];
			const float of = pattern_of(w->sky->basis, b, j, i) *
					 light_factor(w->sky, b->kind, lamp, i, c);

			for (int p = 0; p < PIXELS; p++)
				y[p] += of * w->light.amount[k][p];
		}
		for (int n = 0; n < b->pixels; n++) {
			const int16_t *line = b->coefficient + basis_line16(panels, b->patterns,
									    channel,
									    n / BASIS_LINE16, j) *
								       BASIS_LINE16;

			value[n] += y[b->pixel[n]] * (float)line[n % BASIS_LINE16];
		}
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
	const int panels = basis_panels16(b->pixels), channel = b->channels == 3 ? c : 0;

	for (int k = 0; k < w->light.count; k++) {
		const int n = find_column(b, w->light.light[k]);
		const float scale = n < 0 ? 0
					  : b->column_scale[n] * light_factor(w->sky, b->kind, lamp,
									      w->light.light[k], c);

		for (int p = 0; n >= 0 && p < b->pixels; p++) {
			const size_t line = basis_line16(panels, b->columns, channel,
							 p / BASIS_LINE16, n);
			const int is = b->bits == 8 ? basis_column8_value(b, n, channel, p)
						    : b->column16[line * BASIS_LINE16 +
								  (size_t)(p % BASIS_LINE16)];

			value[p] += scale * w->light.amount[k][b->pixel[p]] * (float)is;
		}
	}
}

static void add_block(struct near_work *w, const struct basis_block *b, int lamp)
{
	for (int c = 0; c < 3; c++) {
		float value[PIXELS] = {0};

		add_patterns(w, b, lamp, c, value);
		add_columns(w, b, lamp, c, value);
		for (int n = 0; n < b->pixels; n++)
			w->value[lamp][c][b->pixel[n]] +=
				value[n] *
				(b->tint ? (float)b->tint[c * b->pixels + n] / BASIS_TINT_ONE : 1);
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
	for (int l = 0; l < w->sky->lamps.count; l++) {
		if (light_fill(w, b->kind, l, listed) < 0)
			return -ENOMEM;
		for (int k = 0; k < count; k++)
			add_block(w, &b[k], l);
	}
	return write_columns(near, w, b, pixel, pixels, to);
}

/* ---- the ground ---- */

#define STEP (BASIS_TILE / (NEAR_GRID - 1))
/* Where less light than this arrives, none is taken. */
#define LEAST 0x1p-20F
#define MOST (127 * 0x1p24F) /* as KERNEL_LIMIT */

static int make_even(struct near_layer *near, const struct near_work *w, struct near_tile *tile)
{
	tile->even = near_memory_take(near, sizeof(*tile->even) * (size_t)w->sky->lamps.count);
	if (!tile->even)
		return -ENOMEM;
	for (int k = 0; k < NEAR_GRID * NEAR_GRID; k++) {
		double place[3], even[3] = {0};
		const bool ground = near_sky_ground(w->sky, w->tile->x + k % NEAR_GRID * STEP,
						    w->tile->y + k / NEAR_GRID * STEP, place);

		for (int l = 0; l < w->sky->lamps.count; l++) {
			if (ground)
				near_sky_even(w->sky, l, place, even);
			for (int c = 0; c < 3; c++)
				tile->even[l][k][c] = (float)even[c];
		}
	}
	return 0;
}

/* As wide as the registers of every machine. */
enum { WIDE = 4 };
typedef float near_floats __attribute__((vector_size(WIDE * sizeof(float))));
typedef int32_t near_ints __attribute__((vector_size(WIDE * sizeof(int32_t))));

/* Multiplies values by factors, and clamps them. */
static inline void multiply(int32_t *values, near_floats factor)
{
	near_floats product;
	near_ints row, above, below;

	memcpy(&row, values, sizeof(row));
	product = __builtin_convertvector(row, near_floats) * factor;
	above = product > MOST;
	below = product < -MOST;
	product = (near_floats)((near_ints)product & ~(above | below));
	row = __builtin_convertvector(product, near_ints) | (above & (int32_t)MOST) |
	      (below & -(int32_t)MOST);
	memcpy(values, &row, sizeof(row));
}

void near_divide(const struct near_tile *tile, int lamps, const float (*share)[3],
		 int32_t (*taken)[PIXELS])
{
	_Static_assert(STEP == WIDE, "a square of the grid is a vector wide");
	const near_floats u = {0.5F / STEP, 1.5F / STEP, 2.5F / STEP, 3.5F / STEP};

	for (int c = 0; c < 3; c++) {
		float one[NEAR_GRID * NEAR_GRID];

		for (int k = 0; k < NEAR_GRID * NEAR_GRID; k++) {
			float sum = 1;

			for (int l = 0; l < lamps; l++)
				sum += share[l][c] * (tile->even[l][k][c] - 1);
			one[k] = 1 / (sum > LEAST ? sum : LEAST);
		}
		for (int k = 0; k < (NEAR_GRID - 1) * (NEAR_GRID - 1); k++) {
			const int i = k % (NEAR_GRID - 1), j = k / (NEAR_GRID - 1);
			const float *up = &one[j * NEAR_GRID + i], *low = up + NEAR_GRID;
			const near_floats upper = up[0] + u * (up[1] - up[0]);
			const near_floats change = low[0] + u * (low[1] - low[0]) - upper;
			int32_t *values = taken[c] + j * STEP * BASIS_TILE + i * STEP;

			for (int y = 0; y < STEP; y++)
				multiply(values + y * BASIS_TILE, upper + u[y] * change);
		}
	}
}

/* ---- a layer ---- */

/* Copies the blocks of a tile, with those of the lamps after each kind. */
static int fill_tile(struct near_layer *near, struct near_work *w, int t)
{
	const struct basis_tile *from = w->tile;
	struct basis_tile *to = &near->layer.tiles[t];
	struct basis_block *block = near->layer.blocks + near->layer.block_count;
	int made = 0;

	*to = *from;
	to->blocks = block;
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
		if (b->kind == BASIS_KIND_V && !near->tile[t].even &&
		    make_even(near, w, &near->tile[t]) < 0)
			return -ENOMEM;
	}
	to->block_count = made;
	near->layer.block_count += made;
	return 0;
}

int near_layer_create(struct near_layer *near, const struct near_sky *sky, int pose,
		      const struct basis_layer *layer)
{
	const int tiles = sky->basis->tiles_across * sky->basis->tiles_down;
	const size_t most = (size_t)layer->block_count + (size_t)tiles * BASIS_KIND_COUNT;
	struct near_work work;
	int ret;

	*near = (struct near_layer){.memory = NULL};
	near->layer.tiles = near_memory_take(near, sizeof(*near->layer.tiles) * (size_t)tiles);
	near->layer.blocks = near_memory_take(near, sizeof(*near->layer.blocks) * most);
	near->tile = near_memory_take(near, sizeof(*near->tile) * (size_t)tiles);
	ret = near_work_create(&work, sky, pose);
	if (!near->layer.tiles || !near->layer.blocks || !near->tile)
		ret = -ENOMEM;
	for (int t = 0; ret == 0 && t < tiles; t++) {
		work.tile = &layer->tiles[t];
		ret = fill_tile(near, &work, t);
	}
	near_work_free(&work);
	if (ret < 0)
		near_layer_free(near);
	return ret;
}
