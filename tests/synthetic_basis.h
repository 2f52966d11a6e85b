/*
 * Basis files of random content for tests: blocks of any shape, written by the writer, read by the
 * reader. What they hold is such as a bake could have made: under a sky of radiance 1 the object
 * gives off up to `peak`, and ratios lie in about 0..1 + bounce.
 *
 * Header only, because each test is one program of one file.
 */
#ifndef INLAY_TESTS_SYNTHETIC_BASIS_H
#define INLAY_TESTS_SYNTHETIC_BASIS_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

#include "hal/basis/basis.h"
#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_writer.h"
#include "tests/unit/chance.h"

#define SYNTHETIC_PIXELS (BASIS_TILE * BASIS_TILE)
#define SYNTHETIC_LAYERS_MAX 4

struct synthetic_options {
	int width, height, lights, grounds;
	int coarse;	       /* K; 0: each light is its own */
	int patterns;	       /* of each block */
	int columns;	       /* of each block, of random lights; below 0: of all of them.
				  Without patterns and columns it is all, too */
	int bits;	       /* of columns: 8 or 16; 0: 16 */
	int layers;	       /* blocks of a kind over the same pixels (but U); 0: 1 */
	bool grey;	       /* one channel for all three ... */
	bool tinted;	       /* ... times each pixel's tint */
	bool vary;	       /* the above six hold for the most; each block draws its own */
	bool exact;	       /* write an exact layer too */
	double object_share;   /* of pixels with a T row ... */
	double ground_share;   /* ... with a V row ... */
	double stand_in_share; /* ... with D and U rows (the two exclude each other) */
	double unlit_share;    /* of these pixels: U is 0 (D is not) */
	double peak;	       /* of a pixel's object radiance under L_i = 1, at most */
	double bounce;	       /* v and d / u lie in -bounce..1 */
	double column_cut;     /* to be declared */
	uint64_t seed;
};

struct synthetic {
	struct basis basis;
	char folder[64], path[80];
};

/* A block that is being made. */
struct synthetic_block {
	struct basis_block_entry entry;
	struct basis_layout at;
	uint8_t *payload;
};

/* Pixels that blocks share: of one kind and, if that is V, one ground term. */
struct synthetic_group {
	enum basis_kind kind;
	int ground, pixels;
	uint16_t pixel[SYNTHETIC_PIXELS];
	double factor[SYNTHETIC_PIXELS]; /* of what is there: in -bounce..1; T and U: 1 */
	bool unlit[SYNTHETIC_PIXELS];
};

/* What goes from tile to tile. */
struct synthetic_maker {
	const struct synthetic_options *options;
	const struct basis_light *light;
	const struct basis_coarse *gather; /* NULL: none */
	struct basis_writer *writer;
	struct basis_info_chunk info;
	uint16_t *coverage;
	float (*peak)[3];
	struct chance chance;
};

/* Stops the program when anything fails: the tests of the writer say why. */
static inline void synthetic_must(int ret, const struct fault *fault)
{
	if (ret < 0) {
		fprintf(stderr, "synthetic basis: %s (%d)\n", fault->text, ret);
		abort();
	}
}

static inline void synthetic_lights(struct basis_light *lights, int count, struct chance *chance)
{
	for (int i = 0; i < count; i++) {
		const double z = chance_real(chance, 0, 1),
			     phi = 2 * M_PI * chance_real(chance, 0, 1);
		const double r = sqrt(1 - z * z);

		lights[i] = (struct basis_light){
			.direction = {r * cos(phi), r * sin(phi), z},
			.solid_angle_sr = 2 * M_PI / count,
		};
	}
}

static inline void *synthetic_zeros(size_t count, size_t size)
{
	void *zeros = calloc(count ? count : 1, size);

	if (!zeros)
		abort();
	return zeros;
}

