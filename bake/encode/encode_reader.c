/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_reader.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "bake/encode/encode_rank.h"
#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"

void block_reader_free(struct block_reader *reader)
{
	free(reader->at_light);
	free(reader->coefficient);
	free(reader->grouped);
	*reader = (struct block_reader){.count = 0};
}

static int reader_reserve(struct block_reader *reader, int patterns)
{
	if (patterns <= reader->patterns_room)
		return 0;
	free(reader->at_light);
	free(reader->coefficient);
	reader->patterns_room = 0;
	reader->at_light = calloc((size_t)patterns * (size_t)reader->settings->lights,
				  sizeof(*reader->at_light));
	reader->coefficient = calloc((size_t)patterns * PART_ROWS, sizeof(*reader->coefficient));
	if (!reader->at_light || !reader->coefficient)
		return -ENOMEM;
	reader->patterns_room = patterns;
	return 0;
}

static bool *grouped_of(const struct block_reader *reader, const struct basis_block_payload *block)
{
	return reader->grouped +
	       (block->entry.channels == 3 ? (size_t)reader->settings->groups->count : 0);
}

static void read_groups(struct block_reader *reader, const struct basis_block_payload *block)
{
	const int lights = reader->settings->lights;
	const struct basis_layout at = basis_layout(&block->entry, reader->settings->coarse);
	const uint16_t *number = (const uint16_t *)((const uint8_t *)block->payload + at.light);

	for (uint32_t n = block->entry.columns; n && number[n - 1] >= lights; n--)
		grouped_of(reader, block)[number[n - 1] - lights] = true;
}

static void read_patterns(struct block_reader *reader, const struct basis_block_payload *block,
			  int first)
{
	const struct basis_block_entry *e = &block->entry;
	const struct encode_settings *settings = reader->settings;
	const struct basis_layout at = basis_layout(e, settings->coarse);
	const uint8_t *payload = block->payload;
	const void *scales = payload + at.pattern_scale;
	const float *scale = scales;
	const int16_t *coefficient = (const int16_t *)(payload + at.coefficient);

	for (int j = 0; j < e->patterns; j++) {
		const int16_t *pattern = (const int16_t *)(payload + at.pattern) +
					 (size_t)j * (size_t)at.stride;
		double *to = reader->at_light + (size_t)(first + j) * (size_t)settings->lights;

		for (int i = 0; i < settings->lights; i++) {
			to[i] = settings->gather ? 0 : pattern[i];
			for (int a = 0; settings->gather && a < 3; a++)
				to[i] += pattern[settings->gather[i].index[a]] *
					 ((double)settings->gather[i].weight[a] / BASIS_COARSE_ONE);
		}
		to = reader->coefficient + (size_t)(first + j) * PART_ROWS;
		for (int c = 0; c < e->channels; c++)
			for (int p = 0; p < e->pixels; p++) {
				const size_t line = basis_line16(at.panels16, e->patterns, c,
								 p / BASIS_LINE16, j);

				to[c * PART_PIXELS + p] = (double)scale[j] *
							  coefficient[line * BASIS_LINE16 +
								      (size_t)(p % BASIS_LINE16)];
			}
	}
}

int block_reader_open(struct block_reader *reader, const struct encode_settings *settings,
		      const struct part *part, const struct basis_block_payload *block, int count)
{
	int patterns = 0, err;

	reader->settings = settings;
	reader->part = part;
	reader->block = block;
	reader->count = count;
	for (int k = 0; k < count; k++)
		patterns += block[k].entry.patterns;
	err = reader_reserve(reader, patterns);
	free(reader->grouped);
	reader->grouped = calloc(2 * (size_t)settings->groups->count + 1, sizeof(*reader->grouped));
	if (err || !reader->grouped)
		return -ENOMEM;
	patterns = 0;
	for (int k = 0; k < count; k++) {
		read_patterns(reader, &block[k], patterns);
		read_groups(reader, &block[k]);
		patterns += block[k].entry.patterns;
	}
	return 0;
}

