/* SPDX-License-Identifier: MIT */
#include "tests/support/basis/synthetic_block.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_lines.h"

void *synthetic_zeros(size_t count, size_t size)
{
	void *zeros = calloc(count ? count : 1, size);

	if (!zeros)
		abort();
	return zeros;
}

/* ---- values ---- */

void synthetic_add_values(const struct basis_block *b, int lights,
			  const struct basis_coarse *gather, double *value)
{
	double *row = synthetic_zeros((size_t)b->stride + 1, sizeof(*row));
	const int panels = basis_panels16(b->pixels);

	for (int p = 0; p < b->pixels; p++) {
		for (int c = 0; c < 3; c++) {
			const int channel = b->channels == 3 ? c : 0;
			const double tint =
				b->tint ? b->tint[c * b->pixels + p] / (double)BASIS_TINT_ONE : 1;
			const size_t line = (size_t)(channel * panels + p / BASIS_LINE16);
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
			for (int n = 0; n < b->columns && b->light[n] < lights; n++) {
				const size_t columns = (size_t)b->columns;
				const int v = b->column16
						      ? b->column16[(line * columns + (size_t)n) *
									    BASIS_LINE16 +
								    (size_t)(p % BASIS_LINE16)]
						      : basis_column8_value(b, n, channel, p);

				to[b->light[n]] += tint * (double)b->column_scale[n] * v;
			}
		}
	}
	free(row);
}

/* ---- blocks ---- */

static struct synthetic_block synthetic_begin(const struct synthetic_maker *m, uint32_t tile,
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

struct basis_block synthetic_view(const struct synthetic_block *b)
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
		.cut_share = b->entry.cut_share,
		.column16 = b->entry.bits == 16 ? (const int16_t *)(b->payload + b->at.column)
						: NULL,
		.record_at = b->entry.bits == 8 ? (const uint32_t *)(b->payload + b->at.column)
						: NULL,
		.record = b->entry.bits == 8 ? b->payload + b->at.record : NULL,
		.bytes = b->at.bytes,
	};
}

/* Patterns, columns, bits, channels, tint and share of the cut of the next block. */
static struct basis_block_entry synthetic_shape(struct synthetic_maker *m)
{
	static const float shares[] = {1, 0.5F, 0.125F, 0.7F, 1.0F / 4096};
	const struct synthetic_options *o = m->options;
	int patterns = o->patterns, columns = o->columns < 0 ? o->lights : o->columns;
	bool grey = o->grey, tinted = o->tinted, bytes = o->bits == 8;
	float share = shares[m->shapes++ % (int)(sizeof(shares) / sizeof(*shares))];

	if (o->cut_share > 0)
		share = (float)o->cut_share;
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
		.cut_share = share,
	};
}

/*
 * Values of 0..most, few of them near 0, times each pixel's factor. Where there are patterns the
 * first is positive and the greater part; what is on top of it, other patterns and columns, has
 * any sign.
 */
