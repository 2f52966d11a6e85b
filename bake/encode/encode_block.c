/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_parts.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"

void block_list_free(struct block_list *list)
{
	for (int k = 0; k < list->places; k++)
		free(list->room[k].data);
	free(list->room);
	free(list->block);
	*list = (struct block_list){.count = 0};
}

static int more_places(struct block_list *list)
{
	const int places = list->places ? 2 * list->places : 8;
	void *grown = realloc(list->block, (size_t)places * sizeof(*list->block));

	if (!grown)
		return -ENOMEM;
	list->block = grown;
	grown = realloc(list->room, (size_t)places * sizeof(*list->room));
	if (!grown)
		return -ENOMEM;
	list->room = grown;
	memset(list->room + list->places, 0, (size_t)(places - list->places) * sizeof(*list->room));
	list->places = places;
	return 0;
}

/* Adds a block whose payload is 0 but for its list of pixels. */
static int block_list_add(struct block_list *list, const struct encode_settings *settings,
			  const struct part *part, struct basis_block_entry entry,
			  uint8_t **payload)
{
	struct basis_layout at;
	struct block_room *room;

	if (list->count == list->places && more_places(list) < 0)
		return -ENOMEM;
	entry.kind = (uint8_t)part->kind;
	entry.ground = part->kind == BASIS_KIND_V ? (uint32_t)part->ground : 0;
	entry.pixels = (uint16_t)part->pixels;
	if (!(entry.cut_share > 0))
		entry.cut_share = 1;
	at = basis_layout(&entry, settings->coarse);
	entry.bytes = at.bytes;
	room = &list->room[list->count];
	if (room->bytes < at.bytes) {
		free(room->data);
		*room = (struct block_room){.bytes = 0};
		if (posix_memalign(&room->data, BASIS_ALIGN, at.bytes) != 0)
			return -ENOMEM;
		room->bytes = at.bytes;
	}
	memset(room->data, 0, at.bytes);
	list->block[list->count++] = (struct basis_block_payload){.entry = entry,
								  .payload = room->data};
	*payload = room->data;
	memcpy(*payload + at.pixel, part->pixel, (size_t)part->pixels * sizeof(*part->pixel));
	return 0;
}

/* ---- writing ---- */

static void write_patterns(const struct low_rank *fit, bool mono,
			   const struct basis_block_entry *entry, uint8_t *payload)
{
	const struct basis_layout at = basis_layout(entry, fit->settings->coarse);
	const struct rank_patterns *from = mono ? &fit->mono_patterns : &fit->colour_patterns;
	const int pixels = fit->part->pixels;
	int16_t *to = (int16_t *)(payload + at.coefficient);

	memcpy(payload + at.pattern_scale, from->scale, entry->patterns * sizeof(float));
	memcpy(payload + at.pattern, from->pattern,
	       entry->patterns * (size_t)at.stride * sizeof(int16_t));
	for (int j = 0; j < entry->patterns; j++)
		for (int c = 0; c < entry->channels; c++)
			for (int p = 0; p < pixels; p++) {
				const size_t line = basis_line16(at.panels16, entry->patterns, c,
								 p / BASIS_LINE16, j);

				to[line * BASIS_LINE16 + (size_t)(p % BASIS_LINE16)] =
					from->stored[(size_t)j * PART_ROWS +
						     (size_t)(c * pixels + p)];
			}
}

static void write_tint(const struct low_rank *fit, const struct basis_block_entry *entry,
		       uint8_t *payload)
{
	const struct basis_layout at = basis_layout(entry, fit->settings->coarse);
	const size_t pixels = (size_t)fit->part->pixels;

	for (size_t c = 0; c < 3; c++)
		memcpy((uint16_t *)(payload + at.tint) + c * pixels, fit->tint[c],
		       pixels * sizeof(*fit->tint[c]));
}

/* Writes the light and the scale of a column. */
static void write_heading(const struct basis_block_payload *block, const struct basis_layout *at,
			  int number, int light, float scale)
{
	uint8_t *payload = (uint8_t *)(uintptr_t)block->payload;
	void *scales = payload + at->column_scale;

	((uint16_t *)(payload + at->light))[number] = (uint16_t)light;
	((float *)scales)[number] = scale;
}

/* Writes a column of 16 bits. value: [channels][pixels]. */
static void write_column(const struct encode_settings *settings,
			 const struct basis_block_payload *block, int number, int light,
			 float scale, const int16_t *value)
{
	const struct basis_block_entry *entry = &block->entry;
	const struct basis_layout at = basis_layout(entry, settings->coarse);
	int16_t *to = (int16_t *)((uint8_t *)(uintptr_t)block->payload + at.column);

	write_heading(block, &at, number, light, scale);
	for (int c = 0; c < entry->channels; c++)
		for (int p = 0; p < entry->pixels; p++) {
			const size_t line = basis_line16(at.panels16, (int)entry->columns, c,
							 p / BASIS_LINE16, number);

			to[line * BASIS_LINE16 + (size_t)(p % BASIS_LINE16)] =
				value[c * entry->pixels + p];
		}
}