/* Random places and weights: three, two or one, ascending. */
static inline void synthetic_gather(struct basis_coarse *gather, int lights, int coarse,
				    struct chance *chance)
{
	for (int i = 0; i < lights; i++) {
		struct basis_coarse *g = &gather[i];
		const int places = chance_int(chance, 1, coarse < 3 ? coarse : 3);
		int left = BASIS_COARSE_ONE, from = 0;

		*g = (struct basis_coarse){{0}, {0}};
		for (int k = 0; k < places; k++) {
			const int more = places - 1 - k; /* which need a place and a weight too */
			const int weight = more ? chance_int(chance, 1, left - more) : left;

			from = chance_int(chance, from, coarse - 1 - more);
			g->index[k] = (uint16_t)from++;
			g->weight[k] = (uint16_t)weight;
			left -= weight;
		}
	}
}

/* ---- values ---- */

/* value[pixels][3][lights] += what a block says of each, in double precision, as basis_format.h
 * defines it: per unit of X_i. */
static inline void synthetic_add_values(const struct basis_block *b, int lights,
					const struct basis_coarse *gather, double *value)
{
	double *row = synthetic_zeros((size_t)b->stride + 1, sizeof(*row));

	for (int p = 0; p < b->pixels; p++) {
		for (int c = 0; c < 3; c++) {
			const int channel = b->channels == 3 ? c : 0;
			const double tint =
				b->tint ? b->tint[c * b->pixels + p] / (double)BASIS_TINT_ONE : 1;
			const size_t line = (size_t)(p / BASIS_LINE16 * b->channels + channel);
			const size_t line8 = (size_t)(p / BASIS_LINE8 * b->channels + channel);
			double *to = value + ((size_t)p * 3 + (size_t)c) * (size_t)lights;

			memset(row, 0, (size_t)b->stride * sizeof(*row));
			for (int j = 0; j < b->patterns; j++) {
				const size_t at = (line * (size_t)b->patterns + (size_t)j) *
							  BASIS_LINE16 +
						  (size_t)(p % BASIS_LINE16);
				const double f = (double)b->pattern_scale[j] * b->coefficient[at];

				for (int k = 0; k < b->stride; k++)
					row[k] += f * b->pattern[(size_t)j * (size_t)b->stride +
								 (size_t)k];
			}
			for (int i = 0; i < lights && b->patterns; i++)
				for (int k = 0; k < 3; k++)
					to[i] += !gather ? (k ? 0 : tint * row[i])
							 : tint * row[gather[i].index[k]] *
								   gather[i].weight[k] /
								   BASIS_COARSE_ONE;
			for (int n = 0; n < b->columns; n++) {
				const size_t columns = (size_t)b->columns;
				const int v = b->column16
						      ? b->column16[(line * columns + (size_t)n) *
									    BASIS_LINE16 +
								    (size_t)(p % BASIS_LINE16)]
						      : b->column8[(line8 * columns + (size_t)n) *
									   BASIS_LINE8 +
								   (size_t)(p % BASIS_LINE8)];

				to[b->light[n]] += tint * (double)b->column_scale[n] * v;
			}
		}
	}
	free(row);
}

/* ---- blocks ---- */

static inline struct synthetic_block synthetic_begin(const struct synthetic_maker *m, uint32_t tile,
						     const struct synthetic_group *group,
						     struct basis_block_entry shape)
{
	struct synthetic_block b = {.entry = shape};

	b.entry.tile = tile;
	b.entry.kind = (uint8_t)group->kind;
	b.entry.ground = (uint32_t)group->ground;
	b.entry.pixels = (uint16_t)group->pixels;
	b.at = basis_layout(&b.entry, (int)m->info.coarse);
	b.entry.bytes = b.at.bytes;
	b.payload = synthetic_zeros(1, b.at.bytes);
	memcpy(b.payload + b.at.pixel, group->pixel, (size_t)group->pixels * sizeof(uint16_t));
	return b;
}

