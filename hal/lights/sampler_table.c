/* SPDX-License-Identifier: MIT */
#include "hal/lights/sampler_table.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Weights below this, half of the largest, are small. A light in which they matter has a fine sum
 * too (README.md, The arithmetic). */
#define SMALL_WEIGHT 16384

/* Two needed pixels with a gap of at most so many pixels between them are read in one segment. */
#define SEGMENT_GAP 64

struct table_packer {
	struct sampler_table *table;
	const struct sampler_shares *shares;
	size_t *order; /* [runs]: by strip, then light */
	float *scale;  /* [lights]: from weights to units of the light's largest */
	int spans, segments;
	size_t weights;
};

static int run_strip(const struct sampler_run *run)
{
	return run->y / SAMPLER_STRIP_ROWS;
}

static int run_light(const struct sampler_run *run)
{
	return run->light;
}

/* Counting sort of the order by a key in 0..keys - 1; stable. 0 or -ENOMEM. */
static int sort_by(struct table_packer *p, int (*key)(const struct sampler_run *), int keys)
{
	const size_t runs = p->shares->runs;
	size_t *first = calloc((size_t)keys + 1, sizeof(*first));
	size_t *sorted = malloc((runs + 1) * sizeof(*sorted));

	if (!first || !sorted) {
		free(first);
		free(sorted);
		return -ENOMEM;
	}
	for (size_t k = 0; k < runs; k++)
		first[key(&p->shares->run[p->order[k]]) + 1]++;
	for (int i = 0; i < keys; i++)
		first[i + 1] += first[i];
	for (size_t k = 0; k < runs; k++)
		sorted[first[key(&p->shares->run[p->order[k]])]++] = p->order[k];
	free(first);
	free(p->order);
	p->order = sorted;
	return 0;
}

/* A weight in whole units of scale; rounding may put the largest above most. */
static int32_t units_of(float weight, double scale, int32_t most)
{
	const int32_t units = (int32_t)((double)weight * scale + 0.5);

	return units < most ? units : most;
}

/* Finds each light's largest weight, its unit, and whether it has a fine sum. 0 or -ENOMEM. */
static int measure_lights(struct table_packer *p)
{
	struct measured {
		double with, whole, small, count;
		float largest;
	} *measured = calloc((size_t)p->table->lights, sizeof(*measured));

	if (!measured)
		return -ENOMEM;
	for (size_t k = 0; k < p->shares->runs; k++) {
		const struct sampler_run *run = &p->shares->run[k];
		const float *weight = p->shares->weight + run->first;
		struct measured *m = &measured[run->light];

		m->count += run->count;
		for (int i = 0; i < run->count; i++) {
			m->with += (double)weight[i];
			m->largest = weight[i] > m->largest ? weight[i] : m->largest;
		}
	}
	for (int i = 0; i < p->table->lights; i++)
		if (measured[i].largest > 0)
			p->scale[i] = (float)(SAMPLER_WEIGHT_MAX / (double)measured[i].largest);
	for (size_t k = 0; k < p->shares->runs; k++) {
		const struct sampler_run *run = &p->shares->run[k];
		const float *weight = p->shares->weight + run->first;
		const double scale = (double)p->scale[run->light];
		int whole = 0, small = 0;

		for (int i = 0; i < run->count; i++) {
			const int w = units_of(weight[i], scale, SAMPLER_WEIGHT_MAX);

			whole += w;
			small += w < SMALL_WEIGHT;
		}
		measured[run->light].whole += whole;
		measured[run->light].small += small;
	}
	for (int i = 0; i < p->table->lights; i++) {
		const struct measured *m = &measured[i];
		struct sampler_light *l = &p->table->light[i];

		*l = (struct sampler_light){-1, -1, {0, 0}, 1};
		if (!(m->largest > 0))
			continue;
		l->brighter = m->with / p->shares->undimmed[i];
		l->sum = p->table->sums++;
		if (m->whole < SMALL_WEIGHT * m->count || m->small * 65536 > m->whole)
			l->fine = p->table->sums++;
	}
	free(measured);
	return 0;
}