/* A column's values: [channels][pixels, to the end of a line]. */
static void read_column(const struct basis_block_payload *block, const struct basis_layout *at,
			int number, int16_t (*value)[PART_PIXELS])
{
	const struct basis_block_entry *e = &block->entry;
	const uint8_t *payload = block->payload;
	const void *columns = payload + at->column;
	const int16_t *column16 = columns;
	const uint32_t *record_at = columns;
	const uint8_t *code, *from;
	const int lines = at->panels8 * e->channels;

	if (e->bits == 16) {
		for (int c = 0; c < e->channels; c++)
			for (int p = 0; p < e->pixels; p++) {
				const size_t line = basis_line16(at->panels16, (int)e->columns, c,
								 p / BASIS_LINE16, number);

				value[c][p] =
					column16[line * BASIS_LINE16 + (size_t)(p % BASIS_LINE16)];
			}
		return;
	}
	code = payload + at->record + record_at[number];
	from = code + basis_record_head(lines);
	for (int k = 0; k < lines; from += basis_line_bytes(code[k++])) {
		int8_t line[BASIS_LINE8];

		basis_line_unpack(code[k], from, line);
		for (int p = 0; p < BASIS_LINE8; p++)
			value[k % e->channels][k / e->channels * BASIS_LINE8 + p] = line[p];
	}
}

/* own [channels][PART_PIXELS] += factor * column. */
static void add_column(const struct basis_block_payload *block, const struct basis_layout *at,
		       int number, const double factor[3], double (*own)[PART_PIXELS])
{
	const struct basis_block_entry *e = &block->entry;
	const uint8_t *payload = block->payload;
	const void *scales = payload + at->column_scale;
	const double scale = (double)((const float *)scales)[number];
	int16_t value[3][PART_PIXELS];

	read_column(block, at, number, value);
	for (int c = 0; c < 3; c++)
		for (int p = 0; factor[c] != 0 && p < e->pixels; p++)
			own[c][p] += factor[c] * scale * value[e->channels == 3 ? c : 0][p];
}

/* To the part's pixels, tinted. */
static void reader_add_block(const struct part *part, const struct basis_block_payload *block,
			     const struct basis_layout *at, const double (*own)[PART_PIXELS],
			     double (*value)[PART_PIXELS])
{
	const struct basis_block_entry *e = &block->entry;
	const uint8_t *payload = block->payload;
	const uint16_t *pixel = (const uint16_t *)(payload + at->pixel);
	const uint16_t *tint = (const uint16_t *)(payload + at->tint);
	int place = 0;

	for (int p = 0; p < part->pixels && place < e->pixels; p++) {
		if (part->pixel[p] != pixel[place])
			continue;
		for (int c = 0; c < 3; c++)
			value[c][p] +=
				own[c][place] *
				(e->tinted ? (double)tint[c * e->pixels + place] / BASIS_TINT_ONE
					   : 1);
		place++;
	}
}

/* y: [3] of pattern number j. */
static void add_patterns(const struct block_reader *reader, const struct basis_block_entry *e,
			 int first, const double (*y)[3], double (*own)[PART_PIXELS])
{
	for (int j = 0; j < e->patterns; j++)
		for (int c = 0; c < 3; c++) {
			const double *row = reader->coefficient + (size_t)(first + j) * PART_ROWS +
					    (e->channels == 3 ? c * PART_PIXELS : 0);

			for (int p = 0; p < e->pixels; p++)
				own[c][p] += y[j][c] * row[p];
		}
}

static int reader_find(const struct basis_block_payload *block, const struct basis_layout *at,
		       int light)
{
	const uint16_t *lights = (const uint16_t *)((const uint8_t *)block->payload + at->light);
	int low = 0, high = (int)block->entry.columns;

	while (low < high) {
		const int middle = (low + high) / 2;

		if (lights[middle] < light)
			low = middle + 1;
		else
			high = middle;
	}
	return low < (int)block->entry.columns && lights[low] == light ? low : -1;
}

