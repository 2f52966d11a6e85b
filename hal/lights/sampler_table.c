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
	const struct sampler_share *shares;
	size_t count;
	float *weight; /* [count]: weights of the shares, divided by the lens's falloff */
	int *order;    /* [count]: shares sorted by light, later by strip and light */
	float *scale;  /* [lights]: from weights to units of the light's largest */
	int spans, segments;
	size_t weights, weight_room;
};

static int share_strip(const struct sampler_share *share)
{
	return share->y / SAMPLER_STRIP_ROWS;
}

static int share_light(const struct sampler_share *share)
{
	return share->light;
}

/* Counting sort of the order by a key in 0..keys - 1; stable. 0 or -ENOMEM. */
static int sort_by(struct table_packer *p, int (*key)(const struct sampler_share *), int keys)
{
	int *first = calloc((size_t)keys + 1, sizeof(*first));
	int *sorted = malloc((p->count + 1) * sizeof(*sorted));

	if (!first || !sorted) {
		free(first);
		free(sorted);
		return -ENOMEM;
	}
	for (size_t k = 0; k < p->count; k++)
		first[key(&p->shares[p->order[k]]) + 1]++;
	for (int i = 0; i < keys; i++)
		first[i + 1] += first[i];
	for (size_t k = 0; k < p->count; k++)
		sorted[first[key(&p->shares[p->order[k]])]++] = p->order[k];
	free(first);
	free(p->order);
	p->order = sorted;
	return 0;
}

/* A weight in units of the light's largest: the integer part, and the next SAMPLER_FINE_BITS
 * bits. */
struct weight_digits {
	uint16_t whole, fine;
};

/* The digits of share k; fine is 0 if its light has no fine sum. */
static struct weight_digits digits_of(const struct table_packer *p, int k)
{
	const int light = p->shares[k].light;
	const double weight = (double)p->weight[k] * p->scale[light];
	const double unit = 1 << SAMPLER_FINE_BITS;
	uint32_t all;

	if (p->table->light[light].fine < 0)
		return (struct weight_digits){(uint16_t)fmin(rint(weight), SAMPLER_WEIGHT_MAX), 0};
	all = (uint32_t)fmin(rint(weight * unit), SAMPLER_WEIGHT_MAX * unit);
	return (struct weight_digits){(uint16_t)(all >> SAMPLER_FINE_BITS),
				      (uint16_t)(all & ((1U << SAMPLER_FINE_BITS) - 1))};
}

/* Sets up a light from its shares, order[first .. first + count - 1]. */
static void measure_light(struct table_packer *p, int light, size_t first, size_t count)
{
	struct sampler_light *l = &p->table->light[light];
	double largest = 0, whole = 0, small = 0, with = 0, without = 0;

	*l = (struct sampler_light){-1, -1, {0, 0}, 1};
	for (size_t k = first; k < first + count; k++) {
		with += p->weight[p->order[k]];
		without += p->shares[p->order[k]].weight;
		largest = fmax(largest, p->weight[p->order[k]]);
	}
	if (count == 0)
		p->table->unseen++;
	if (!(largest > 0))
		return;
	l->brighter = with / without;
	p->scale[light] = (float)(SAMPLER_WEIGHT_MAX / largest);
	l->sum = p->table->sums++;
	for (size_t k = first; k < first + count; k++) {
		const double w = digits_of(p, p->order[k]).whole;

		whole += w;
		small += w < SMALL_WEIGHT;
	}
	if (whole < (double)SMALL_WEIGHT * (double)count || small * 65536 > whole)
		l->fine = p->table->sums++;
	for (size_t k = first; k < first + count; k++) {
		const struct weight_digits d = digits_of(p, p->order[k]);

		l->whole[0] += d.whole;
		l->whole[1] += d.fine;
	}
}