/* As the reader would locate it. */
static inline struct basis_block synthetic_view(const struct synthetic_block *b)
{
	return (struct basis_block){
		.kind = b->entry.kind,
		.pixels = b->entry.pixels,
		.channels = b->entry.channels,
		.bits = b->entry.bits,
		.ground = (int)b->entry.ground,
		.patterns = b->entry.patterns,
		.columns = (int)b->entry.columns,
		.stride = b->at.stride,
		.pixel = (const uint16_t *)(b->payload + b->at.pixel),
		.tint = b->entry.tinted ? (const uint16_t *)(b->payload + b->at.tint) : NULL,
		.pattern_scale = (const float *)(b->payload + b->at.pattern_scale),
		.pattern = (const int16_t *)(b->payload + b->at.pattern),
		.coefficient = (const int16_t *)(b->payload + b->at.coefficient),
		.light = (const uint16_t *)(b->payload + b->at.light),
		.column_scale = (const float *)(b->payload + b->at.column_scale),
		.column16 = b->entry.bits == 16 ? (const int16_t *)(b->payload + b->at.column)
						: NULL,
		.column8 = b->entry.bits == 8 ? (const int8_t *)(b->payload + b->at.column) : NULL,
		.bytes = b->at.bytes,
	};
}

/* Patterns, columns, bits, channels and tint of a block to be. */
static inline struct basis_block_entry synthetic_shape(struct synthetic_maker *m)
{
	const struct synthetic_options *o = m->options;
	int patterns = o->patterns, columns = o->columns < 0 ? o->lights : o->columns;
	bool grey = o->grey, tinted = o->tinted, bytes = o->bits == 8;

	if (o->vary) {
		patterns = chance_int(&m->chance, 0, patterns);
		columns = chance_int(&m->chance, 0, columns);
		grey = chance_int(&m->chance, 0, 1);
		tinted = chance_int(&m->chance, 0, 1);
		bytes = chance_int(&m->chance, 0, 1);
	}
	if (!patterns && !columns)
		columns = o->vary ? 1 : o->lights;
	return (struct basis_block_entry){
		.channels = grey ? 1 : 3,
		.bits = bytes && columns ? 8 : 16,
		.tinted = grey && tinted,
		.patterns = (uint16_t)patterns,
		.columns = (uint32_t)columns,
	};
}

/*
 * Values of 0..most, few of them near 0, times each pixel's factor. Where there are patterns the
 * first is positive and the greater part; what is on top of it, other patterns and columns, has
 * any sign.
 */
static inline void synthetic_fill_patterns(struct synthetic_block *b, int coarse, double most,
					   struct chance *chance)
{
	float *scale = (float *)(b->payload + b->at.pattern_scale);
	int16_t *pattern = (int16_t *)(b->payload + b->at.pattern);
	int16_t *coefficient = (int16_t *)(b->payload + b->at.coefficient);
	const size_t lines = (size_t)b->at.panels16 * b->entry.channels * b->entry.patterns;

	for (int j = 0; j < b->entry.patterns; j++) {
		const double share = j ? 0.08 / (b->entry.patterns - 1) : 0.84;

		scale[j] = (float)(most * share / (32767.0 * 32767.0));
		for (int k = 0; k < coarse; k++)
			pattern[j * b->at.stride + k] =
				(int16_t)(j ? chance_int(chance, -32767, 32767)
					    : chance_int(chance, 16000, 32767));
	}
	for (size_t i = 0; i < lines * BASIS_LINE16; i++)
		coefficient[i] = (int16_t)(i / BASIS_LINE16 % b->entry.patterns
						   ? chance_int(chance, -32767, 32767)
						   : chance_int(chance, 16000, 32767));
}

static inline void synthetic_fill_columns(struct synthetic_block *b, int lights, double most,
					  struct chance *chance)
{
	const int columns = (int)b->entry.columns, top = b->entry.bits == 8 ? 127 : 32767;
	const int least = b->entry.patterns ? -top : 0;
	uint16_t *light = (uint16_t *)(b->payload + b->at.light);
	float *scale = (float *)(b->payload + b->at.column_scale);
	const size_t values = (size_t)b->at.column_panels * b->entry.channels * (size_t)columns *
			      (size_t)(BASIS_ALIGN * 8 / b->entry.bits);

	for (int i = 0, n = 0; i < lights && n < columns; i++)
		if (chance_int(chance, 1, lights - i) <= columns - n)
			light[n++] = (uint16_t)i;
	for (int n = 0; n < columns; n++)
		scale[n] = (float)(most * (b->entry.patterns ? 0.08 : 1) *
				   chance_real(chance, 0.25, 1) / top);
	for (size_t i = 0; i < values; i++) {
		if (b->entry.bits == 8)
			((int8_t *)(b->payload + b->at.column))[i] = (int8_t)chance_int(chance,
											least, top);
		else
			((int16_t *)(b->payload + b->at.column))[i] =
				(int16_t)chance_int(chance, least, top);
	}
}

