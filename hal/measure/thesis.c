/* SPDX-License-Identifier: MIT */
#include "hal/measure/thesis.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/log.h"

struct thesis {
	const struct basis *basis;
	const struct basis_layer *layer;
	int width, height, lights;
	uint8_t *role;	/* [height * width]: enum thesis_role */
	uint8_t **row;	/* [height * width]: [lights][3] of an object, [lights][6] in shadow */
	double rate;	/* radiance that byte 255 of an object's row stands for */
	double *weight; /* [lights][3] */
	int *used;	/* [used_count]: which lights reach the threshold */
	int used_count;
	uint64_t light_bytes; /* bytes of one light in all rows */
};

static size_t thesis_pixels(const struct thesis *t)
{
	return (size_t)t->width * (size_t)t->height;
}

/* ---- roles and memory ---- */

/* The thesis has no coverage: a pixel is the object's if the object covers more than half of it. */
static void find_roles(struct thesis *t)
{
	const uint16_t *coverage = t->basis->poses[0].coverage;
	const int tiles = t->basis->tiles_across * t->basis->tiles_down;

	for (int k = 0; k < tiles; k++) {
		const struct basis_tile *tile = &t->layer->tiles[k];

		for (int b = 0; b < tile->block_count; b++) {
			const struct basis_block *block = &tile->blocks[b];

			for (int p = 0; p < block->pixels; p++) {
				const int x = tile->x + block->pixel[p] % BASIS_TILE;
				const int y = tile->y + block->pixel[p] / BASIS_TILE;
				const size_t at = (size_t)y * (size_t)t->width + (size_t)x;

				if (block->kind != BASIS_KIND_T)
					t->role[at] = THESIS_SHADOW;
			}
		}
	}
	for (size_t at = 0; at < thesis_pixels(t); at++) {
		/* also where it has no T row: it is black */
		if (coverage[at] > 32767)
			t->role[at] = THESIS_OBJECT;
		t->light_bytes += t->role[at] * UINT64_C(3);
	}
}

static uint64_t memory_free(void)
{
	FILE *file = fopen("/proc/meminfo", "r");
	unsigned long long kib = 0;
	char line[128];

	if (!file)
		return UINT64_MAX;
	while (fgets(line, sizeof(line), file) && sscanf(line, "MemAvailable: %llu kB", &kib) != 1)
		;
	fclose(file);
	return kib ? (uint64_t)kib * 1024 : UINT64_MAX;
}

static int allocate_rows(struct thesis *t, struct fault *fault)
{
	const uint64_t needed = t->light_bytes * (uint64_t)t->lights, there = memory_free();

	/* plus the overhead of each row, and room for other programs */
	if (needed + thesis_pixels(t) * 32 + (UINT64_C(256) << 20) > there)
		return fault_say(
			fault, -ENOMEM,
			"the thesis's basis takes %.1f GB of memory and %.1f GB are free: --thesis no leaves it out",
			(double)needed / 1e9, (double)there / 1e9);
	for (size_t at = 0; at < thesis_pixels(t); at++) {
		if (t->role[at] == THESIS_PICTURE)
			continue;
		t->row[at] = calloc((size_t)t->role[at] * 3, (size_t)t->lights);
		if (!t->row[at])
			return fault_say(
				fault, -ENOMEM,
				"the thesis's basis takes %.1f GB of memory, more than there is: --thesis no leaves it out",
				(double)needed / 1e9);
	}
	return 0;
}

/* ---- quantisation ---- */

struct quantiser {
	struct thesis *thesis;
	struct unpacked *unpacked; /* one for each thread */
};

static uint8_t byte_of(float value)
{
	return (uint8_t)(value <= 0 ? 0 : value >= 255 ? 255 : value + 0.5F);
}

/* The pixels of a tile that have a row. */
struct thesis_tile {
	int count;
	int pixel[UNPACKED_PIXELS]; /* in the tile */
	uint8_t *row[UNPACKED_PIXELS];
	bool is_object[UNPACKED_PIXELS];
	float most[UNPACKED_PIXELS]; /* what 255 stands for */
};

