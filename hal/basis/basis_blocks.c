/* SPDX-License-Identifier: MIT */
/* Checks every number in the blocks of a basis file, so that no later code needs checks. Loops over
 * whole arrays take most of the time. They collect errors in one variable and test it at the end,
 * so that the compiler can vectorise them. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_blocks.h"
#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"
#include "hal/basis/basis_reader.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)

static const char *const kind_names[] = {"T", "V", "D", "U"};

/* What the blocks of a tile so far hold for each of its pixels. */
struct tile_use {
	uint32_t ground[TILE_PIXELS]; /* ground term of its V blocks + 1; 0: no V row */
	bool changed[TILE_PIXELS];    /* has a D row */
	bool lit[TILE_PIXELS];	      /* has a U row */
};

/* The block in hand, for messages. */
struct block_place {
	const struct basis_reader *reader;
	const struct basis_blocks_chunk *chunk;
	size_t index;
};

#define DAMAGED(place, format, ...)                                                                \
	basis_damaged((place)->reader, "pose %d, %sblock %zu: " format, (place)->chunk->pose,      \
		      (place)->chunk->exact ? "exact " : "", (place)->index, __VA_ARGS__)

static int check_record_bytes(const struct block_place *at, const struct basis_block_entry *e)
{
	const int lines = basis_record_lines(e->pixels, e->channels);
	const size_t columns = e->bits == 8 ? e->columns : 0, head = basis_record_head(lines);
	const size_t least = columns * head;
	const size_t most = columns * (head + (size_t)lines * BASIS_LINE8);

	if (e->record_bytes >= least && e->record_bytes <= most)
		return 0;
	return DAMAGED(at, "%u bytes of records for %u columns of %u bits, expected %zu to %zu",
		       e->record_bytes, e->columns, e->bits, least, most);
}

/* Returns the number of valid light numbers: N, or N + K where groups are allowed. */
static uint32_t light_numbers(const struct block_place *at, int kind)
{
	const struct basis *basis = at->reader->basis;
	const bool groups = basis->info.coarse < basis->info.lights && basis->info.column_cut > 0 &&
			    !at->chunk->exact && (kind == BASIS_KIND_T || kind == BASIS_KIND_V);

	return basis->info.lights + (groups ? basis->info.coarse : 0);
}

static int check_shape(const struct block_place *at, const struct basis_block_entry *e)
{
	const struct basis *basis = at->reader->basis;

	if (e->kind >= BASIS_KIND_COUNT)
		return DAMAGED(at, "kind %u, expected less than %d", e->kind, BASIS_KIND_COUNT);
	if (e->pixels < 1 || e->pixels > TILE_PIXELS)
		return DAMAGED(at, "%u pixels, expected 1 to %d", e->pixels, TILE_PIXELS);
	if (e->channels != 1 && e->channels != 3)
		return DAMAGED(at, "%u channels, expected 1 or 3", e->channels);
	if (e->tinted > 1 || (e->tinted && e->channels != 1))
		return DAMAGED(at, "tinted %u with %u channels, expected 0, or 1 with 1 channel",
			       e->tinted, e->channels);
	if (e->patterns > BASIS_PATTERNS_MAX)
		return DAMAGED(at, "%u patterns, expected at most %d", e->patterns,
			       BASIS_PATTERNS_MAX);
	if (e->columns > light_numbers(at, e->kind))
		return DAMAGED(at, "%u columns, expected at most %u", e->columns,
			       light_numbers(at, e->kind));
	if (!e->patterns && !e->columns)
		return DAMAGED(at, "%d patterns and columns, expected some", 0);
	if (e->bits != 16 && (e->bits != 8 || !e->columns))
		return DAMAGED(at, "%u bits, expected 16, or 8 where there are columns", e->bits);
	if (at->chunk->exact &&
	    (e->patterns || e->columns != basis->info.lights || e->bits != 16 || e->tinted))
		return DAMAGED(
			at,
			"%u patterns and %u columns of %u bits%s, expected the %u lights' columns of 16 bits alone",
			e->patterns, e->columns, e->bits, e->tinted ? ", tinted" : "",
			basis->info.lights);
	if (!(e->cut_share > 0 && e->cut_share <= 1))
		return DAMAGED(at, "a share %g of the cut, expected above 0, at most 1",
			       (double)e->cut_share);
	if (e->reserved)
		return DAMAGED(at, "%u in reserved bytes, expected 0", e->reserved);
	if (e->kind == BASIS_KIND_V ? e->ground >= basis->info.grounds : e->ground != 0)
		return DAMAGED(at, "ground term %u, expected %s %u", e->ground,
			       e->kind == BASIS_KIND_V ? "less than" : "0 in a file of",
			       basis->info.grounds);
	return check_record_bytes(at, e);
}

