/* SPDX-License-Identifier: MIT */
#include "bake/judge/reader.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"

void block_reader_free(struct block_reader *reader)
{
	free(reader->block);
	free(reader->at_light);
	free(reader->rows);
	free(reader->grouped);
	*reader = (struct block_reader){.count = 0};
}

static int reader_reserve(struct block_reader *reader, int count, size_t at_light, size_t rows)
{
	const size_t groups = (size_t)reader->settings->groups->count;

	if (count > reader->room) {
		free(reader->block);
		reader->room = 0;
		reader->block = calloc((size_t)count, sizeof(*reader->block));
		if (!reader->block)
			return -ENOMEM;
		reader->room = count;
	}
	if (at_light > reader->at_light_room) {
		free(reader->at_light);
		reader->at_light_room = 0;
		reader->at_light = malloc(at_light * sizeof(*reader->at_light));
		if (!reader->at_light)
			return -ENOMEM;
		reader->at_light_room = at_light;
	}
	if (!reader->grouped)
		reader->grouped = calloc(2 * groups + 1, sizeof(*reader->grouped));
	return reader->grouped ? part_room_for(&reader->rows, &reader->rows_room, rows) : -ENOMEM;
}

/* Returns the flags of groups for blocks with as many channels as this one. */
static bool *grouped_of(const struct block_reader *reader, const struct basis_block_entry *e)
{
	return reader->grouped + (e->channels == 3 ? reader->settings->groups->count : 0);
}

/* ---- decoding ---- */

static void read_patterns(const struct block_reader *reader, const struct read_block *block,
			  const struct basis_layout *at)
{
	const struct basis_block_entry *e = &block->from->entry;
	const struct encode_settings *settings = reader->settings;
	const uint8_t *payload = block->from->payload;
	const int16_t *pattern = (const int16_t *)(payload + at->pattern);
	const int16_t *coefficient = (const int16_t *)(payload + at->coefficient);
	double *light = reader->at_light + block->at_light;
	float *row = reader->rows + block->row;

	for (int i = 0; i < settings->lights; i++)
		for (int j = 0; j < e->patterns; j++, light++) {
			const int16_t *from = pattern + j * at->stride;

			*light = settings->gather ? 0 : from[i];
			for (int a = 0; settings->gather && a < 3; a++)
				*light +=
					from[settings->gather[i].index[a]] *
					((double)settings->gather[i].weight[a] / BASIS_COARSE_ONE);
			*light *= (double)block->pattern_scale[j];
		}
	for (int j = 0; j < e->patterns; j++)
		for (int c = 0; c < e->channels; c++)
			for (int p = 0; p < e->pixels; p++) {
				const size_t line = basis_line16(at->panels16, e->patterns, c,
								 p / BASIS_LINE16, j);

				*row++ = coefficient[line * BASIS_LINE16 +
						     (size_t)(p % BASIS_LINE16)];
			}
}

static void read_column16(const struct read_block *block, const struct basis_layout *at, int number,
			  float *to)
{
	const struct basis_block_entry *e = &block->from->entry;
	const void *columns = (const uint8_t *)block->from->payload + at->column;

	for (int c = 0; c < e->channels; c++)
		for (int p = 0; p < e->pixels; p++) {
			const size_t line = basis_line16(at->panels16, (int)e->columns, c,
							 p / BASIS_LINE16, number);

			*to++ = ((const int16_t *)
					 columns)[line * BASIS_LINE16 + (size_t)(p % BASIS_LINE16)];
		}
}

static void read_column8(const struct read_block *block, const struct basis_layout *at, int number,
			 float *to)
{
	const struct basis_block_entry *e = &block->from->entry;
	const void *record_at = (const uint8_t *)block->from->payload + at->column;
	const uint8_t *code = (const uint8_t *)block->from->payload + at->record +
			      ((const uint32_t *)record_at)[number];
	const int lines = at->panels8 * e->channels;
	const uint8_t *from = code + basis_record_head(lines);

	for (int k = 0; k < lines; from += basis_line_bytes(code[k++])) {
		const int c = k % e->channels, first = k / e->channels * BASIS_LINE8;
		int8_t line[BASIS_LINE8];

		basis_line_unpack(code[k], from, line);
		for (int p = 0; p < BASIS_LINE8 && first + p < e->pixels; p++)
			to[c * e->pixels + first + p] = line[p];
	}
}

