/* The blocks of a basis file: every number is checked here, once, so that nobody need later. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_reader.h"

#define TILE_PIXELS (BASIS_TILE * BASIS_TILE)

static const char *const kind_names[] = {"T", "V", "D", "U"};

/* What earlier blocks of the same tile have taken. */
struct tile_use {
	bool object[TILE_PIXELS];   /* has a T row */
	bool receiver[TILE_PIXELS]; /* has a V or a D row */
};

/* For messages: which block of which pose. */
struct place {
	const struct basis_reader *reader;
	int pose;
	size_t index;
};

#define DAMAGED(place, format, ...)                                                                \
	basis_damaged((place)->reader, "pose %d, block %zu: " format, (place)->pose,               \
		      (place)->index, __VA_ARGS__)

bool basis_all_zero(const uint8_t *from, const uint8_t *to)
{
	uint8_t any = 0;

	while (from < to)
		any |= *from++;
	return any == 0;
}

static int check_entry(const struct place *at, const struct basis_block_entry *e,
		       const struct basis_blocks_chunk *chunk, uint64_t free_from)
{
	const struct basis *basis = at->reader->basis;
	const uint32_t tiles = (uint32_t)basis->tiles_across * (uint32_t)basis->tiles_down;
	uint64_t expected;

	if (e->tile >= tiles)
		return DAMAGED(at, "tile %u, expected less than %u", e->tile, tiles);
	if (e->kind >= BASIS_KIND_COUNT)
		return DAMAGED(at, "kind %u, expected less than %d", e->kind, BASIS_KIND_COUNT);
	if (e->encoding != BASIS_ENCODING_DENSE)
		return DAMAGED(at, "encoding %u, expected %d", e->encoding, BASIS_ENCODING_DENSE);
	if (e->pixels < 1 || e->pixels > TILE_PIXELS)
		return DAMAGED(at, "%u pixels, expected 1 to %d", e->pixels, TILE_PIXELS);
	if (e->channels != 1 && e->channels != 3)
		return DAMAGED(at, "%u channels, expected 1 or 3", e->channels);
	if (e->lights < 1 || e->lights > basis->info.lights)
		return DAMAGED(at, "%u lights, expected 1 to %u", e->lights, basis->info.lights);
	if (e->kind == BASIS_KIND_V ? e->ground >= basis->info.grounds : e->ground != 0)
		return DAMAGED(at, "ground term %u, expected %s %u", e->ground,
			       e->kind == BASIS_KIND_V ? "less than" : "0 in a file of",
			       basis->info.grounds);
	if (e->reserved)
		return DAMAGED(at, "reserved field is %u, expected 0", e->reserved);
	expected = basis_layout(e->kind, e->pixels, e->channels, (int)e->lights).bytes;
	if (e->bytes != expected)
		return DAMAGED(at, "%llu bytes, expected %llu", (unsigned long long)e->bytes,
			       (unsigned long long)expected);
	if (e->offset % BASIS_ALIGN || e->offset < free_from || e->offset > chunk->data_bytes ||
	    e->bytes > chunk->data_bytes - e->offset)
		return DAMAGED(at,
			       "lies at byte %llu, expected a multiple of %d after the block "
			       "before it and inside the chunk of %zu bytes",
			       (unsigned long long)e->offset, BASIS_ALIGN, chunk->data_bytes);
	if (!basis_all_zero(chunk->data + free_from, chunk->data + e->offset))
		return DAMAGED(at, "bytes before it are not %d", 0);
	return 0;
}

static void locate(struct basis_block *b, const struct basis_block_entry *e, const uint8_t *payload)
{
	const struct basis_layout layout = basis_layout(e->kind, e->pixels, e->channels,
							(int)e->lights);
	/* Aligned by the layout, as check_entry() has seen. */
	const void *pixel = payload + layout.pixel, *light = payload + layout.light;
	const void *scale = payload + layout.scale, *total = payload + layout.total;
	const void *row = payload + layout.row;

	*b = (struct basis_block){
		.kind = e->kind,
		.encoding = e->encoding,
		.pixels = e->pixels,
		.channels = e->channels,
		.lights = (int)e->lights,
		.stride = layout.stride,
		.ground = (int)e->ground,
		.pixel = pixel,
		.light = light,
		.scale = scale,
		.total = total,
		.row = row,
		.bytes = layout.bytes,
	};
}

static int check_padding(const struct place *at, const struct basis_block *b,
			 const uint8_t *payload)
{
	const struct basis_layout layout = basis_layout(b->kind, b->pixels, b->channels, b->lights);
	const size_t rows = (size_t)b->pixels * (size_t)b->channels;
	const size_t totals = (size_t)b->pixels * (size_t)layout.total_channels;

	if (!basis_all_zero((const uint8_t *)(b->pixel + b->pixels), payload + layout.light) ||
	    !basis_all_zero((const uint8_t *)(b->light + b->lights), payload + layout.scale) ||
	    !basis_all_zero((const uint8_t *)(b->scale + rows), payload + layout.total) ||
	    !basis_all_zero((const uint8_t *)(b->total + totals), payload + layout.row))
		return DAMAGED(at, "padding between arrays is not %d", 0);
	return 0;
}