/* Writes the weights of a run. Returns their sum. */
static double write_weights(const struct table_packer *p, const struct sampler_run *run, bool fine,
			    uint16_t *weight)
{
	const float *from = p->shares->weight + run->first;
	const int bits = p->table->light[run->light].fine < 0 ? 0 : SAMPLER_FINE_BITS;
	const int shift = fine ? 0 : bits, mask = fine ? (1 << bits) - 1 : UINT16_MAX;
	const double scale = (double)p->scale[run->light] * (1 << bits);
	int64_t sum = 0;

	for (int i = 0; i < run->count; i++) {
		weight[i] = (uint16_t)(units_of(from[i], scale, SAMPLER_WEIGHT_MAX << bits) >>
					       shift &
				       mask);
		sum += weight[i];
	}
	return (double)sum;
}

/* Packs order[first .. end - 1], the runs of one light in one strip, into spans, with the whole or
 * with the fine weights. */
static void pack_part(struct table_packer *p, size_t first, size_t end, bool fine)
{
	struct sampler_table *t = p->table;
	struct sampler_part *part = &t->part[t->parts++];
	struct sampler_light *light = &t->light[p->shares->run[p->order[first]].light];

	*part = (struct sampler_part){
		.sum = fine ? light->fine : light->sum,
		.first_span = p->spans,
		.first_weight = p->weights,
	};
	for (size_t k = first; k < end; k++) {
		const struct sampler_run *run = &p->shares->run[p->order[k]];
		const int row = run->y % SAMPLER_STRIP_ROWS;
		int chunks = (run->count + SAMPLER_CHUNK - 1) / SAMPLER_CHUNK;

		light->whole[fine] += write_weights(p, run, fine, t->weight + p->weights);
		p->weights += (size_t)(chunks * SAMPLER_CHUNK);
		for (int x = run->x; chunks > 0; x += SAMPLER_CHUNKS_MAX * SAMPLER_CHUNK) {
			t->span[p->spans++] = (struct sampler_span){
				.offset = (uint32_t)(row * t->row_stride + x),
				.chunks = (uint32_t)(chunks < SAMPLER_CHUNKS_MAX
							     ? chunks
							     : SAMPLER_CHUNKS_MAX),
			};
			chunks -= SAMPLER_CHUNKS_MAX;
		}
	}
	part->spans = p->spans - part->first_span;
}

/* Packs the needed pixels of a row of a strip into segments, and clears needed[]. */
static void pack_segments(struct table_packer *p, int row, uint8_t *needed, int width)
{
	struct sampler_segment *open = NULL;

	for (int x = 0; x < width; x++) {
		if (!needed[x])
			continue;
		needed[x] = 0;
		if (!open || x - (open->x + open->count) > SEGMENT_GAP) {
			open = &p->table->segment[p->segments++];
			*open = (struct sampler_segment){(uint16_t)row, (uint16_t)x, 0};
		}
		open->count = (uint16_t)(x - open->x + 1);
	}
}

/* Packs order[first .. end - 1], the runs of a strip: its parts, then its segments. needed is
 * scratch of SAMPLER_STRIP_ROWS * width, 0 before and after. */
static void pack_strip(struct table_packer *p, size_t first, size_t end, uint8_t *needed, int width)
{
	struct sampler_table *t = p->table;

	for (size_t k = first, next; k < end; k = next) {
		const int light = p->shares->run[p->order[k]].light;

		for (next = k; next < end && p->shares->run[p->order[next]].light == light;)
			next++;
		if (t->light[light].sum >= 0)
			pack_part(p, k, next, false);
		if (t->light[light].fine >= 0)
			pack_part(p, k, next, true);
	}
	for (size_t k = first; k < end; k++) {
		const struct sampler_run *run = &p->shares->run[p->order[k]];

		memset(needed + run->y % SAMPLER_STRIP_ROWS * width + run->x, 1, run->count);
	}
	for (int row = 0; row < SAMPLER_STRIP_ROWS; row++)
		pack_segments(p, row, needed + (size_t)row * (size_t)width, width);
}

