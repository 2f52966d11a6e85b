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
	free(reader->values);
	free(reader->grouped);
	*reader = (struct block_reader){.count = 0};
}

static int reader_reserve(struct block_reader *reader, int count, size_t values)
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
	if (values > reader->values_room) {
		free(reader->values);
		reader->values_room = 0;
		reader->values = malloc(values * sizeof(*reader->values));
		if (!reader->values)
			return -ENOMEM;
		reader->values_room = values;
	}
	if (!reader->grouped)
		reader->grouped = calloc(2 * groups + 1, sizeof(*reader->grouped));
	return reader->grouped ? 0 : -ENOMEM;
}

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
	const void *scales = payload + at->pattern_scale;
	const int16_t *pattern = (const int16_t *)(payload + at->pattern);
	const int16_t *coefficient = (const int16_t *)(payload + at->coefficient);
	double *light = reader->values + block->at_light;
	double *row = reader->values + block->coefficient;

	for (int j = 0; j < e->patterns; j++, pattern += at->stride) {
		for (int i = 0; i < settings->lights; i++, light++) {
			*light = settings->gather ? 0 : pattern[i];
			for (int a = 0; settings->gather && a < 3; a++)
				*light +=
					pattern[settings->gather[i].index[a]] *
					((double)settings->gather[i].weight[a] / BASIS_COARSE_ONE);
		}
		for (int c = 0; c < e->channels; c++)
			for (int p = 0; p < e->pixels; p++) {
				const size_t line = basis_line16(at->panels16, e->patterns, c,
								 p / BASIS_LINE16, j);

				*row++ = (double)((const float *)scales)[j] *
					 coefficient[line * BASIS_LINE16 +
						     (size_t)(p % BASIS_LINE16)];
			}
	}
}

static void read_column16(const struct read_block *block, const struct basis_layout *at, int number,
			  double *to)
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
			 double *to)
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

	read_patterns(reader, block, &at);
	for (int n = 0; n < (int)e->columns; n++) {
		double *to = reader->values + block->column + (size_t)n * each;

		if (e->bits == 16)
			read_column16(block, &at, n, to);
		else
			read_column8(block, &at, n, to);
		if (block->number[n] >= reader->settings->lights)
			grouped_of(reader, e)[block->number[n] - reader->settings->lights] = true;
	}
}

/* Where a block's arrays are. Returns how many values it has. */
static size_t place_block(struct read_block *block, const struct encode_settings *settings,
			  const struct basis_block_payload *from, size_t values)
{
	const struct basis_block_entry *e = &from->entry;
	const struct basis_layout at = basis_layout(e, settings->coarse);
	const uint8_t *payload = from->payload;
	const void *scale = payload + at.column_scale;
	const size_t each = (size_t)(e->channels * e->pixels);

	*block = (struct read_block){
		.from = from,
		.number = (const uint16_t *)(payload + at.light),
		.tint = e->tinted ? (const uint16_t *)(payload + at.tint) : NULL,
		.scale = scale,
		.at_light = values,
		.coefficient = values + e->patterns * (size_t)settings->lights,
	};
	block->column = block->coefficient + e->patterns * each;
	return block->column + e->columns * each - values;
}

int block_reader_open(struct block_reader *reader, const struct encode_settings *settings,
		      const struct part *part, const struct basis_block_payload *from, int count)
{
	struct read_block spare;
	size_t values = 0;
	int err;

	reader->settings = settings;
	reader->part = part;
	for (int k = 0; k < count; k++)
		values += place_block(&spare, settings, &from[k], values);
	err = reader_reserve(reader, count, values);
	if (err)
		return err;
	memset(reader->grouped, 0, 2 * (size_t)settings->groups->count * sizeof(*reader->grouped));
	reader->count = count;
	values = 0;
	for (int k = 0; k < count; k++) {
		values += place_block(&reader->block[k], settings, &from[k], values);
		read_block(reader, &reader->block[k]);
	}
	return 0;
}

/* ---- sums ---- */

/* own[c] += factor[c] * row of a block, in each channel. */
static void add_row(const struct basis_block_entry *e, const double *row, const double factor[3],
		    double (*own)[PART_PIXELS])
{
	for (int c = 0; c < 3; c++) {
		const double *from = row + (e->channels == 3 ? c * e->pixels : 0);
		const double by = factor[c];

		for (int p = 0; p < e->pixels && by != 0; p++)
			own[c][p] += by * from[p];
	}
}