/* Writes a column of 8 bits, after all columns before it. */
static void write_record(const struct encode_settings *settings,
			 const struct basis_block_payload *block, int number,
			 const struct column *column)
{
	const struct basis_block_entry *entry = &block->entry;
	const struct basis_layout at = basis_layout(entry, settings->coarse);
	const int lines = at.panels8 * entry->channels;
	uint8_t *payload = (uint8_t *)(uintptr_t)block->payload, *to;
	uint32_t *place = (uint32_t *)(void *)(payload + at.column) + number;
	int8_t value[BASIS_RECORD_LINES][BASIS_LINE8] = {{0}};

	write_heading(block, &at, number, column->number, column->scale);
	for (int c = 0; c < entry->channels; c++)
		for (int p = 0; p < entry->pixels; p++)
			value[p / BASIS_LINE8 * entry->channels + c][p % BASIS_LINE8] =
				(int8_t)column->value[c * entry->pixels + p];
	*place = 0;
	if (number)
		*place = place[-1] +
			 (uint32_t)basis_record_bytes(payload + at.record + place[-1], lines);
	to = payload + at.record + *place;
	memcpy(to, column->code, (size_t)lines);
	to += basis_record_head(lines);
	for (int k = 0; k < lines; k++)
		to += basis_line_pack(column->code[k], value[k], to);
}

static bool column_is_like(const struct column *column, const struct column *form)
{
	return column->channels == form->channels && column->bits == form->bits &&
	       column->second == form->second;
}

static int columns_count(const struct columns *columns, const struct column *form)
{
	int count = 0;

	for (int k = 0; k < columns->count; k++)
		count += column_is_like(&columns->column[k], form);
	return count;
}

/* Adds one block for the columns that have the form's channels, bits and `second`, with the first
 * `patterns` patterns. */
static int build_form(struct block_list *list, const struct low_rank *fit,
		      const struct columns *columns, int tile, const struct column *form,
		      int patterns)
{
	const bool mono = form->channels == 1;
	struct basis_block_entry entry = {
		.tile = (uint32_t)tile,
		.channels = (uint8_t)form->channels,
		.bits = (uint8_t)form->bits,
		.tinted = mono && fit->tinted,
		.patterns = (uint16_t)patterns,
		.cut_share = (float)fit->cut_share,
		.columns = (uint32_t)columns_count(columns, form),
	};
	const struct basis_block_payload *block;
	uint8_t *payload;
	int written = 0, err;

	for (int k = 0; k < columns->count; k++)
		if (form->bits == 8 && column_is_like(&columns->column[k], form))
			entry.record_bytes += (uint32_t)columns->column[k].bytes;
	err = block_list_add(list, fit->settings, fit->part, entry, &payload);
	if (err)
		return err;
	block = &list->block[list->count - 1];
	if (entry.tinted)
		write_tint(fit, &block->entry, payload);
	write_patterns(fit, mono, &block->entry, payload);
	for (int k = 0; k < columns->count; k++) {
		const struct column *column = &columns->column[k];

		if (!column_is_like(column, form))
			continue;
		if (form->bits == 8)
			write_record(fit->settings, block, written++, column);
		else
			write_column(fit->settings, block, written++, column->number, column->scale,
				     column->value);
	}
	return 0;
}

/* Builds a block for each form of column that occurs. Patterns are stored in the first block of
 * their number of channels; if no column has that number, in a block without columns. */
int block_build(struct block_list *list, const struct low_rank *fit, const struct columns *columns,
		int tile)
{
	for (int channels = 1; channels <= 3; channels += 2) {
		int patterns = channels == 1 ? fit->mono_rank : fit->colour_rank;

		for (int k = 0; k < 4; k++) {
			const struct column form = {
				.channels = channels, .bits = k % 2 ? 16 : 8, .second = k >= 2};
			const bool any = columns_count(columns, &form) > 0;
			int err = 0;

			if (any || (patterns && k == 3))
				err = build_form(list, fit, columns, tile, &form, patterns);
			if (err)
				return err;
			patterns = any ? 0 : patterns;
		}
	}
	return 0;
}

int block_build_exact(struct block_list *list, const struct encode_settings *settings,
		      const struct part *part, int tile)
{
	const struct basis_block_entry entry = {
		.tile = (uint32_t)tile,
		.channels = (uint8_t)part->channels,
		.bits = 16,
		.columns = (uint32_t)settings->lights,
	};
	uint8_t *payload;
	int err;

	if (!(part->largest > 0) && part->kind != BASIS_KIND_U)
		return 0;
	err = block_list_add(list, settings, part, entry, &payload);
	for (int i = 0; !err && i < settings->lights; i++) {
		const float *from = part->value + (size_t)i * (size_t)part->rows;
		int16_t value[PART_ROWS];
		float most = 0, scale;

		for (int r = 0; r < part->rows; r++)
			most = fmaxf(most, fabsf(from[r]));
		scale = (float)((double)most / 32767);
		scale = scale >= FLT_MIN ? scale : 0;
		for (int r = 0; r < part->rows; r++) {
			const long is = scale > 0 ? lrint((double)from[r] / (double)scale) : 0;

			value[r] = (int16_t)(is > 32767 ? 32767 : is < -32767 ? -32767 : is);
		}
		write_column(settings, &list->block[list->count - 1], i, i, scale, value);
	}
	return err;
}

int block_build_zero(struct block_list *list, const struct encode_settings *settings,
		     const struct part *part, int tile)
{
	const struct basis_block_entry entry = {.tile = (uint32_t)tile,
						.channels = 1,
						.bits = 8,
						.columns = 1,
						.record_bytes = BASIS_RECORD_ALIGN};
	uint8_t *payload;

	return block_list_add(list, settings, part, entry, &payload);
}
