/* SPDX-License-Identifier: MIT */
#include "bake/encode/encode_block.h"

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

/* A payload of zeros with its pixels. */
static int block_list_add(struct block_list *list, const struct encode_settings *settings,
			  const struct part *part, struct basis_block_entry entry, bool all,
			  uint8_t **payload)
{
	struct basis_layout at;
	struct block_room *room;
	uint16_t *pixel;

	if (list->count == list->places && more_places(list) < 0)
		return -ENOMEM;
	entry.kind = (uint8_t)part->kind;
	entry.ground = part->kind == BASIS_KIND_V ? (uint32_t)part->ground : 0;
	entry.pixels = (uint16_t)(all ? part->pixels : part->kept);
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
	pixel = (uint16_t *)(*payload + at.pixel);
	for (int p = 0; p < part->pixels; p++)
		if (all || part->keep[p])
			*pixel++ = part->pixel[p];
	return 0;
}

/* ---- writing ---- */

static void write_patterns(const struct search *s, const struct split *split, bool mono,
			   const struct basis_block_entry *entry, uint8_t *payload)
{
	const struct basis_layout at = basis_layout(entry, s->settings->coarse);
	const struct rank_patterns *from = mono ? &split->mono_patterns : &split->colour_patterns;
	const struct part *part = split->part;
	int16_t *to = (int16_t *)(payload + at.coefficient);

	memcpy(payload + at.pattern_scale, from->scale, entry->patterns * sizeof(float));
	memcpy(payload + at.pattern, from->pattern,
	       entry->patterns * (size_t)at.stride * sizeof(int16_t));
	for (int j = 0; j < entry->patterns; j++)
		for (int c = 0; c < entry->channels; c++) {
			const int16_t *row = from->stored + (size_t)j * PART_ROWS +
					     (size_t)(c * part->pixels);
			int place = 0;

			for (int p = 0; p < part->pixels; p++) {
				const size_t line = basis_line16(at.panels16, entry->patterns, c,
								 place / BASIS_LINE16, j);

				if (!part->keep[p])
					continue;
				to[line * BASIS_LINE16 + (size_t)(place++ % BASIS_LINE16)] = row[p];
			}
		}
}

static void write_tint(const struct search *s, const struct split *split,
		       const struct basis_block_entry *entry, uint8_t *payload)
{
	const struct basis_layout at = basis_layout(entry, s->settings->coarse);
	uint16_t *to = (uint16_t *)(payload + at.tint);

	for (int c = 0; c < 3; c++)
		for (int p = 0; p < split->part->pixels; p++)
			if (split->part->keep[p])
				*to++ = split->tint[c][p];
}

/* Its light and its scale. */
static void write_heading(const struct basis_block_payload *block, const struct basis_layout *at,
			  int number, int light, float scale)
{
	uint8_t *payload = (uint8_t *)(uintptr_t)block->payload;
	void *scales = payload + at->column_scale;

	((uint16_t *)(payload + at->light))[number] = (uint16_t)light;
	((float *)scales)[number] = scale;
}

/* Writes a column of 16 bits. value: [channels][part's pixels]. */
static void write_column(const struct encode_settings *settings, const struct part *part, bool all,
			 const struct basis_block_payload *block, int number, int light,
			 float scale, const int16_t *value)
{
	const struct basis_block_entry *entry = &block->entry;
	const struct basis_layout at = basis_layout(entry, settings->coarse);
	int16_t *to = (int16_t *)((uint8_t *)(uintptr_t)block->payload + at.column);

	write_heading(block, &at, number, light, scale);
	for (int c = 0; c < entry->channels; c++) {
		int place = 0;

		for (int p = 0; p < part->pixels; p++) {
			const size_t line = basis_line16(at.panels16, (int)entry->columns, c,
							 place / BASIS_LINE16, number);

			if (!all && !part->keep[p])
				continue;
			to[line * BASIS_LINE16 + (size_t)(place++ % BASIS_LINE16)] =
				value[c * part->pixels + p];
		}
	}
}