/* Makes room for everything that is packed. 0 or -ENOMEM. */
static int table_reserve(struct table_packer *p)
{
	struct sampler_table *t = p->table;
	size_t weights = 0, spans = 0;

	for (size_t k = 0; k < p->shares->runs; k++) {
		const struct sampler_run *run = &p->shares->run[k];
		const struct sampler_light *light = &t->light[run->light];
		const size_t chunks = (size_t)(run->count + SAMPLER_CHUNK - 1) / SAMPLER_CHUNK;
		const size_t sums = (size_t)(light->sum >= 0) + (size_t)(light->fine >= 0);

		weights += sums * chunks * SAMPLER_CHUNK;
		spans += sums * ((chunks + SAMPLER_CHUNKS_MAX - 1) / SAMPLER_CHUNKS_MAX);
	}
	weights = (weights + 64) / 32 * 32; /* 64 bytes are 32 weights */
	t->part = malloc((spans + 1) * sizeof(*t->part));
	t->span = malloc((spans + 1) * sizeof(*t->span));
	t->segment = malloc((p->shares->runs + 1) * sizeof(*t->segment));
	t->weight = aligned_alloc(64, weights * sizeof(*t->weight));
	if (!t->part || !t->span || !t->segment || !t->weight)
		return -ENOMEM;
	memset(t->weight, 0, weights * sizeof(*t->weight));
	return 0;
}

static int table_pack(struct table_packer *p, int width)
{
	struct sampler_table *t = p->table;
	uint8_t *needed = calloc((size_t)width, SAMPLER_STRIP_ROWS);
	size_t k = 0;
	int ret = needed ? measure_lights(p) : -ENOMEM;

	if (ret == 0)
		ret = table_reserve(p);
	if (ret == 0)
		ret = sort_by(p, run_light, t->lights);
	if (ret == 0)
		ret = sort_by(p, run_strip, t->strips);
	for (int s = 0; ret == 0 && s < t->strips; s++) {
		const size_t first = k;

		while (k < p->shares->runs && run_strip(&p->shares->run[p->order[k]]) == s)
			k++;
		t->strip[s].first_part = t->parts;
		t->strip[s].first_segment = p->segments;
		pack_strip(p, first, k, needed, width);
		t->strip[s].parts = t->parts - t->strip[s].first_part;
		t->strip[s].segments = p->segments - t->strip[s].first_segment;
	}
	free(needed);
	return ret;
}

int sampler_table_create(struct sampler_table *table, const struct sampler_shares *shares,
			 int lights, int width, int height)
{
	struct table_packer p = {.table = table, .shares = shares};
	int ret = -ENOMEM;

	*table = (struct sampler_table){
		.lights = lights,
		.strips = (height + SAMPLER_STRIP_ROWS - 1) / SAMPLER_STRIP_ROWS,
		/* Room for the last chunk of a row, which may extend beyond the row. */
		.row_stride = (width + 2 * SAMPLER_CHUNK - 1) / SAMPLER_CHUNK * SAMPLER_CHUNK,
	};
	table->light = calloc((size_t)lights, sizeof(*table->light));
	table->strip = calloc((size_t)table->strips, sizeof(*table->strip));
	p.order = malloc((shares->runs + 1) * sizeof(*p.order));
	p.scale = calloc((size_t)lights, sizeof(*p.scale));
	for (size_t k = 0; p.order && k < shares->runs; k++)
		p.order[k] = k;
	if (table->light && table->strip && p.order && p.scale)
		ret = table_pack(&p, width);
	free(p.order);
	free(p.scale);
	if (ret < 0)
		sampler_table_free(table);
	return ret;
}

void sampler_table_free(struct sampler_table *table)
{
	free(table->light);
	free(table->strip);
	free(table->part);
	free(table->span);
	free(table->segment);
	free(table->weight);
	memset(table, 0, sizeof(*table));
}