static int check_lies(const struct block_place *at, const struct basis_block_entry *e,
		      uint64_t free_from)
{
	const struct basis *basis = at->reader->basis;
	const struct basis_blocks_chunk *chunk = at->chunk;
	const uint32_t tiles = (uint32_t)basis->tiles_across * (uint32_t)basis->tiles_down;
	const uint64_t expected = basis_layout(e, (int)basis->info.coarse).bytes;

	if (e->tile >= tiles)
		return DAMAGED(at, "tile %u, expected less than %u", e->tile, tiles);
	if (at->index && (e->tile < e[-1].tile || (e->tile == e[-1].tile && e->kind < e[-1].kind)))
		return DAMAGED(
			at,
			"tile %u, kind %s after tile %u, kind %s, expected the order of tiles, then of kinds",
			e->tile, kind_names[e->kind], e[-1].tile, kind_names[e[-1].kind]);
	if (e->bytes != expected)
		return DAMAGED(at, "%llu bytes, expected %llu", (unsigned long long)e->bytes,
			       (unsigned long long)expected);
	if (e->offset % BASIS_ALIGN || e->offset < free_from || e->offset > chunk->data_bytes ||
	    e->bytes > chunk->data_bytes - e->offset)
		return DAMAGED(
			at,
			"lies at byte %llu, expected a multiple of %d after the block before it and inside the chunk of %zu bytes",
			(unsigned long long)e->offset, BASIS_ALIGN, chunk->data_bytes);
	if (!basis_all_zero(chunk->data + free_from, chunk->data + e->offset))
		return DAMAGED(at, "bytes before it are not %d", 0);
	return 0;
}

int basis_check_shapes(const struct basis_reader *reader, const struct basis_blocks_chunk *chunk)
{
	struct block_place at = {.reader = reader, .chunk = chunk};
	uint64_t end = 0;

	for (at.index = 0; at.index < chunk->count; at.index++) {
		const struct basis_block_entry *e = &chunk->entries[at.index];
		const int ret = check_shape(&at, e);

		if (ret < 0)
			return ret;
		if (e->offset != end ||
		    e->bytes != basis_layout(e, (int)reader->basis->info.coarse).bytes)
			return DAMAGED(
				&at,
				"%llu bytes at byte %llu, expected %zu at %llu, behind the block before it",
				(unsigned long long)e->bytes, (unsigned long long)e->offset,
				basis_layout(e, (int)reader->basis->info.coarse).bytes,
				(unsigned long long)end);
		end += e->bytes;
	}
	return end == chunk->data_bytes
		       ? 0
		       : basis_damaged(reader, "pose %d: blocks of %llu bytes, expected %zu",
				       chunk->pose, (unsigned long long)end, chunk->data_bytes);
}

static void block_locate(struct basis_block *b, const struct basis_block_entry *e,
			 const struct basis_layout *layout, const uint8_t *payload)
{
	/* check_lies() has checked the alignment. */
	const void *pixel = payload + layout->pixel, *tint = payload + layout->tint;
	const void *pattern_scale = payload + layout->pattern_scale;
	const void *pattern = payload + layout->pattern;
	const void *coefficient = payload + layout->coefficient;
	const void *light = payload + layout->light;
	const void *column_scale = payload + layout->column_scale;
	const void *column = payload + layout->column;

	*b = (struct basis_block){
		.kind = e->kind,
		.pixels = e->pixels,
		.channels = e->channels,
		.bits = e->bits,
		.ground = (int)e->ground,
		.patterns = e->patterns,
		.columns = (int)e->columns,
		.stride = layout->stride,
		.pixel = pixel,
		.tint = e->tinted ? tint : NULL,
		.pattern_scale = pattern_scale,
		.pattern = pattern,
		.coefficient = coefficient,
		.light = light,
		.column_scale = column_scale,
		.cut_share = e->cut_share,
		.column16 = e->bits == 16 ? column : NULL,
		.record_at = e->bits == 8 ? column : NULL,
		.record = e->bits == 8 ? payload + layout->record : NULL,
		.bytes = layout->bytes,
	};
}