/* value += a block's sum, tinted. */
static void add_tinted(const struct read_block *block, const double (*own)[PART_PIXELS],
		       double (*value)[PART_PIXELS])
{
	const int pixels = block->from->entry.pixels;

	for (int c = 0; c < 3; c++)
		for (int p = 0; p < pixels; p++)
			value[c][p] += own[c][p] * (block->tint
							    ? (double)block->tint[c * pixels + p] /
								      BASIS_TINT_ONE
							    : 1);
}

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

static const double *column_of(const struct block_reader *reader, const struct read_block *block,
			       int n)
{
	const struct basis_block_entry *e = &block->from->entry;

	return reader->values + block->column + (size_t)n * (size_t)(e->channels * e->pixels);
}

void block_reader_light(const struct block_reader *reader, int light, double (*value)[PART_PIXELS])
{
	const size_t lights = (size_t)reader->settings->lights;

	memset(value, 0, 3 * sizeof(*value));
	for (int k = 0; k < reader->count; k++) {
		const struct read_block *block = &reader->block[k];
		const struct basis_block_entry *e = &block->from->entry;
		const int column = reader_find(block, light);
		double own[3][PART_PIXELS] = {{0}};

		for (size_t j = 0; j < e->patterns; j++) {
			const double y =
				reader->values[block->at_light + j * lights + (size_t)light];

			add_row(e,
				reader->values + block->coefficient +
					j * (size_t)(e->channels * e->pixels),
				(double[]){y, y, y}, own);
		}
		if (column >= 0) {
			const double by = (double)block->scale[column];

			add_row(e, column_of(reader, block, column), (double[]){by, by, by}, own);
		}
		add_tinted(block, (const double(*)[PART_PIXELS])own, value);
	}
}

/* The light of a column under a sky, as the compositor has it: the part's blocks have all the same
 * pixels, and follow each other. */
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

		light[c] = single ? (double)part->sky_x[row * n + number] : 0;
		if (groups->count && grouped[group])
			light[c] += (single ? -part->share[number] : 1) *
				    (double)part->sky_even[row * groups->count + group];
	}
}

static double largest_of_three(const double x[3])
{
	return fmax(fmax(fabs(x[0]), fabs(x[1])), fabs(x[2]));
}

static void add_columns(const struct block_reader *reader, const struct read_block *block, int sky,
			double (*own)[PART_PIXELS])
{
	const struct basis_block_entry *e = &block->from->entry;
	const struct part *part = reader->part;

	for (int n = 0; n < (int)e->columns; n++) {
		const double scale = (double)block->scale[n];
		const double cut = (double)e->cut_share *
				   (block->number[n] < reader->settings->lights ? part->column_cut
										: part->group_cut);
		double light[3];

		column_light(reader, block, sky, block->number[n], light);
		if (largest_of_three(light) * scale * (e->bits == 8 ? INT8_MAX : INT16_MAX) < cut)
			continue;
		for (int c = 0; c < 3; c++)
			light[c] *= scale;
		add_row(e, column_of(reader, block, n), light, own);
	}
}

void block_reader_sky(const struct block_reader *reader, int sky, double (*sum)[PART_PIXELS])
{
	const size_t n = (size_t)reader->settings->lights;
	const float *x = reader->part->sky_x + (size_t)sky * 3 * n;

	memset(sum, 0, 3 * sizeof(*sum));
	for (int k = 0; k < reader->count; k++) {
		const struct read_block *block = &reader->block[k];
		const struct basis_block_entry *e = &block->from->entry;
		double own[3][PART_PIXELS] = {{0}};

		for (size_t j = 0; j < e->patterns; j++) {
			const double *light = reader->values + block->at_light + j * n;
			double y[3] = {0};

			for (size_t i = 0; i < n; i++)
				for (size_t c = 0; c < 3; c++)
					y[c] += light[i] * (double)x[c * n + i];
			add_row(e,
				reader->values + block->coefficient +
					j * (size_t)(e->channels * e->pixels),
				y, own);
		}
		add_columns(reader, block, sky, own);
		add_tinted(block, (const double(*)[PART_PIXELS])own, sum);
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