static void read_block(struct block_reader *reader, const struct read_block *block)
{
	const struct basis_block_entry *e = &block->from->entry;
	const struct basis_layout at = basis_layout(e, reader->settings->coarse);
	const size_t each = (size_t)(e->channels * e->pixels);
	float *to = reader->rows + block->row + e->patterns * each;

	read_patterns(reader, block, &at);
	for (int n = 0; n < (int)e->columns; n++, to += each) {
		if (e->bits == 16)
			read_column16(block, &at, n, to);
		else
			read_column8(block, &at, n, to);
		if (block->number[n] >= reader->settings->lights)
			grouped_of(reader, e)[block->number[n] - reader->settings->lights] = true;
	}
}

/* Points a block to its arrays, and adds its sizes to those of the arrays. */
static void place_block(struct read_block *block, const struct encode_settings *settings,
			const struct basis_block_payload *from, size_t *at_light, size_t *rows)
{
	const struct basis_block_entry *e = &from->entry;
	const struct basis_layout at = basis_layout(e, settings->coarse);
	const uint8_t *payload = from->payload;
	const void *scale = payload + at.column_scale, *pattern_scale = payload + at.pattern_scale;

	*block = (struct read_block){
		.from = from,
		.number = (const uint16_t *)(payload + at.light),
		.tint = e->tinted ? (const uint16_t *)(payload + at.tint) : NULL,
		.scale = scale,
		.pattern_scale = pattern_scale,
		.at_light = *at_light,
		.row = *rows,
	};
	*at_light += e->patterns * (size_t)settings->lights;
	*rows += (e->patterns + e->columns) * (size_t)(e->channels * e->pixels);
}

int block_reader_open(struct block_reader *reader, const struct encode_settings *settings,
		      const struct part *part, const struct basis_block_payload *from, int count)
{
	struct read_block spare;
	size_t at_light = 0, rows = 0;
	int err;

	reader->settings = settings;
	reader->part = part;
	for (int k = 0; k < count; k++)
		place_block(&spare, settings, &from[k], &at_light, &rows);
	err = reader_reserve(reader, count, at_light, rows);
	if (err)
		return err;
	memset(reader->grouped, 0, 2 * (size_t)settings->groups->count * sizeof(*reader->grouped));
	reader->count = count;
	at_light = rows = 0;
	for (int k = 0; k < count; k++) {
		place_block(&reader->block[k], settings, &from[k], &at_light, &rows);
		read_block(reader, &reader->block[k]);
	}
	return 0;
}

/* ---- sums ---- */

/* Returns row n of a block: the coefficients of pattern n, or the values of column n - patterns. */
static const float *row_of(const struct block_reader *reader, const struct read_block *block, int n)
{
	const struct basis_block_entry *e = &block->from->entry;

	return reader->rows + block->row + (size_t)n * (size_t)(e->channels * e->pixels);
}

/* Returns the index of a light's or group's column in a block, or -1. */
static int reader_find(const struct read_block *block, int number)
{
	int low = 0, high = (int)block->from->entry.columns;

	while (low < high) {
		const int middle = (low + high) / 2;

		if (block->number[middle] < number)
			low = middle + 1;
		else
			high = middle;
	}
	return low < (int)block->from->entry.columns && block->number[low] == number ? low : -1;
}

static void add_row(const float *row, double by, int count, double *sum)
{
	for (int r = 0; r < count; r++)
		sum[r] += by * (double)row[r];
}

void block_reader_light(const struct block_reader *reader, int light, double (*value)[PART_PIXELS])
{
	memset(value, 0, 3 * sizeof(*value));
	for (int k = 0; k < reader->count; k++) {
		const struct read_block *block = &reader->block[k];
		const struct basis_block_entry *e = &block->from->entry;
		const int column = reader_find(block, light), pixels = e->pixels;
		const double *y = reader->at_light + block->at_light +
				  (size_t)light * (size_t)e->patterns;
		double own[PART_ROWS] = {0};

		for (int j = 0; j < e->patterns; j++)
			add_row(row_of(reader, block, j), y[j], e->channels * pixels, own);
		if (column >= 0)
			add_row(row_of(reader, block, e->patterns + column),
				(double)block->scale[column], e->channels * pixels, own);
		for (int c = 0; c < 3; c++) {
			const double *from = own + (e->channels == 3 ? c * pixels : 0);

			for (int p = 0; p < pixels; p++)
				value[c][p] += block->tint ? block->tint[c * pixels + p] * from[p] /
								     BASIS_TINT_ONE
							   : from[p];
		}
	}
}