/* Each place of each line times its pixel's factor, in -1..1; 0 where there is no pixel. */
static inline void synthetic_scale_pixels(struct synthetic_block *b, const double *factor)
{
	int16_t *coefficient = (int16_t *)(b->payload + b->at.coefficient);
	uint8_t *column = b->payload + b->at.column;
	const size_t patterns = (size_t)b->entry.channels * b->entry.patterns;
	const size_t columns = (size_t)b->entry.channels * b->entry.columns;
	const size_t line = b->entry.bits == 8 ? BASIS_LINE8 : BASIS_LINE16;
	const size_t values = (size_t)b->at.column_panels * columns * line;

	for (size_t i = 0; i < (size_t)b->at.panels16 * patterns * BASIS_LINE16; i++) {
		const size_t p = i / (patterns * BASIS_LINE16) * BASIS_LINE16 + i % BASIS_LINE16;

		coefficient[i] = (int16_t)(p < b->entry.pixels ? lrint(coefficient[i] * factor[p])
							       : 0);
	}
	for (size_t i = 0; i < values; i++) {
		const size_t p = i / (columns * line) * line + i % line;
		const double f = p < b->entry.pixels ? factor[p] : 0;

		if (b->entry.bits == 8)
			((int8_t *)column)[i] = (int8_t)lrint(((int8_t *)column)[i] * f);
		else
			((int16_t *)column)[i] = (int16_t)lrint(((int16_t *)column)[i] * f);
	}
}

/* A random block of values 0..most, before any factors. */
static inline struct synthetic_block synthetic_make(struct synthetic_maker *m, uint32_t tile,
						    const struct synthetic_group *group,
						    double most)
{
	const struct basis_block_entry shape = synthetic_shape(m);
	struct synthetic_block b = synthetic_begin(m, tile, group, shape);
	uint16_t *tint = (uint16_t *)(b.payload + b.at.tint);

	for (int i = 0; i < 3 * group->pixels && b.entry.tinted; i++)
		tint[i] = (uint16_t)chance_int(&m->chance, 0, UINT16_MAX);
	if (b.entry.tinted)
		most *= BASIS_TINT_ONE / (double)UINT16_MAX;
	synthetic_fill_patterns(&b, (int)m->info.coarse, most, &m->chance);
	synthetic_fill_columns(&b, m->options->lights, most, &m->chance);
	return b;
}

/* The blocks of a group over each other: random ones or, where `of` is not NULL, changes of that.
 */
static inline int synthetic_layers(struct synthetic_maker *m, uint32_t tile,
				   const struct synthetic_group *group,
				   const struct synthetic_block *of, struct synthetic_block *blocks)
{
	const struct synthetic_options *o = m->options;
	const int most_layers = o->layers < 1			   ? 1
				: o->layers > SYNTHETIC_LAYERS_MAX ? SYNTHETIC_LAYERS_MAX
								   : o->layers;
	const int layers = o->vary ? chance_int(&m->chance, 1, most_layers) : most_layers;
	const double reach = fmax(1, o->bounce); /* of factors */
	double factor[SYNTHETIC_PIXELS];

	for (int n = 0; n < layers; n++) {
		struct synthetic_block *b = &blocks[n];

		if (of) {
			float *scale;

			*b = synthetic_begin(m, tile, group, of->entry);
			memcpy(b->payload, of->payload, of->at.bytes);
			scale = (float *)(b->payload + b->at.pattern_scale);
			for (int j = 0; j < b->entry.patterns; j++)
				scale[j] *= (float)(reach / layers);
			scale = (float *)(b->payload + b->at.column_scale);
			for (uint32_t j = 0; j < b->entry.columns; j++)
				scale[j] *= (float)(reach / layers);
		} else {
			*b = synthetic_make(
				m, tile, group,
				(group->kind == BASIS_KIND_T ? o->peak / (2 * M_PI) : reach) /
					layers);
		}
		for (int p = 0; p < group->pixels; p++)
			factor[p] = group->kind == BASIS_KIND_T ? 1 : group->factor[p] / reach;
		synthetic_scale_pixels(b, factor);
	}
	return layers;
}