static int check_padding(const struct block_place *at, const struct basis_block *b,
			 const struct basis_layout *layout, size_t record_bytes,
			 const uint8_t *payload)
{
	const uint8_t *after_tint = b->tint ? (const uint8_t *)(b->tint + 3 * b->pixels)
					    : payload + layout->pattern_scale;

	if (!basis_all_zero((const uint8_t *)(b->pixel + b->pixels), payload + layout->tint) ||
	    !basis_all_zero(after_tint, payload + layout->pattern_scale) ||
	    !basis_all_zero((const uint8_t *)(b->pattern_scale + b->patterns),
			    payload + layout->pattern) ||
	    !basis_all_zero((const uint8_t *)(b->light + b->columns),
			    payload + layout->column_scale) ||
	    !basis_all_zero((const uint8_t *)(b->column_scale + b->columns),
			    payload + layout->column) ||
	    (b->record &&
	     (!basis_all_zero((const uint8_t *)(b->record_at + b->columns), b->record) ||
	      !basis_all_zero(b->record + record_bytes, payload + layout->bytes))))
		return DAMAGED(at, "padding between arrays is not %d", 0);
	return 0;
}

static int use_pixel(const struct block_place *at, const struct basis_block *b, int pixel,
		     struct tile_use *use)
{
	const uint32_t ground = (uint32_t)b->ground + 1;

	switch (b->kind) {
	case BASIS_KIND_V:
		if (use->ground[pixel] && use->ground[pixel] != ground)
			return DAMAGED(at, "ground term %d of pixel %d, expected that before, %u",
				       b->ground, pixel, use->ground[pixel] - 1);
		use->ground[pixel] = ground;
		return 0;
	case BASIS_KIND_D:
		if (use->ground[pixel])
			return DAMAGED(at, "pixel %d has a V row already", pixel);
		use->changed[pixel] = true;
		return 0;
	case BASIS_KIND_U:
		use->lit[pixel] = true;
		return 0;
	default:
		return 0;
	}
}

static int check_pixels(const struct block_place *at, const struct basis_block *b,
			const struct basis_tile *tile, struct tile_use *use)
{
	for (int p = 0; p < b->pixels; p++) {
		const int pixel = b->pixel[p];
		int ret;

		if (pixel % BASIS_TILE >= tile->width || pixel / BASIS_TILE >= tile->height ||
		    (p && pixel <= b->pixel[p - 1]))
			return DAMAGED(
				at,
				"pixel %d, expected ascending numbers inside a tile of %dx%d pixels",
				pixel, tile->width, tile->height);
		ret = use_pixel(at, b, pixel, use);
		if (ret < 0)
			return ret;
	}
	return 0;
}

/* After the last block of a tile: checks that each pixel with a D row has a U row. */
static int check_pairs(const struct block_place *at, const struct tile_use *use, uint32_t tile)
{
	for (int p = 0; p < TILE_PIXELS; p++) {
		if (use->changed[p] && !use->lit[p])
			return DAMAGED(at, "before it, pixel %d of tile %u has a D row and no U", p,
				       tile);
	}
	return 0;
}

static int check_lights(const struct block_place *at, const struct basis_block *b)
{
	const int lights = (int)light_numbers(at, b->kind);
	int wrong = b->columns && b->light[b->columns - 1] >= lights;

	for (int i = 1; i < b->columns; i++)
		wrong |= b->light[i] <= b->light[i - 1];
	for (int i = 0; wrong && i < b->columns; i++) {
		if (b->light[i] >= lights || (i && b->light[i] <= b->light[i - 1]))
			return DAMAGED(at, "light %u, expected ascending numbers below %d",
				       b->light[i], lights);
	}
	return 0;
}