static void synthetic_fill_patterns(struct synthetic_block *b, int coarse, double most,
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

/* Codes for the lines of columns of 8 bits: [columns][lines]. Only where there are patterns may a
 * line be nothing. */
static uint8_t *synthetic_codes(struct basis_block_entry *shape, struct chance *chance)
{
	const int lines = basis_record_lines(shape->pixels, shape->channels);
	uint8_t *code = synthetic_zeros((size_t)lines * shape->columns, 1);

	for (uint32_t n = 0; n < shape->columns && shape->bits == 8; n++) {
		for (int k = 0; k < lines; k++) {
			const int draw = chance_int(chance, shape->patterns ? 0 : 1, 4);

			code[n * (uint32_t)lines + (uint32_t)k] =
				draw == 0  ? 0
				: draw < 3 ? (uint8_t)chance_int(chance, 1, BASIS_LINE_FACTOR_MAX)
					   : BASIS_LINE_WHOLE;
		}
		shape->record_bytes += (uint32_t)basis_record_bytes(code + n * (uint32_t)lines,
								    lines);
	}
	return code;
}

static void synthetic_place_codes(struct synthetic_block *b, const uint8_t *code)
{
	const int lines = b->at.panels8 * b->entry.channels;
	uint32_t *place = (uint32_t *)(b->payload + b->at.column), end = 0;

	for (uint32_t n = 0; n < b->entry.columns && b->entry.bits == 8; n++) {
		place[n] = end;
		memcpy(b->payload + b->at.record + end, code + n * (uint32_t)lines, (size_t)lines);
		end += (uint32_t)basis_record_bytes(code + n * (uint32_t)lines, lines);
	}
}

/* Each line of a block's columns of 8 bits: new values of least..127, or, where factor is not NULL,
 * those that are there times their pixels' factors. */
static void synthetic_change_lines(struct synthetic_block *b, int least, struct chance *chance,
				   const double *factor)
{
	const int lines = b->at.panels8 * b->entry.channels;
	const uint32_t *place = (const uint32_t *)(b->payload + b->at.column);

	for (uint32_t n = 0; n < b->entry.columns; n++) {
		const uint8_t *code = b->payload + b->at.record + place[n];
		uint8_t *line = b->payload + b->at.record + place[n] + basis_record_head(lines);

		for (int k = 0; k < lines; line += basis_line_bytes(code[k++])) {
			const int first = k / b->entry.channels * BASIS_LINE8;
			const int unit = code[k] == BASIS_LINE_WHOLE ? 1 : code[k];
			const int top = code[k] == BASIS_LINE_WHOLE ? 127 : 7;
			int8_t value[BASIS_LINE8];

			basis_line_unpack(code[k], line, value);
			for (int p = 0; p < BASIS_LINE8 && unit; p++) {
				const bool there = first + p < b->entry.pixels;

				if (!factor)
					value[p] =
						(int8_t)(unit *
							 chance_int(chance, least ? -top : 0, top));
				else
					value[p] = (int8_t)(there ? unit * lrint(value[p] *
										 factor[first + p] /
										 unit)
								  : 0);
			}
			basis_line_pack(code[k], value, line);
		}
	}
}

static void synthetic_fill_columns(struct synthetic_block *b, int lights, int groups, double most,
				   struct chance *chance)
{
	const int columns = (int)b->entry.columns, top = b->entry.bits == 8 ? 127 : 32767;
	const int least = b->entry.patterns ? -top : 0;
	uint16_t *light = (uint16_t *)(b->payload + b->at.light);
	float *scale = (float *)(b->payload + b->at.column_scale);
	const size_t values = (size_t)b->at.panels16 * b->entry.channels * (size_t)columns *
			      BASIS_LINE16;

	for (int i = 0, n = 0; i < lights && n < columns; i++)
		if (chance_int(chance, 1, lights - i) <= columns - n)
			light[n++] = (uint16_t)i;
	for (int k = 0; k < groups && k < columns; k++)
		light[columns - 1 - k] = (uint16_t)(lights + groups - 1 - k);
	for (int n = 0; n < columns; n++)
		scale[n] = (float)(most * (b->entry.patterns ? 0.08 : 1) *
				   chance_real(chance, 0.25, 1) / top);
	if (b->entry.bits == 8)
		synthetic_change_lines(b, least, chance, NULL);
	for (size_t i = 0; i < values && b->entry.bits == 16; i++)
		((int16_t *)(b->payload + b->at.column))[i] = (int16_t)chance_int(chance, least,
										  top);
}

void synthetic_scale_pixels(struct synthetic_block *b, const double *factor)
{
	int16_t *coefficient = (int16_t *)(b->payload + b->at.coefficient);
	int16_t *column = (int16_t *)(b->payload + b->at.column);
	const size_t panels = (size_t)b->at.panels16, each = panels * b->entry.channels;
	const size_t patterns = b->entry.patterns, columns = b->entry.columns;

	for (size_t i = 0; i < each * patterns * BASIS_LINE16; i++) {
		const size_t p = i / (patterns * BASIS_LINE16) % panels * BASIS_LINE16 +
				 i % BASIS_LINE16;

		coefficient[i] = (int16_t)(p < b->entry.pixels ? lrint(coefficient[i] * factor[p])
							       : 0);
	}
	if (b->entry.bits == 8) {
		synthetic_change_lines(b, 0, NULL, factor);
		return;
	}
	for (size_t i = 0; i < each * columns * BASIS_LINE16; i++) {
		const size_t p = i / (columns * BASIS_LINE16) % panels * BASIS_LINE16 +
				 i % BASIS_LINE16;

		column[i] = (int16_t)(p < b->entry.pixels ? lrint(column[i] * factor[p]) : 0);
	}
}

struct synthetic_block synthetic_make(struct synthetic_maker *m, uint32_t tile,
				      const struct synthetic_group *group, double most)
{
	struct basis_block_entry shape = synthetic_shape(m);
	struct synthetic_block b;
	uint16_t *tint;
	uint8_t *code;

	shape.pixels = (uint16_t)group->pixels;
	code = synthetic_codes(&shape, &m->chance);
	b = synthetic_begin(m, tile, group, shape);
	synthetic_place_codes(&b, code);
	free(code);
	tint = (uint16_t *)(b.payload + b.at.tint);
	for (int i = 0; i < 3 * group->pixels && b.entry.tinted; i++)
		tint[i] = (uint16_t)chance_int(&m->chance, 0, UINT16_MAX);
	if (b.entry.tinted)
		most *= BASIS_TINT_ONE / (double)UINT16_MAX;
	synthetic_fill_patterns(&b, (int)m->info.coarse, most, &m->chance);
	synthetic_fill_columns(
		&b, m->options->lights,
		group->kind == BASIS_KIND_T || group->kind == BASIS_KIND_V ? m->options->groups : 0,
		most, &m->chance);
	return b;
}

int synthetic_layers(struct synthetic_maker *m, uint32_t tile, const struct synthetic_group *group,
		     const struct synthetic_block *of, struct synthetic_block *blocks)
{
	const struct synthetic_options *o = m->options;
	const int most_layers = o->layers < 1			   ? 1
				: o->layers > SYNTHETIC_LAYERS_MAX ? SYNTHETIC_LAYERS_MAX
								   : o->layers;
	const int layers = o->vary ? chance_int(&m->chance, 1, most_layers) : most_layers;
	const double reach = fmax(1, o->bounce); /* largest factor */
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

struct synthetic_block synthetic_exact(const struct synthetic_maker *m, uint32_t tile,
				       const struct synthetic_group *group, const double *value,
				       double *error)
{
	const int n = m->options->lights;
	struct synthetic_block b = synthetic_begin(
		m, tile, group,
		(struct basis_block_entry){
			.channels = 3, .bits = 16, .columns = (uint32_t)n, .cut_share = 1});
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
			const int p = k / 3, panel = p / BASIS_LINE16;
			const size_t line = (size_t)(k % 3 * b.at.panels16 + panel) * (size_t)n +
					    (size_t)i;

			column[line * BASIS_LINE16 + (size_t)(p % BASIS_LINE16)] = (int16_t)q;
			*error = fmax(*error, fabs(q * step - v));
		}
	}
	return b;
}