/* All that blocks of a group say together, as 16-bit columns of all lights. *error: the most that
 * they differ. */
static inline struct synthetic_block synthetic_exact(const struct synthetic_maker *m, uint32_t tile,
						     const struct synthetic_group *group,
						     const double *value, double *error)
{
	const int n = m->options->lights;
	struct synthetic_block b = synthetic_begin(
		m, tile, group,
		(struct basis_block_entry){.channels = 3, .bits = 16, .columns = (uint32_t)n});
	uint16_t *light = (uint16_t *)(b.payload + b.at.light);
	float *scale = (float *)(b.payload + b.at.column_scale);
	int16_t *column = (int16_t *)(b.payload + b.at.column);

	for (int i = 0; i < n; i++) {
		double most = 0;

		for (int k = 0; k < group->pixels * 3; k++)
			most = fmax(most, fabs(value[(size_t)k * (size_t)n + (size_t)i]));
		light[i] = (uint16_t)i;
		scale[i] = (float)(most * (1 + 1e-6) / 32767);
		for (int k = 0; k < group->pixels * 3; k++) {
			const double v = value[(size_t)k * (size_t)n + (size_t)i];
			const double step = (double)scale[i];
			const int q = step > 0 ? (int)lrint(v / step) : 0;
			const size_t line = (size_t)(k / 3 / BASIS_LINE16 * 3 + k % 3) * (size_t)n +
					    (size_t)i;

			column[line * BASIS_LINE16 + (size_t)(k / 3 % BASIS_LINE16)] = (int16_t)q;
			*error = fmax(*error, fabs(q * step - v));
		}
	}
	return b;
}

/* ---- tiles ---- */

static inline void synthetic_add_pixel(struct synthetic_group *g, int pixel, double factor,
				       bool unlit)
{
	g->factor[g->pixels] = factor;
	g->unlit[g->pixels] = unlit;
	g->pixel[g->pixels++] = (uint16_t)pixel;
}

/* Groups in the order of kinds: T, V and V of another ground, D, U. */
enum { SYNTHETIC_T, SYNTHETIC_V, SYNTHETIC_V2, SYNTHETIC_D, SYNTHETIC_U, SYNTHETIC_GROUPS };

static inline void synthetic_choose_pixels(struct synthetic_maker *m, int x0, int y0,
					   struct synthetic_group *groups)
{
	static const enum basis_kind kinds[SYNTHETIC_GROUPS] = {
		BASIS_KIND_T, BASIS_KIND_V, BASIS_KIND_V, BASIS_KIND_D, BASIS_KIND_U};
	const struct synthetic_options *o = m->options;
	const int ground = o->grounds ? chance_int(&m->chance, 0, o->grounds - 1) : 0;

	for (int g = 0; g < SYNTHETIC_GROUPS; g++) {
		groups[g].kind = kinds[g];
		groups[g].pixels = 0;
		groups[g].ground = kinds[g] != BASIS_KIND_V ? 0
				   : g == SYNTHETIC_V
					   ? ground
					   : (ground + 1) % (o->grounds ? o->grounds : 1);
	}
	for (int p = 0; p < SYNTHETIC_PIXELS; p++) {
		const int x = x0 + p % BASIS_TILE, y = y0 + p / BASIS_TILE;
		const double r = chance_real(&m->chance, 0, 1);
		const double factor = chance_real(&m->chance, -o->bounce, 1);
		const bool unlit = chance_real(&m->chance, 0, 1) < o->unlit_share;

		if (x >= o->width || y >= o->height)
			continue;
		if (chance_real(&m->chance, 0, 1) < o->object_share) {
			const double a = chance_real(&m->chance, 0, 1);

			m->coverage[y * o->width + x] = (uint16_t)(a < 0.3   ? 65535
								   : a < 0.4 ? 0
									     : a * 65535);
			synthetic_add_pixel(&groups[SYNTHETIC_T], p, 1, false);
		}
		if (r < o->ground_share) {
			const int g = chance_int(&m->chance, SYNTHETIC_V, SYNTHETIC_V2);

			synthetic_add_pixel(&groups[o->grounds > 1 ? g : SYNTHETIC_V], p, factor,
					    false);
		} else if (r < o->ground_share + o->stand_in_share) {
			synthetic_add_pixel(&groups[SYNTHETIC_D], p, factor, unlit);
			synthetic_add_pixel(&groups[SYNTHETIC_U], p, 1, unlit);
		}
	}
}