static int check_scale(const struct block_place *at, const char *what, int index, float scale,
		       double times)
{
	if (!isfinite(scale) || signbit(scale))
		return DAMAGED(at, "scale %g of %s %d, expected a finite number, 0 or more",
			       (double)scale, what, index);
	if ((double)scale * times > BASIS_VALUE_MAX)
		return DAMAGED(at, "scale %g of %s %d makes values of %g, expected at most %g",
			       (double)scale, what, index, (double)scale * times, BASIS_VALUE_MAX);
	return 0;
}

/* Non-negative floats have the order of their bits; infinity, NaN and negative ones are above. */
static int check_column_scales(const struct block_place *at, const struct basis_block *b)
{
	const double times = b->bits == 16 ? INT16_MAX : INT8_MAX;
	const float near = (float)(BASIS_VALUE_MAX / times);
	uint32_t limit, bits, wrong = 0;
	int ret = 0;

	memcpy(&limit, &near, sizeof(limit));
	for (int i = 0; i < b->columns; i++) {
		memcpy(&bits, &b->column_scale[i], sizeof(bits));
		wrong |= bits >= limit;
	}
	for (int i = 0; wrong && ret == 0 && i < b->columns; i++)
		ret = check_scale(at, "column", i, b->column_scale[i], times);
	return ret;
}

static int check_patterns(const struct block_place *at, const struct basis_block *b)
{
	const int coarse = (int)at->reader->basis->info.coarse;
	int ret = 0;

	for (int j = 0; ret == 0 && j < b->patterns; j++) {
		const int16_t *row = b->pattern + (size_t)j * (size_t)b->stride;
		int32_t sum = 0; /* <= 2^15 * 2^15 */
		int least = 0;

		for (int k = 0; k < coarse; k++) {
			const int v = row[k];

			least = v < least ? v : least;
			sum += v < 0 ? -v : v;
		}
		if (least == INT16_MIN)
			return DAMAGED(at, "value %d in pattern %d, expected at least %d", least, j,
				       -INT16_MAX);
		if (!basis_all_zero((const uint8_t *)(row + coarse),
				    (const uint8_t *)(row + b->stride)))
			return DAMAGED(at, "padding of pattern %d is not 0", j);
		ret = check_scale(at, "pattern", j, b->pattern_scale[j], (double)INT16_MAX * sum);
	}
	return ret;
}

static bool has_least16(const int16_t *v, size_t count)
{
	unsigned any = 0;

	for (size_t i = 0; i < count; i++)
		any |= v[i] == INT16_MIN;
	return any != 0;
}

/* Checks that the `count` lines of each channel's last panel are 0 after the last pixel. */
static int check_rest(const struct block_place *at, const char *what, const struct basis_block *b,
		      const int16_t *lines, int count)
{
	const int panels = basis_panels16(b->pixels);
	const int used = b->pixels % BASIS_LINE16;
	bool zero = true;

	for (int c = 0; c < b->channels && used && count; c++) {
		const int16_t *line = lines +
				      basis_line16(panels, count, c, panels - 1, 0) * BASIS_LINE16;

		for (int k = 0; k < count; k++, line += BASIS_LINE16)
			zero &= basis_all_zero((const uint8_t *)(line + used),
					       (const uint8_t *)(line + BASIS_LINE16));
	}
	return zero ? 0 : DAMAGED(at, "%s after the last pixel are not 0", what);
}

static int check_lines(const struct block_place *at, const struct basis_block *b,
		       const struct basis_layout *layout)
{
	const int columns = b->column16 ? b->columns : 0;
	const size_t each = (size_t)(layout->panels16 * b->channels) * BASIS_LINE16;
	int ret;

	if (has_least16(b->coefficient, each * (size_t)b->patterns))
		return DAMAGED(at, "value %d among coefficients, expected at least %d", INT16_MIN,
			       -INT16_MAX);
	if (has_least16(b->column16, each * (size_t)columns))
		return DAMAGED(at, "value %d among columns, expected at least %d", INT16_MIN,
			       -INT16_MAX);
	ret = check_rest(at, "coefficients", b, b->coefficient, b->patterns);
	return ret < 0 ? ret : check_rest(at, "columns", b, b->column16, columns);
}