/* Computes a column's light under a sky as the compositor does: X - q S of a light whose group has
 * a column in any of the part's blocks with as many channels, S of a group. */
static void column_light(const struct block_reader *reader, const struct read_block *block, int sky,
			 int number, double light[3])
{
	const struct basis_groups *groups = reader->settings->groups;
	const struct part *part = reader->part;
	const bool *grouped = grouped_of(reader, &block->from->entry);
	const int n = reader->settings->lights;
	const bool single = number < n;
	const int group = !groups->count ? 0 : single ? groups->of[number] : number - n;

	for (int c = 0; c < 3; c++) {
		const int row = sky * 3 + c;

		light[c] = single ? (double)part->sky.x[row * n + number] : 0;
		if (groups->count && grouped[group])
			light[c] += (single ? -part->sky.share[number] : 1) *
				    (double)part->sky.even[row * groups->count + group];
	}
}

static double largest_of_three(const double x[3])
{
	return fmax(fmax(fabs(x[0]), fabs(x[1])), fabs(x[2]));
}

/* sum[c] += by[c] * row, for each channel. */
static void add_lit(const struct basis_block_entry *e, const float *row, const double by[3],
		    float (*sum)[PART_PIXELS])
{
	for (int c = 0; c < 3; c++) {
		const float *from = row + (e->channels == 3 ? c * e->pixels : 0);
		const float factor = (float)by[c];

		for (int p = 0; p < e->pixels; p++)
			sum[c][p] += factor * from[p];
	}
}

static void add_patterns(const struct block_reader *reader, const struct read_block *block, int sky,
			 float (*sum)[PART_PIXELS])
{
	const int n = reader->settings->lights, patterns = block->from->entry.patterns;
	const float *x = reader->part->sky.x + (size_t)sky * 3 * (size_t)n;
	const double *light = reader->at_light + block->at_light;
	double y[3][RANK_MOST] = {{0}};

	for (int i = 0; i < n; i++, light += patterns)
		for (int c = 0; c < 3; c++)
			for (int j = 0; j < patterns; j++)
				y[c][j] += (double)x[c * n + i] * light[j];
	for (int j = 0; j < patterns; j++)
		add_lit(&block->from->entry, row_of(reader, block, j),
			(double[]){y[0][j], y[1][j], y[2][j]}, sum);
}

static void add_columns(const struct block_reader *reader, const struct read_block *block, int sky,
			float (*sum)[PART_PIXELS])
{
	const struct basis_block_entry *e = &block->from->entry;
	const struct part *part = reader->part;

	for (int n = 0; n < (int)e->columns; n++) {
		const double scale = (double)block->scale[n];
		const double cut = (double)e->cut_share *
				   (block->number[n] < reader->settings->lights
					    ? part->limit.column_cut
					    : part->limit.group_cut);
		double light[3];

		column_light(reader, block, sky, block->number[n], light);
		if (largest_of_three(light) * scale * (e->bits == 8 ? INT8_MAX : INT16_MAX) < cut)
			continue;
		for (int c = 0; c < 3; c++)
			light[c] *= scale;
		add_lit(e, row_of(reader, block, e->patterns + n), light, sum);
	}
}

void block_reader_sky(const struct block_reader *reader, int sky, float (*sum)[PART_PIXELS])
{
	memset(sum, 0, 3 * sizeof(*sum));
	for (int k = 0; k < reader->count; k++) {
		const struct read_block *block = &reader->block[k];
		const int pixels = block->from->entry.pixels;
		float own[3][PART_PIXELS] = {{0}};

		add_patterns(reader, block, sky, own);
		add_columns(reader, block, sky, own);
		for (int c = 0; c < 3; c++) {
			for (int p = 0; p < pixels && block->tint; p++)
				own[c][p] = own[c][p] * block->tint[c * pixels + p] /
					    BASIS_TINT_ONE;
			for (int p = 0; p < pixels; p++)
				sum[c][p] += own[c][p];
		}
	}
}

double block_reader_rounding(const struct block_reader *reader)
{
	double most = 0;

	for (int group = 0; group < reader->settings->groups->count; group++) {
		double own = 0;

		for (int k = 0; k < reader->count; k++) {
			const struct read_block *block = &reader->block[k];
			const int n = reader_find(block, reader->settings->lights + group);

			if (n >= 0)
				own += (double)block->scale[n] * (block->tint ? 1 : 0.5);
		}
		most = fmax(most, own);
	}
	return most * (1 + FLT_EPSILON);
}