static inline void synthetic_raise_peaks(const struct synthetic_maker *m, const double *value,
					 int pixels)
{
	const size_t n = (size_t)m->options->lights;

	for (int k = 0; k < pixels * 3; k++) {
		const double *t = value + (size_t)k * n;
		const int c = k % 3;
		double sum = 0;

		for (size_t i = 0; i < n; i++) {
			const double one = t[i] * m->light[i].solid_angle_sr * (1 + 1e-6);

			m->peak[i][c] = fmaxf(m->peak[i][c], (float)one);
			sum += one;
		}
		m->peak[n][c] = fmaxf(m->peak[n][c], (float)sum);
	}
}

/* Writes the blocks of a group, of both layers, and frees them. */
static inline void synthetic_write_group(struct synthetic_maker *m, uint32_t tile,
					 const struct synthetic_group *group,
					 struct synthetic_block *blocks, int count)
{
	const struct synthetic_options *o = m->options;
	const bool values = o->exact || group->kind == BASIS_KIND_T;
	double *value = synthetic_zeros(values ? (size_t)group->pixels * 3 * (size_t)o->lights : 1,
					sizeof(*value));
	struct fault fault = {""};

	for (int n = 0; n < count; n++) {
		const struct basis_block_payload payload = {blocks[n].entry, blocks[n].payload};
		const struct basis_block view = synthetic_view(&blocks[n]);

		if (values)
			synthetic_add_values(&view, o->lights, m->gather, value);
		synthetic_must(basis_writer_blocks(m->writer, &payload, 1, &fault), &fault);
		free(blocks[n].payload);
	}
	if (group->kind == BASIS_KIND_T)
		synthetic_raise_peaks(m, value, group->pixels);
	if (o->exact) {
		double unused = 0;
		double *error = group->kind == BASIS_KIND_T   ? &m->info.object_error
				: group->kind == BASIS_KIND_V ? &m->info.ratio_error
							      : &unused;
		struct synthetic_block b = synthetic_exact(m, tile, group, value, error);
		const struct basis_block_payload payload = {b.entry, b.payload};

		synthetic_must(basis_writer_exact_blocks(m->writer, &payload, 1, &fault), &fault);
		free(b.payload);
	}
	free(value);
}

static inline void synthetic_write_tile(struct synthetic_maker *m, uint32_t tile, int x0, int y0)
{
	struct synthetic_group *groups = synthetic_zeros(SYNTHETIC_GROUPS, sizeof(*groups));
	struct synthetic_block blocks[SYNTHETIC_LAYERS_MAX], lit = {.payload = NULL};
	double factor[SYNTHETIC_PIXELS];

	synthetic_choose_pixels(m, x0, y0, groups);
	for (int g = SYNTHETIC_T; g <= SYNTHETIC_V2; g++)
		if (groups[g].pixels)
			synthetic_write_group(m, tile, &groups[g], blocks,
					      synthetic_layers(m, tile, &groups[g], NULL, blocks));
	if (groups[SYNTHETIC_U].pixels) { /* D is a change of U, and so made after it */
		lit = synthetic_make(m, tile, &groups[SYNTHETIC_U], 1 / (2 * M_PI));
		synthetic_write_group(
			m, tile, &groups[SYNTHETIC_D], blocks,
			synthetic_layers(m, tile, &groups[SYNTHETIC_D], &lit, blocks));
		for (int p = 0; p < groups[SYNTHETIC_U].pixels; p++)
			factor[p] = groups[SYNTHETIC_U].unlit[p] ? 0 : 1;
		synthetic_scale_pixels(&lit, factor);
		synthetic_write_group(m, tile, &groups[SYNTHETIC_U], &lit, 1);
	}
	free(groups);
}