static void find_rows(const struct thesis *t, const struct basis_tile *tile,
		      struct thesis_tile *rows)
{
	rows->count = 0;
	for (int p = 0; p < UNPACKED_PIXELS; p++) {
		const int x = tile->x + p % BASIS_TILE, y = tile->y + p / BASIS_TILE;
		const size_t at = (size_t)y * (size_t)t->width + (size_t)x;

		if (p % BASIS_TILE >= tile->width || p / BASIS_TILE >= tile->height ||
		    t->role[at] == THESIS_PICTURE)
			continue;
		rows->pixel[rows->count] = p;
		rows->row[rows->count] = t->row[at];
		rows->is_object[rows->count] = t->role[at] == THESIS_OBJECT;
		rows->most[rows->count++] = t->role[at] == THESIS_OBJECT ? (float)t->rate : 0;
	}
}

static void find_most(const struct unpacked *from, struct thesis_tile *rows)
{
	for (int k = 0; k < 3 * from->lights; k++) {
		for (int n = 0; n < rows->count; n++) {
			const int p = rows->pixel[n];
			const float u = from->unlit[k][p], s = u - from->taken[k][p];

			if (!rows->is_object[n])
				rows->most[n] = fmaxf(rows->most[n], fmaxf(u, s));
		}
	}
}

/* Fills in the rows, light by light in the order of the source. */
static void fill_rows(const struct unpacked *from, const struct thesis_tile *rows)
{
	for (int k = 0; k < 3 * from->lights; k++) {
		const int c = k / from->lights, i = k % from->lights;

		for (int n = 0; n < rows->count; n++) {
			const int p = rows->pixel[n];
			const float unit = rows->most[n] > 0 ? 255 / rows->most[n] : 0;
			uint8_t *row = rows->row[n];

			if (rows->is_object[n]) {
				row[3 * i + c] = byte_of(from->object[k][p] * unit);
				continue;
			}
			row[6 * i + c] = byte_of(from->unlit[k][p] * unit);
			row[6 * i + 3 + c] =
				byte_of((from->unlit[k][p] - from->taken[k][p]) * unit);
		}
	}
}

static void quantise_tile(void *context, int item, int worker)
{
	const struct quantiser *q = context;
	struct unpacked *from = &q->unpacked[worker];
	const struct basis_tile *tile = &q->thesis->layer->tiles[item];
	struct thesis_tile rows;

	find_rows(q->thesis, tile, &rows);
	if (!rows.count)
		return;
	unpacked_fill(from, q->thesis->basis, tile);
	find_most(from, &rows);
	fill_rows(from, &rows);
}

static int thesis_quantise(struct thesis *t, struct pool *pool)
{
	const float(*peak)[3] = t->basis->poses[0].peak;
	const int threads = pool_threads(pool);
	struct quantiser q = {t, calloc((size_t)threads, sizeof(*q.unpacked))};
	int err = q.unpacked ? 0 : -ENOMEM;

	for (int i = 0; i < 3 * t->lights; i++)
		t->rate = fmax(t->rate, (double)peak[i / 3][i % 3]);
	if (!(t->rate > 0))
		t->rate = 1;
	for (int k = 0; !err && k < threads; k++)
		err = unpacked_create(&q.unpacked[k], t->basis);
	if (!err)
		pool_run(pool, t->basis->tiles_across * t->basis->tiles_down, quantise_tile, &q);
	for (int k = 0; q.unpacked && k < threads; k++)
		unpacked_free(&q.unpacked[k]);
	free(q.unpacked);
	return err;
}

int thesis_create(struct thesis **thesis, const struct basis *basis,
		  const struct basis_layer *layer, struct pool *pool, struct fault *fault)
{
	struct thesis *t = calloc(1, sizeof(*t));
	int err = -ENOMEM;

	if (!t)
		return fault_say(fault, err, "not enough memory");
	*t = (struct thesis){.basis = basis,
			     .layer = layer,
			     .width = (int)basis->info.width,
			     .height = (int)basis->info.height,
			     .lights = (int)basis->info.lights};
	t->role = calloc(thesis_pixels(t), sizeof(*t->role));
	t->row = calloc(thesis_pixels(t), sizeof(*t->row));
	t->weight = calloc(3 * (size_t)t->lights, sizeof(*t->weight));
	t->used = calloc((size_t)t->lights, sizeof(*t->used));
	if (!t->role || !t->row || !t->weight || !t->used) {
		fault_say(fault, err, "not enough memory for a picture of %dx%d", t->width,
			  t->height);
		goto failed;
	}
	find_roles(t);
	err = allocate_rows(t, fault);
	if (err)
		goto failed;
	if (basis->poses[0].mirror_count || basis->poses[0].glass_count)
		log_warning(
			"the thesis's way has no glass and no mirrors: what they show is black in it (reflect = cells puts mirrors into the lights)");
	err = thesis_quantise(t, pool);
	if (err) {
		fault_say(fault, err, "not enough memory for %d lights", t->lights);
		goto failed;
	}
	*thesis = t;
	return 0;
failed:
	thesis_destroy(t);
	return err;
}