/* Whether a line holds a value that must not occur: -128, or the nibble 15. */
static bool has_least8(uint8_t code, const uint8_t *line)
{
	unsigned any = 0;

	for (int k = 0; k < BASIS_LINE8 && code == BASIS_LINE_WHOLE; k++)
		any |= line[k] == 0x80;
	for (int k = 0; k < BASIS_LINE_HALF && code && code != BASIS_LINE_WHOLE; k++)
		any |= (line[k] & 15) == 15 || line[k] >> 4 == 15;
	return any != 0;
}

/* Checks one record; the caller has checked that its codes fit. Sets *bytes to its length. */
static int check_record(const struct block_place *at, const struct basis_block *b, int column,
			size_t left, size_t *bytes)
{
	const uint8_t *code = b->record + b->record_at[column];
	const int lines = basis_record_lines(b->pixels, b->channels), panels = lines / b->channels;
	const uint8_t *line = code + basis_record_head(lines);
	const int used = b->pixels - (panels - 1) * BASIS_LINE8;

	for (int k = 0; k < lines; k++)
		if (code[k] > BASIS_LINE_FACTOR_MAX && code[k] != BASIS_LINE_WHOLE)
			return DAMAGED(at, "code %u in column %d, expected at most %d, or %d",
				       code[k], column, BASIS_LINE_FACTOR_MAX, BASIS_LINE_WHOLE);
	*bytes = basis_record_bytes(code, lines);
	if (*bytes > left)
		return DAMAGED(at, "column %d takes %zu bytes, expected at most %zu", column,
			       *bytes, left);
	if (!basis_all_zero(code + lines, line))
		return DAMAGED(at, "padding of column %d is not 0", column);
	for (int k = 0; k < lines; line += basis_line_bytes(code[k++])) {
		int8_t values[BASIS_LINE8];

		if (has_least8(code[k], line))
			return DAMAGED(at, "value %s in column %d, expected %s",
				       code[k] == BASIS_LINE_WHOLE ? "-128" : "8", column,
				       code[k] == BASIS_LINE_WHOLE ? "-127 to 127" : "-7 to 7");
		if (k < lines - b->channels)
			continue;
		basis_line_unpack(code[k], line, values);
		if (!basis_all_zero((const uint8_t *)values + used,
				    (const uint8_t *)values + BASIS_LINE8))
			return DAMAGED(at, "values of column %d after the last pixel are not 0",
				       column);
	}
	return 0;
}

static int check_records(const struct block_place *at, const struct basis_block *b, size_t all)
{
	const size_t head = basis_record_head(basis_record_lines(b->pixels, b->channels));
	size_t place = 0;

	for (int n = 0; n < b->columns; n++) {
		size_t bytes = 0;
		int ret;

		if (b->record_at[n] != place || all - place < head)
			return DAMAGED(at, "column %d lies at byte %u, expected %zu of %zu", n,
				       b->record_at[n], place, all);
		ret = check_record(at, b, n, all - place, &bytes);
		if (ret < 0)
			return ret;
		place += bytes;
	}
	return place == all ? 0 : DAMAGED(at, "columns take %zu bytes, expected %zu", place, all);
}

static int check_block(const struct block_place *at, const struct basis_block *b,
		       const struct basis_layout *layout, const uint8_t *payload)
{
	const size_t record_bytes = at->chunk->entries[at->index].record_bytes;
	int ret = check_padding(at, b, layout, record_bytes, payload);

	if (ret == 0)
		ret = check_lights(at, b);
	if (ret == 0)
		ret = check_column_scales(at, b);
	if (ret == 0)
		ret = check_patterns(at, b);
	if (ret == 0)
		ret = check_lines(at, b, layout);
	return ret < 0 || !b->record ? ret : check_records(at, b, record_bytes);
}

static int layer_allocate(const struct basis *basis, struct basis_layer *layer, size_t blocks)
{
	const size_t across = (size_t)basis->tiles_across, down = (size_t)basis->tiles_down;

	layer->tiles = calloc(across * down, sizeof(*layer->tiles));
	layer->blocks = calloc(blocks ? blocks : 1, sizeof(*layer->blocks));
	if (!layer->tiles || !layer->blocks)
		return -ENOMEM;
	for (size_t t = 0; t < across * down; t++) {
		struct basis_tile *tile = &layer->tiles[t];
		const int x = (int)(t % across) * BASIS_TILE, y = (int)(t / across) * BASIS_TILE;
		const int right = (int)basis->info.width - x, below = (int)basis->info.height - y;

		tile->x = x;
		tile->y = y;
		tile->width = right < BASIS_TILE ? right : BASIS_TILE;
		tile->height = below < BASIS_TILE ? below : BASIS_TILE;
	}
	return 0;
}