static void measure_lights(struct table_packer *p)
{
	size_t k = 0;

	for (int i = 0; i < p->table->lights; i++) {
		const size_t first = k;

		while (k < p->count && p->shares[p->order[k]].light == i)
			k++;
		measure_light(p, i, first, k - first);
	}
}

static bool share_continues(const struct sampler_share *before, const struct sampler_share *here)
{
	return before->y == here->y && before->x + 1 == here->x;
}

/* Appends count weights of 0. Returns them; NULL: no memory. */
static uint16_t *add_weights(struct table_packer *p, size_t count)
{
	struct sampler_table *t = p->table;
	uint16_t *weights;

	if (p->weights + count >= p->weight_room) {
		const size_t room = 2 * (p->weights + count + 4096) / 64 * 64;
		uint16_t *more = aligned_alloc(64, room * sizeof(*more));

		if (!more)
			return NULL;
		memset(more, 0, room * sizeof(*more));
		if (p->weights)
			memcpy(more, t->weight, p->weights * sizeof(*more));
		free(t->weight);
		t->weight = more;
		p->weight_room = room;
	}
	weights = t->weight + p->weights;
	p->weights += count;
	return weights;
}

/* Packs order[first .. end - 1], the shares of one light in one strip, into spans, with the whole
 * or with the fine weights. */