void block_reader_light(const struct block_reader *reader, int light, double (*value)[PART_PIXELS])
{
	static const double one[3] = {1, 1, 1};
	int first = 0;

	memset(value, 0, 3 * sizeof(*value));
	for (int k = 0; k < reader->count; k++) {
		const struct basis_block_payload *block = &reader->block[k];
		const struct basis_layout at = basis_layout(&block->entry,
							    reader->settings->coarse);
		const int column = reader_find(block, &at, light);
		double own[3][PART_PIXELS] = {{0}};
		double y[RANK_MOST][3];

		for (int j = 0; j < block->entry.patterns; j++)
			for (int c = 0; c < 3; c++)
				y[j][c] =
					reader->at_light[(size_t)(first + j) *
								 (size_t)reader->settings->lights +
							 (size_t)light];
		add_patterns(reader, &block->entry, first, (const double(*)[3])y, own);
		if (column >= 0)
			add_column(block, &at, column, one, own);
		reader_add_block(reader->part, block, &at, (const double(*)[PART_PIXELS])own,
				 value);
		first += block->entry.patterns;
	}
}

/* What a column of a block is weighed by under a sky: as the compositor does it. The part's blocks
 * have all the same pixels, and follow each other. */
static void reader_weigh(const struct block_reader *reader, const struct basis_block_payload *block,
			 int sky, int number, double factor[3])
{
	const struct basis_groups *groups = reader->settings->groups;
	const struct part *part = reader->part;
	const bool *grouped = grouped_of(reader, block);
	const bool single = number < groups->lights;
	const int group = !groups->count ? 0
			  : single	 ? groups->of[number]
					 : number - groups->lights;

	for (int c = 0; c < 3; c++) {
		const size_t row = (size_t)(sky * 3 + c);
		const double x =
			single ? (double)part->sky_x[row * (size_t)groups->lights + (size_t)number]
			       : 0;

		factor[c] = x;
		if (groups->count && grouped[group])
			factor[c] = (single ? -part->share[number] : 1) *
					    (double)part->sky_even[row * (size_t)groups->count +
								   (size_t)group] +
				    x;
	}
}

void block_reader_sky(const struct block_reader *reader, int sky, double (*sum)[PART_PIXELS])
{
	const struct part *part = reader->part;
	const size_t n = (size_t)reader->settings->lights;
	const float *x = part->sky_x + (size_t)sky * 3 * n;
	int first = 0;

	memset(sum, 0, 3 * sizeof(*sum));
	for (int k = 0; k < reader->count; k++) {
		const struct basis_block_payload *block = &reader->block[k];
		const struct basis_block_entry *e = &block->entry;
		const struct basis_layout at = basis_layout(e, reader->settings->coarse);
		const uint8_t *payload = block->payload;
		const void *scales = payload + at.column_scale;
		double own[3][PART_PIXELS] = {{0}};
		double y[RANK_MOST][3];

		for (int j = 0; j < e->patterns; j++)
			for (int c = 0; c < 3; c++) {
				const double *at_light = reader->at_light + (size_t)(first + j) * n;

				y[j][c] = 0;
				for (size_t i = 0; i < n; i++)
					y[j][c] += at_light[i] * (double)x[(size_t)c * n + i];
			}
		add_patterns(reader, e, first, (const double(*)[3])y, own);
		for (uint32_t i = 0; i < e->columns; i++) {
			const double most = (double)((const float *)scales)[i] *
					    (e->bits == 8 ? 127 : 32767);
			const uint16_t number = ((const uint16_t *)(payload + at.light))[i];
			const double cut = number < n ? part->column_cut : part->group_cut;
			double factor[3];

			reader_weigh(reader, block, sky, number, factor);
			if (most * fmax(fmax(fabs(factor[0]), fabs(factor[1])), fabs(factor[2])) >=
			    cut)
				add_column(block, &at, (int)i, factor, own);
		}
		reader_add_block(reader->part, block, &at, (const double(*)[PART_PIXELS])own, sum);
		first += e->patterns;
	}
}

double block_reader_rounding(const struct block_reader *reader)
{
	double most = 0;

	for (int group = 0; group < reader->settings->groups->count; group++) {
		double own = 0;

		for (int k = 0; k < reader->count; k++) {
			const struct basis_block_payload *block = &reader->block[k];
			const struct basis_layout at = basis_layout(&block->entry,
								    reader->settings->coarse);
			const void *scales = (const uint8_t *)block->payload + at.column_scale;
			const int n = reader_find(block, &at, reader->settings->lights + group);

			if (n >= 0)
				own += (double)((const float *)scales)[n] *
				       (block->entry.tinted ? 1 : 0.5);
		}
		most = fmax(most, own);
	}
	return most * (1 + FLT_EPSILON);
}