static int check_lists(const struct place *at, struct basis_block *b, const struct basis_tile *tile,
		       struct tile_use *use)
{
	const uint32_t lights = at->reader->basis->info.lights;

	b->rest = b->kind == BASIS_KIND_V && b->light[b->lights - 1] == lights;
	for (int i = 0; i < b->lights - b->rest; i++) {
		if (b->light[i] >= lights || (i && b->light[i] <= b->light[i - 1]))
			return DAMAGED(at, "light %u, expected ascending numbers below %u%s",
				       b->light[i], lights,
				       b->kind == BASIS_KIND_V ? ", or that as the last" : "");
	}
	for (int p = 0; p < b->pixels; p++) {
		const int pixel = b->pixel[p];
		bool *taken;

		if (pixel % BASIS_TILE >= tile->width || pixel / BASIS_TILE >= tile->height ||
		    (p && pixel <= b->pixel[p - 1]))
			return DAMAGED(at,
				       "pixel %d, expected ascending numbers inside a tile of "
				       "%dx%d pixels",
				       pixel, tile->width, tile->height);
		if (b->kind == BASIS_KIND_U)
			continue; /* the same pixels as its D block */
		taken = b->kind == BASIS_KIND_T ? &use->object[pixel] : &use->receiver[pixel];
		if (*taken)
			return DAMAGED(at, "pixel %d has a row of its kind already", pixel);
		*taken = true;
	}
	return 0;
}

/* Every D is followed by the U of its pixels, and every U follows one. */
static int check_pair(const struct place *at, const struct basis_block *before,
		      uint32_t tile_before, const struct basis_block *b, uint32_t tile)
{
	const bool owed = before && before->kind == BASIS_KIND_D;

	if (!b ? owed : owed != (b->kind == BASIS_KIND_U))
		return DAMAGED(at, "kind %s%s", b ? kind_names[b->kind] : "none",
			       owed ? ", expected U after a D block" : " without a D block before");
	if (b && owed &&
	    (tile != tile_before || b->pixels != before->pixels ||
	     memcmp(b->pixel, before->pixel, (size_t)b->pixels * sizeof(*b->pixel)) != 0))
		return DAMAGED(at, "its %d pixels are not those of the D block before", b->pixels);
	return 0;
}

/* A ground term as a block lists it, and its sum over all lights. */
struct ground_terms {
	double *listed[3]; /* of each of the block's lights, the rest's at the end; room for all */
	double sum[3];
};

static void list_ground(const struct basis *basis, const struct basis_block *b,
			struct ground_terms *terms)
{
	const int listed = b->lights - b->rest;

	for (int c = 0; c < 3; c++) {
		const double *u = basis_ground(basis, b->ground, c);
		double sum = 0, sum_listed = 0;

		for (uint32_t i = 0; i < basis->info.lights; i++)
			sum += u[i];
		for (int i = 0; i < listed; i++) {
			terms->listed[c][i] = u[b->light[i]];
			sum_listed += u[b->light[i]];
		}
		if (b->rest)
			terms->listed[c][listed] = fmax(sum - sum_listed, 0);
		terms->sum[c] = sum;
	}
}

/* Most of the time that opening a file takes goes here: sums side by side can be vectors. */
static double dot(const int16_t *row, const double *terms, int count)
{
	double sums[8] = {0}, sum = 0;
	int i = 0;

	for (; i + 8 <= count; i += 8) {
		for (int k = 0; k < 8; k++)
			sums[k] += row[i + k] * terms[i + k];
	}
	for (; i < count; i++)
		sum += row[i] * terms[i];
	for (int k = 0; k < 8; k++)
		sum += sums[k];
	return sum;
}

/* round(2^15 * sum row u / sum u), to within the rounding of another machine's sum. */
static int check_ground_total(const struct place *at, const struct basis_block *b, int p,
			      const struct ground_terms *terms)
{
	for (int c = 0; c < 3; c++) {
		const int row = p * b->channels + (b->channels == 3 ? c : 0);
		const int16_t *r = b->row + (size_t)row * (size_t)b->stride;
		const int32_t total = b->total[p * 3 + c];
		const double sum = dot(r, terms->listed[c], b->lights);
		const double expected = terms->sum[c] > 0 ? 32768 * (sum / terms->sum[c]) : 0;

		if (!(fabs(total - expected) <= 0.51))
			return DAMAGED(at, "total %d of pixel %d, expected %.2f", total,
				       b->pixel[p], expected);
	}
	return 0;
}