/* Writes a column of 8 bits, after all columns before it. */
static void write_record(const struct encode_settings *settings, const struct part *part,
			 const struct basis_block_payload *block, int number, int light,
			 const struct split_column *column)
{
	const struct basis_block_entry *entry = &block->entry;
	const struct basis_layout at = basis_layout(entry, settings->coarse);
	const int panels = at.panels8, lines = panels * entry->channels;
	uint8_t *payload = (uint8_t *)(uintptr_t)block->payload, *to;
	uint32_t *place = (uint32_t *)(void *)(payload + at.column) + number;
	int8_t value[BASIS_RECORD_LINES][BASIS_LINE8] = {{0}};

	write_heading(block, &at, number, light, column->scale);
	for (int c = 0; c < entry->channels; c++)
		for (int p = 0, k = 0; p < part->pixels; p++) {
			if (!part->keep[p])
				continue;
			value[k / BASIS_LINE8 * entry->channels + c][k % BASIS_LINE8] =
				(int8_t)column->value[c * part->pixels + p];
			k++;
		}
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

/* The next column of a block, in the order of their numbers. */
static void write_next(const struct search *s, const struct split *split,
		       const struct basis_block_payload *block, int number, int light,
		       const struct split_column *column)
{
	if (block->entry.bits == 8)
		write_record(s->settings, split->part, block, number, light, column);
	else
		write_column(s->settings, split->part, false, block, number, light, column->scale,
			     column->value);
}

static void write_columns(struct block_list *list, int first, const struct search *s,
			  const struct split *split, const struct encode_plan_block *blocks,
			  int count)
{
	const int lights = s->settings->lights;
	int written[PLAN_BLOCKS_MAX] = {0};
	struct split_column column[LIGHT_COLUMNS_MAX];

	for (int i = 0; i < lights; i++) {
		float left[LIGHT_COLUMNS_MAX * PART_ROWS];
		const int columns = search_light(split, i, left, column);

		for (int k = 0; k < count; k++)
			for (int n = 0; n < columns; n++)
				if (blocks[k].form == column[n].form)
					write_next(s, split, &list->block[first + k], written[k]++,
						   i, &column[n]);
	}
	for (int k = 0; k < count && split->part->share; k++)
		for (int g = 0; g < s->settings->groups->count; g++) {
			const struct found_group *group = &s->group[!blocks[k].mono][g];

			if (!group->columns || group->number < 0)
				continue;
			search_group(s, split, !blocks[k].mono, g, column);
			if (blocks[k].form == column->form)
				write_next(s, split, &list->block[first + k], written[k]++,
					   lights + g, column);
		}
}

int block_build(struct block_list *list, const struct search *s, const struct split *split,
		const struct encode_plan *plan, int tile)
{
	struct encode_plan_block blocks[PLAN_BLOCKS_MAX];
	const int count = encode_plan_blocks(plan, blocks), first = list->count;

	if (!split->part->kept)
		return 0;
	for (int k = 0; k < count; k++) {
		struct basis_block_entry entry = {
			.tile = (uint32_t)tile,
			.channels = blocks[k].mono ? 1 : 3,
			.bits = (uint8_t)blocks[k].bits,
			.tinted = blocks[k].mono && split->tinted,
			.patterns = (uint16_t)blocks[k].patterns,
			.columns = (uint32_t)blocks[k].columns,
			.record_bytes = encode_plan_record_bytes(plan, &blocks[k]),
		};
		uint8_t *payload;
		int err = block_list_add(list, s->settings, split->part, entry, false, &payload);

		if (err)
			return err;
		entry = list->block[first + k].entry;
		if (entry.tinted)
			write_tint(s, split, &entry, payload);
		write_patterns(s, split, blocks[k].mono, &entry, payload);
	}
	write_columns(list, first, s, split, blocks, count);
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
	err = block_list_add(list, settings, part, entry, true, &payload);
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
		write_column(settings, part, true, &list->block[list->count - 1], i, i, scale,
			     value);
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

	return block_list_add(list, settings, part, entry, false, &payload);
}