static int read_block(const struct block_place *at, struct basis_layer *layer, uint64_t free_from,
		      struct tile_use *use)
{
	const struct basis_block_entry *e = &at->chunk->entries[at->index];
	struct basis_block *b = &layer->blocks[at->index];
	struct basis_layout layout;
	const uint8_t *payload;
	struct basis_tile *tile;
	int ret = check_shape(at, e);

	if (ret == 0)
		ret = check_lies(at, e, free_from);
	if (ret < 0)
		return ret;
	layout = basis_layout(e, (int)at->reader->basis->info.coarse);
	payload = at->chunk->data + e->offset;
	block_locate(b, e, &layout, payload);
	tile = &layer->tiles[e->tile];
	if (at->index && e->tile != e[-1].tile) {
		ret = check_pairs(at, use, e[-1].tile);
		memset(use, 0, sizeof(*use));
	}
	if (ret == 0)
		ret = check_pixels(at, b, tile, use);
	if (ret == 0)
		ret = check_block(at, b, &layout, payload);
	if (!tile->block_count)
		tile->blocks = b;
	tile->block_count++;
	tile->bytes += b->bytes;
	return ret;
}

int basis_read_blocks(const struct basis_reader *reader, const struct basis_blocks_chunk *chunk,
		      struct basis_layer *layer)
{
	struct block_place at = {reader, chunk, 0};
	struct tile_use use = {0};
	uint64_t end = 0;
	int ret = layer_allocate(reader->basis, layer, chunk->count);

	if (ret < 0)
		return fault_say(reader->fault, ret, "%s: out of memory", reader->name);
	for (; at.index < chunk->count; at.index++) {
		ret = read_block(&at, layer, end, &use);
		if (ret < 0)
			return ret;
		end = chunk->entries[at.index].offset + chunk->entries[at.index].bytes;
	}
	layer->block_count = (int)chunk->count;
	if (!basis_all_zero(chunk->data + end, chunk->data + chunk->data_bytes))
		return DAMAGED(&at, "bytes after the last block are not %d", 0);
	return chunk->count ? check_pairs(&at, &use, chunk->entries[chunk->count - 1].tile) : 0;
}

/* Returns a basis whose picture is this one tile. */
static struct basis shell_of_tile(const struct basis_info_chunk *info, int tile)
{
	const int across = ((int)info->width + BASIS_TILE - 1) / BASIS_TILE;
	const int right = (int)info->width - tile % across * BASIS_TILE;
	const int below = (int)info->height - tile / across * BASIS_TILE;
	struct basis shell = {.info = *info, .tiles_across = 1, .tiles_down = 1};

	shell.info.width = (uint32_t)(right < BASIS_TILE ? right : BASIS_TILE);
	shell.info.height = (uint32_t)(below < BASIS_TILE ? below : BASIS_TILE);
	return shell;
}

int basis_check_tile(const struct basis_info_chunk *info, int tile, bool exact,
		     const struct basis_block_payload *blocks, int count)
{
	struct basis shell = shell_of_tile(info, tile);
	const struct basis_reader reader = {.basis = &shell, .name = ""};
	struct basis_block_entry *entries = calloc((size_t)count + 1, sizeof(*entries));
	struct basis_blocks_chunk chunk = {
		.entries = entries, .count = (size_t)count, .exact = exact};
	struct basis_layer layer = {.tiles = NULL};
	int ret = -ENOMEM;

	if (!entries)
		return ret;
	/* not NULL even without blocks: adding to NULL is undefined */
	chunk.data = count ? blocks[0].payload : (const uint8_t *)entries;
	for (int k = 0; k < count; k++) {
		entries[k] = blocks[k].entry;
		entries[k].tile = 0;
		entries[k].offset = chunk.data_bytes;
		chunk.data_bytes += entries[k].bytes;
	}
	ret = basis_read_blocks(&reader, &chunk, &layer);
	free(layer.tiles);
	free(layer.blocks);
	free(entries);
	return ret;
}