static int check_row(const struct place *at, const struct basis_block *b, int row, int32_t *sum)
{
	const int16_t *r = b->row + (size_t)row * (size_t)b->stride;
	int32_t total = 0;
	int16_t least = 0;

	if (!isfinite(b->scale[row]) || signbit(b->scale[row]))
		return DAMAGED(at, "scale %g of row %d, expected a finite number, 0 or more",
			       (double)b->scale[row], row);
	for (int i = 0; i < b->lights; i++) {
		total += r[i];
		least = r[i] < least ? r[i] : least;
	}
	if (least < (b->kind == BASIS_KIND_U ? 0 : -INT16_MAX))
		return DAMAGED(at, "value %d in row %d, expected at least %d", least, row,
			       b->kind == BASIS_KIND_U ? 0 : -INT16_MAX);
	if (!basis_all_zero((const uint8_t *)(r + b->lights), (const uint8_t *)(r + b->stride)))
		return DAMAGED(at, "padding of row %d is not 0", row);
	*sum = total;
	return 0;
}

static int check_rows(const struct place *at, const struct basis_block *b,
		      struct ground_terms *terms)
{
	int32_t total = 0;
	int ret;

	for (int row = 0; row < b->pixels * b->channels; row++) {
		ret = check_row(at, b, row, &total);
		if (ret < 0)
			return ret;
		if (b->kind != BASIS_KIND_V && b->total[row] != total)
			return DAMAGED(at, "total %d of row %d, expected %d", b->total[row], row,
				       total);
	}
	if (b->kind != BASIS_KIND_V)
		return 0;
	list_ground(at->reader->basis, b, terms);
	for (int p = 0; p < b->pixels; p++) {
		ret = check_ground_total(at, b, p, terms);
		if (ret < 0)
			return ret;
	}
	return 0;
}

static int allocate(struct basis *basis, struct basis_pose *pose, size_t blocks)
{
	const size_t across = (size_t)basis->tiles_across, down = (size_t)basis->tiles_down;

	pose->tiles = calloc(across * down, sizeof(*pose->tiles));
	pose->blocks = calloc(blocks ? blocks : 1, sizeof(*pose->blocks));
	if (!pose->tiles || !pose->blocks)
		return -ENOMEM;
	for (size_t t = 0; t < across * down; t++) {
		struct basis_tile *tile = &pose->tiles[t];
		const int x = (int)(t % across) * BASIS_TILE, y = (int)(t / across) * BASIS_TILE;
		const int right = (int)basis->info.width - x, below = (int)basis->info.height - y;

		tile->x = x;
		tile->y = y;
		tile->width = right < BASIS_TILE ? right : BASIS_TILE;
		tile->height = below < BASIS_TILE ? below : BASIS_TILE;
	}
	return 0;
}

static int read_blocks(const struct basis_reader *reader, int pose_index,
		       const struct basis_blocks_chunk *chunk, struct ground_terms *terms)
{
	struct basis_pose *pose = &reader->basis->poses[pose_index];
	struct place at = {reader, pose_index, 0};
	struct tile_use use = {0};
	uint32_t tile_before = 0;
	uint64_t end = 0;
	int ret = allocate(reader->basis, pose, chunk->count);

	if (ret < 0)
		return fault_say(reader->fault, ret, "%s: out of memory", reader->name);
	for (; at.index < chunk->count; at.index++) {
		const struct basis_block_entry *e = &chunk->entries[at.index];
		struct basis_block *b = &pose->blocks[at.index];
		struct basis_tile *tile;

		ret = check_entry(&at, e, chunk, end);
		if (ret < 0)
			return ret;
		if (e->tile < tile_before)
			return DAMAGED(&at, "tile %u after tile %u, expected ascending tiles",
				       e->tile, tile_before);
		locate(b, e, chunk->data + e->offset);
		tile = &pose->tiles[e->tile];
		if (e->tile != tile_before)
			memset(&use, 0, sizeof(use));
		ret = check_padding(&at, b, chunk->data + e->offset);
		if (ret == 0)
			ret = check_pair(&at, at.index ? b - 1 : NULL, tile_before, b, e->tile);
		if (ret == 0)
			ret = check_lists(&at, b, tile, &use);
		if (ret == 0)
			ret = check_rows(&at, b, terms);
		if (ret < 0)
			return ret;
		if (!tile->block_count)
			tile->blocks = b;
		tile->block_count++;
		tile->bytes += b->bytes;
		tile_before = e->tile;
		end = e->offset + e->bytes;
	}
	if (!basis_all_zero(chunk->data + end, chunk->data + chunk->data_bytes))
		return DAMAGED(&at, "bytes after the last block are not %d", 0);
	pose->block_count = (int)chunk->count;
	return check_pair(&at, chunk->count ? &pose->blocks[chunk->count - 1] : NULL, tile_before,
			  NULL, 0);
}

int basis_read_blocks(const struct basis_reader *reader, int pose_index,
		      const struct basis_blocks_chunk *chunk)
{
	const size_t room = (size_t)reader->basis->info.lights + 1;
	double *memory = calloc(3 * room, sizeof(*memory));
	struct ground_terms terms;
	int ret;

	if (!memory)
		return fault_say(reader->fault, -ENOMEM, "%s: out of memory", reader->name);
	for (int c = 0; c < 3; c++)
		terms.listed[c] = memory + (size_t)c * room;
	ret = read_blocks(reader, pose_index, chunk, &terms);
	free(memory);
	return ret;
}