void thesis_destroy(struct thesis *t)
{
	if (!t)
		return;
	for (size_t at = 0; t->row && at < thesis_pixels(t); at++)
		free(t->row[at]);
	free(t->row);
	free(t->role);
	free(t->weight);
	free(t->used);
	free(t);
}

enum thesis_role thesis_pixel(const struct thesis *t, int x, int y, const uint8_t **row)
{
	const size_t at = (size_t)y * (size_t)t->width + (size_t)x;

	*row = t->row[at];
	return (enum thesis_role)t->role[at];
}

double thesis_rate(const struct thesis *t)
{
	return t->rate;
}

uint64_t thesis_bytes(const struct thesis *t, int lights_used)
{
	return t->light_bytes * (uint64_t)lights_used;
}

void thesis_light(struct thesis *t, const struct light_selection *lights)
{
	t->used_count = 0;
	for (int i = 0; i < t->lights; i++) {
		for (int c = 0; c < 3; c++)
			t->weight[3 * i + c] = lights->radiance[i][c];
		if (lights->used[i])
			t->used[t->used_count++] = i;
	}
}

/* ---- a frame ---- */

struct frame_work {
	const struct thesis *thesis;
	const struct canvas *background;
	struct canvas *out;
};

static uint8_t code_whole(double value)
{
	return value >= 255 ? 255 : (uint8_t)value;
}

static void object_pixel(const struct thesis *t, const uint8_t *row, uint8_t *out)
{
	double r = 0, g = 0, b = 0;

	for (int k = 0; k < t->used_count; k++) {
		const int at = 3 * t->used[k];

		r += row[at] * t->weight[at];
		g += row[at + 1] * t->weight[at + 1];
		b += row[at + 2] * t->weight[at + 2];
	}
	out[2] = code_whole(r * t->rate + 0.5);
	out[1] = code_whole(g * t->rate + 0.5);
	out[0] = code_whole(b * t->rate + 0.5);
}

static void shadow_pixel(const struct thesis *t, const uint8_t *row, const uint8_t *in,
			 uint8_t *out)
{
	double without[3] = {0, 0, 0}, with[3] = {0, 0, 0};

	for (int k = 0; k < t->used_count; k++) {
		const double *w = t->weight + 3 * t->used[k];
		const uint8_t *v = row + 6 * t->used[k];

		without[0] += v[0] * w[0];
		without[1] += v[1] * w[1];
		without[2] += v[2] * w[2];
		with[0] += v[3] * w[0];
		with[1] += v[4] * w[1];
		with[2] += v[5] * w[2];
	}
	for (int c = 0; c < 3; c++)
		out[2 - c] = without[c] > 0 ? code_whole(in[2 - c] * with[c] / without[c]) : 0;
}

static void thesis_run_row(void *context, int y, int worker)
{
	const struct frame_work *work = context;
	const struct thesis *t = work->thesis;
	const uint8_t *in = work->background->pixels + (size_t)y * work->background->stride;
	uint8_t *out = work->out->pixels + (size_t)y * work->out->stride;

	(void)worker;
	for (int x = 0; x < t->width; x++, in += 4, out += 4) {
		const uint8_t *row;
		const enum thesis_role role = thesis_pixel(t, x, y, &row);

		if (role == THESIS_OBJECT)
			object_pixel(t, row, out);
		else if (role == THESIS_SHADOW)
			shadow_pixel(t, row, in, out);
		else
			memcpy(out, in, 3);
	}
}

void thesis_run(const struct thesis *t, const struct canvas *background, struct canvas *out,
		struct pool *pool)
{
	struct frame_work work = {t, background, out};

	pool_run(pool, t->height, thesis_run_row, &work);
}