static int pack_part(struct table_packer *p, size_t first, size_t end, bool fine)
{
	struct sampler_table *t = p->table;
	const struct sampler_light *light = &t->light[p->shares[p->order[first]].light];

	t->part[t->parts++] = (struct sampler_part){
		.sum = fine ? light->fine : light->sum,
		.first_span = p->spans,
		.first_weight = p->weights,
	};
	for (size_t k = first; k < end;) {
		const struct sampler_share *share = &p->shares[p->order[k]];
		const int row = share->y % SAMPLER_STRIP_ROWS;
		size_t count = 1, chunks;
		uint16_t *weight;

		while (k + count < end && count < SAMPLER_CHUNKS_MAX * SAMPLER_CHUNK &&
		       share_continues(&p->shares[p->order[k + count - 1]],
				       &p->shares[p->order[k + count]]))
			count++;
		chunks = (count + SAMPLER_CHUNK - 1) / SAMPLER_CHUNK;
		weight = add_weights(p, chunks * SAMPLER_CHUNK);
		if (!weight)
			return -ENOMEM;
		for (size_t i = 0; i < count; i++) {
			const struct weight_digits d = digits_of(p, p->order[k + i]);

			weight[i] = fine ? d.fine : d.whole;
		}
		t->span[p->spans++] = (struct sampler_span){
			.offset = (uint32_t)(row * t->row_stride + share->x),
			.chunks = (uint32_t)chunks,
		};
		k += count;
	}
	t->part[t->parts - 1].spans = p->spans - t->part[t->parts - 1].first_span;
	return 0;
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

/* Packs order[first .. end - 1], the shares of a strip: its parts, then its segments. needed is
 * scratch of SAMPLER_STRIP_ROWS * width, 0 before and after. */
static int pack_strip(struct table_packer *p, size_t first, size_t end, uint8_t *needed, int width)
{
	struct sampler_table *t = p->table;
	int ret = 0;

	for (size_t k = first; ret == 0 && k < end;) {
		const int light = p->shares[p->order[k]].light;
		size_t next = k;

		while (next < end && p->shares[p->order[next]].light == light)
			next++;
		if (t->light[light].sum >= 0)
			ret = pack_part(p, k, next, false);
		if (ret == 0 && t->light[light].fine >= 0)
			ret = pack_part(p, k, next, true);
		k = next;
	}
	for (size_t k = first; k < end; k++) {
		const struct sampler_share *share = &p->shares[p->order[k]];

		needed[(size_t)(share->y % SAMPLER_STRIP_ROWS) * (size_t)width + share->x] = 1;
	}
	for (int row = 0; row < SAMPLER_STRIP_ROWS; row++)
		pack_segments(p, row, needed + (size_t)row * (size_t)width, width);
	return ret;
}

static int pack_strips(struct table_packer *p, int width)
{
	struct sampler_table *t = p->table;
	uint8_t *needed = calloc((size_t)width, SAMPLER_STRIP_ROWS);
	size_t k = 0;
	int ret = needed ? 0 : -ENOMEM;

	for (int s = 0; ret == 0 && s < t->strips; s++) {
		const size_t first = k;

		while (k < p->count && share_strip(&p->shares[p->order[k]]) == s)
			k++;
		t->strip[s].first_part = t->parts;
		t->strip[s].first_segment = p->segments;
		ret = pack_strip(p, first, k, needed, width);
		t->strip[s].parts = t->parts - t->strip[s].first_part;
		t->strip[s].segments = p->segments - t->strip[s].first_segment;
	}
	free(needed);
	return ret;
}

static int table_pack(struct table_packer *p, const struct fisheye *lens, int width)
{
	struct sampler_table *t = p->table;
	int ret;

	for (size_t k = 0; k < p->count; k++) {
		const double px[2] = {p->shares[k].x + 0.5, p->shares[k].y + 0.5};

		p->order[k] = (int)k;
		p->weight[k] = (float)((double)p->shares[k].weight / fisheye_falloff(lens, px));
	}
	ret = sort_by(p, share_light, t->lights);
	if (ret < 0)
		return ret;
	measure_lights(p);
	ret = sort_by(p, share_strip, t->strips);
	return ret < 0 ? ret : pack_strips(p, width);
}

/* Shrinks memory to bytes; returns it unchanged if that fails. */
static void *memory_shrunk(void *memory, size_t bytes)
{
	void *smaller = realloc(memory, bytes);

	if (!smaller)
		return memory;
	return smaller;
}

static void table_shrink(struct table_packer *p)
{
	struct sampler_table *t = p->table;

	t->part = memory_shrunk(t->part, ((size_t)t->parts + 1) * sizeof(*t->part));
	t->span = memory_shrunk(t->span, ((size_t)p->spans + 1) * sizeof(*t->span));
	t->segment = memory_shrunk(t->segment, ((size_t)p->segments + 1) * sizeof(*t->segment));
}

int sampler_table_create(struct sampler_table *table, const struct sampler_shares *shares,
			 const struct fisheye *lens, int lights, int width, int height)
{
	/* Upper bound of parts, spans and segments: each share is one, and has a fine one. */
	const size_t most = 2 * shares->count + 1;
	struct table_packer p = {.table = table, .shares = shares->items, .count = shares->count};
	int ret = -ENOMEM;

	*table = (struct sampler_table){
		.lights = lights,
		.strips = (height + SAMPLER_STRIP_ROWS - 1) / SAMPLER_STRIP_ROWS,
		/* Room for the last chunk of a row, which may extend beyond the row. */
		.row_stride = (width + 2 * SAMPLER_CHUNK - 1) / SAMPLER_CHUNK * SAMPLER_CHUNK,
	};
	table->light = calloc((size_t)lights, sizeof(*table->light));
	table->strip = calloc((size_t)table->strips, sizeof(*table->strip));
	table->part = malloc(most * sizeof(*table->part));
	table->span = malloc(most * sizeof(*table->span));
	table->segment = malloc(most * sizeof(*table->segment));
	p.order = malloc((p.count + 1) * sizeof(*p.order));
	p.weight = malloc((p.count + 1) * sizeof(*p.weight));
	p.scale = calloc((size_t)lights, sizeof(*p.scale));
	if (table->light && table->strip && table->part && table->span && table->segment &&
	    p.order && p.weight && p.scale && add_weights(&p, 0))
		ret = table_pack(&p, lens, width);
	free(p.order);
	free(p.weight);
	free(p.scale);
	if (ret < 0)
		sampler_table_free(table);
	else
		table_shrink(&p);
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