/* Overwrites s->path. */
static inline void synthetic_write(struct synthetic *s, const struct synthetic_options *o)
{
	const int coarse = o->coarse ? o->coarse : o->lights;
	const size_t n = (size_t)o->lights, terms = (size_t)o->grounds * 3 * n;
	struct basis_light *light = synthetic_zeros(n, sizeof(*light));
	struct basis_coarse *gather = synthetic_zeros(n, sizeof(*gather));
	double *ground = synthetic_zeros(terms, sizeof(*ground));
	struct synthetic_maker m = {
		.options = o,
		.light = light,
		.gather = coarse < o->lights ? gather : NULL,
		.info = {.width = (uint32_t)o->width,
			 .height = (uint32_t)o->height,
			 .lights = (uint32_t)o->lights,
			 .grounds = (uint32_t)o->grounds,
			 .poses = 1,
			 .coarse = (uint32_t)coarse,
			 .column_cut = o->column_cut},
		.coverage = synthetic_zeros((size_t)o->width * (size_t)o->height, sizeof(uint16_t)),
		.peak = synthetic_zeros(n + 1, sizeof(*m.peak)),
		.chance = {o->seed},
	};
	struct fault fault = {""};
	uint32_t tile = 0;

	synthetic_lights(light, o->lights, &m.chance);
	synthetic_gather(gather, o->lights, coarse, &m.chance);
	for (size_t i = 0; i < terms; i++)
		ground[i] = chance_real(&m.chance, 0, 1) / o->lights;
	synthetic_must(basis_writer_open(&m.writer, s->path, &m.info, light, ground, m.gather,
					 "[camera]\n", &fault),
		       &fault);
	for (int y = 0; y < o->height; y += BASIS_TILE)
		for (int x = 0; x < o->width; x += BASIS_TILE)
			synthetic_write_tile(&m, tile++, x, y);
	synthetic_must(
		basis_writer_pose_end(m.writer, m.coverage, (const float(*)[3])m.peak, &fault),
		&fault);
	synthetic_must(basis_writer_finish(m.writer, &m.info, "made = by a test\n", &fault),
		       &fault);
	free(light);
	free(gather);
	free(ground);
	free(m.coverage);
	free(m.peak);
}

/* Makes all checksums of a file in memory right again after something in it was changed, as far as
 * its chunk table can be followed. */
static inline void synthetic_reseal(uint8_t *data, size_t bytes)
{
	struct basis_file_header *header = (struct basis_file_header *)data;
	struct basis_chunk_entry *chunk = (struct basis_chunk_entry *)(header + 1);
	XXH3_state_t *hash;

	if (bytes < sizeof(*header) ||
	    header->chunk_count > (bytes - sizeof(*header)) / sizeof(*chunk))
		return;
	for (uint32_t i = 0; i < header->chunk_count; i++) {
		if (chunk[i].offset <= bytes && chunk[i].bytes <= bytes - chunk[i].offset)
			chunk[i].checksum = XXH3_64bits(data + chunk[i].offset, chunk[i].bytes);
	}
	hash = XXH3_createState();
	if (!hash)
		abort();
	header->checksum = 0;
	XXH3_64bits_reset(hash);
	XXH3_64bits_update(hash, header, sizeof(*header));
	XXH3_64bits_update(hash, chunk, header->chunk_count * sizeof(*chunk));
	header->checksum = XXH3_64bits_digest(hash);
	XXH3_freeState(hash);
}

static inline void synthetic_open(struct synthetic *s, const struct synthetic_options *options)
{
	struct fault fault = {""};

	memset(s, 0, sizeof(*s));
	snprintf(s->folder, sizeof(s->folder), "/tmp/inlay-basis-XXXXXX");
	if (!mkdtemp(s->folder))
		abort();
	snprintf(s->path, sizeof(s->path), "%s/b.inlay", s->folder);
	synthetic_write(s, options);
	synthetic_must(basis_open(&s->basis, s->path, BASIS_ALL, &fault), &fault);
}

static inline void synthetic_close(struct synthetic *s)
{
	basis_close(&s->basis);
	unlink(s->path);
	rmdir(s->folder);
}

#endif
