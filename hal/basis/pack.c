/* SPDX-License-Identifier: MIT */
#include "hal/basis/pack.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <zstd.h>

#include "hal/basis/basis_blocks.h"
#include "hal/basis/basis_layout.h"
#include "hal/basis/basis_lines.h"

/* Lowest level at which zstd weighs each match against literals, which suits noisy data. Unpacking
 * is as fast as at other levels, and packing is a small part of a bake. */
#define LEVEL 16
/* Payloads of a part: enough for good compression, few enough to share the parts among threads. */
#define PART_BYTES ((size_t)1 << 20)
#define ROW BASIS_TILE

/* The streams of a part. */
enum stream {
	STREAM_REST,	/* lists and scales, unchanged */
	STREAM_HIGH,	/* upper bytes of 16-bit values */
	STREAM_LOW,	/* lower bytes of 16-bit values */
	STREAM_COLUMNS, /* records of 8-bit columns */
};

_Static_assert(STREAM_COLUMNS + 1 == BASIS_PACK_STREAMS, "streams of a part");

struct streams {
	uint8_t *at[BASIS_PACK_STREAMS];
	size_t bytes[BASIS_PACK_STREAMS];
};

/* ---- differences from neighbours, in zigzag form: small ones of either sign are small ---- */

static uint8_t fold8(int difference)
{
	const int8_t d = (int8_t)difference;

	return (uint8_t)(((unsigned)d << 1) ^ (unsigned)(d >> 7));
}

static int unfold8(uint8_t v)
{
	return (v >> 1) ^ -(v & 1);
}

static uint16_t fold16(int difference)
{
	const int16_t d = (int16_t)difference;

	return (uint16_t)(((unsigned)d << 1) ^ (unsigned)(d >> 15));
}

static int unfold16(uint16_t v)
{
	return (v >> 1) ^ -(v & 1);
}

/* One whole line of a column: differences from the left, at the start of a row from above. */
static void fold_column(const uint8_t *from, size_t count, uint8_t *to)
{
	to[0] = fold8(from[0]);
	for (size_t k = 1; k < count; k++)
		to[k] = fold8(from[k] - from[k % ROW ? k - 1 : k - ROW]);
}

static void unfold_column(const uint8_t *from, size_t count, uint8_t *to)
{
	int above = 0;

	for (size_t row = 0; row < count; row += ROW) {
		int left = above;

		for (size_t k = row; k < row + ROW; k++) {
			left += unfold8(from[k]);
			to[k] = (uint8_t)left;
		}
		above = (int8_t)to[row];
	}
}

static void fold_words(const int16_t *from, size_t count, bool differences, struct streams *to)
{
	int before = 0;

	for (size_t k = 0; k < count; k++) {
		const uint16_t v = fold16(from[k] - before);

		to->at[STREAM_HIGH][to->bytes[STREAM_HIGH]++] = (uint8_t)(v >> 8);
		to->at[STREAM_LOW][to->bytes[STREAM_LOW]++] = (uint8_t)v;
		before = differences ? from[k] : 0;
	}
}

static void unfold_words(struct streams *from, size_t count, bool differences, int16_t *to)
{
	const uint8_t *high = from->at[STREAM_HIGH] + from->bytes[STREAM_HIGH];
	const uint8_t *low = from->at[STREAM_LOW] + from->bytes[STREAM_LOW];
	int before = 0;

	for (size_t k = 0; k < count; k++) {
		to[k] = (int16_t)(before + unfold16((uint16_t)(high[k] << 8 | low[k])));
		before = differences ? to[k] : 0;
	}
	from->bytes[STREAM_HIGH] += count;
	from->bytes[STREAM_LOW] += count;
}

/* ---- one payload ---- */

/* Adds the number of bytes of each stream that a payload becomes. */
static void count_payload(const struct basis_block_entry *e, int coarse, size_t *bytes)
{
	const struct basis_layout at = basis_layout(e, coarse);
	const size_t columns = at.bytes - at.record;
	const size_t words = at.light - at.pattern + (e->bits == 16 ? columns : 0);

	bytes[STREAM_REST] += at.pattern + (at.column - at.light);
	bytes[STREAM_HIGH] += words / 2;
	bytes[STREAM_LOW] += words / 2;
	bytes[STREAM_COLUMNS] += e->bits == 8 ? columns : 0;
}

static void put_rest(struct streams *to, const uint8_t *from, size_t bytes)
{
	memcpy(to->at[STREAM_REST] + to->bytes[STREAM_REST], from, bytes);
	to->bytes[STREAM_REST] += bytes;
}

static void get_rest(struct streams *from, uint8_t *to, size_t bytes)
{
	memcpy(to, from->at[STREAM_REST] + from->bytes[STREAM_REST], bytes);
	from->bytes[STREAM_REST] += bytes;
}

/* Folds (place is NULL) or unfolds all records of a payload; only whole lines change. Unfolding
 * writes the offset of each record to place [columns]. Returns false if the codes lead beyond the
 * end. */
static bool turn_records(const struct basis_block_entry *e, const uint8_t *from, size_t bytes,
			 uint32_t *place, uint8_t *to)
{
	const int lines = basis_record_lines(e->pixels, e->channels);
	const size_t head = basis_record_head(lines);
	size_t at = 0;

	for (uint32_t n = 0; n < e->columns; n++) {
		const uint8_t *code = from + at;

		if (place)
			place[n] = (uint32_t)at;
		if (bytes - at < head || basis_record_bytes(code, lines) > bytes - at)
			return false;
		memcpy(to + at, from + at, head);
		at += head;
		for (int k = 0; k < lines; at += basis_line_bytes(code[k++])) {
			if (code[k] != BASIS_LINE_WHOLE)
				memcpy(to + at, from + at, basis_line_bytes(code[k]));
			else if (place)
				unfold_column(from + at, BASIS_LINE8, to + at);
			else
				fold_column(from + at, BASIS_LINE8, to + at);
		}
	}
	memcpy(to + at, from + at, bytes - at);
	return true;
}

static void fold_payload(const struct basis_block_entry *e, int coarse, const uint8_t *payload,
			 struct streams *to)
{
	const struct basis_layout at = basis_layout(e, coarse);
	const void *pattern = payload + at.pattern, *coefficient = payload + at.coefficient;
	const void *columns = payload + at.column;

	put_rest(to, payload, at.pattern);
	fold_words(pattern, (at.coefficient - at.pattern) / 2, false, to);
	fold_words(coefficient, (at.light - at.coefficient) / 2, true, to);
	put_rest(to, payload + at.light, at.column - at.light);
	if (e->bits == 16) {
		fold_words(columns, (at.bytes - at.record) / 2, true, to);
		return;
	}
	turn_records(e, payload + at.record, at.bytes - at.record, NULL,
		     to->at[STREAM_COLUMNS] + to->bytes[STREAM_COLUMNS]);
	to->bytes[STREAM_COLUMNS] += at.bytes - at.record;
}

/* -EBADMSG. */
static int unfold_payload(const struct basis_block_entry *e, int coarse, struct streams *from,
			  uint8_t *payload)
{
	const struct basis_layout at = basis_layout(e, coarse);
	void *pattern = payload + at.pattern, *coefficient = payload + at.coefficient;
	void *columns = payload + at.column;

	get_rest(from, payload, at.pattern);
	unfold_words(from, (at.coefficient - at.pattern) / 2, false, pattern);
	unfold_words(from, (at.light - at.coefficient) / 2, true, coefficient);
	get_rest(from, payload + at.light, at.column - at.light);
	memset(payload + at.column, 0, at.record - at.column);
	if (e->bits == 16) {
		unfold_words(from, (at.bytes - at.record) / 2, true, columns);
		return 0;
	}
	if (!turn_records(e, from->at[STREAM_COLUMNS] + from->bytes[STREAM_COLUMNS],
			  at.bytes - at.record, columns, payload + at.record))
		return -EBADMSG;
	from->bytes[STREAM_COLUMNS] += at.bytes - at.record;
	return 0;
}

/* ---- packing ---- */

struct buffer {
	uint8_t *data;
	size_t bytes, room;
};

struct packer {
	int coarse;
	struct basis_pack_part part; /* the current part */
	struct streams raw;
	size_t room[BASIS_PACK_STREAMS];
	uint64_t data_bytes;
	struct buffer parts, packed, chunk;
};

static int buffer_reserve(uint8_t **data, size_t *room, size_t wanted)
{
	size_t more = *room ? *room : (size_t)1 << 16;
	uint8_t *grown;

	if (wanted <= *room)
		return 0;
	while (more < wanted)
		more *= 2;
	grown = realloc(*data, more);
	if (!grown)
		return -ENOMEM;
	*data = grown;
	*room = more;
	return 0;
}

static int buffer_append(struct buffer *to, const void *from, size_t bytes)
{
	const int ret = buffer_reserve(&to->data, &to->room, to->bytes + bytes);

	if (ret == 0 && bytes)
		memcpy(to->data + to->bytes, from, bytes);
	to->bytes += ret == 0 ? bytes : 0;
	return ret;
}

/* Sets *packed to the compressed length. -ENOMEM. */
static int buffer_compress(struct buffer *to, const void *from, size_t bytes, uint32_t *packed)
{
	const size_t most = ZSTD_compressBound(bytes);
	size_t done;
	const int ret = buffer_reserve(&to->data, &to->room, to->bytes + most);

	if (ret < 0)
		return ret;
	done = ZSTD_compress(to->data + to->bytes, most, from, bytes, LEVEL);
	if (ZSTD_isError(done) || done > UINT32_MAX)
		return -ENOMEM;
	to->bytes += done;
	*packed = (uint32_t)done;
	return 0;
}

static int end_part(struct packer *p)
{
	int ret = 0;

	if (!p->part.blocks)
		return 0;
	for (int s = 0; s < BASIS_PACK_STREAMS && ret == 0; s++) {
		p->part.bytes[s] = 0;
		if (p->raw.bytes[s])
			ret = buffer_compress(&p->packed, p->raw.at[s], p->raw.bytes[s],
					      &p->part.bytes[s]);
		p->raw.bytes[s] = 0;
	}
	if (ret == 0)
		ret = buffer_append(&p->parts, &p->part, sizeof(p->part));
	p->part = (struct basis_pack_part){.blocks = 0};
	return ret;
}

int packer_create(struct packer **packer, int coarse)
{
	*packer = calloc(1, sizeof(**packer));
	if (!*packer)
		return -ENOMEM;
	(*packer)->coarse = coarse;
	return 0;
}

int packer_add(struct packer *p, const struct basis_block_entry *entry, const void *payload)
{
	size_t wanted[BASIS_PACK_STREAMS], sum = 0;
	int ret = 0;

	memcpy(wanted, p->raw.bytes, sizeof(wanted));
	count_payload(entry, p->coarse, wanted);
	for (int s = 0; s < BASIS_PACK_STREAMS && ret == 0; s++) {
		ret = buffer_reserve(&p->raw.at[s], &p->room[s], wanted[s]);
		sum += wanted[s];
	}
	if (ret < 0)
		return ret;
	fold_payload(entry, p->coarse, payload, &p->raw);
	p->part.blocks++;
	p->data_bytes += entry->bytes;
	return sum < PART_BYTES ? 0 : end_part(p);
}

int packer_finish(struct packer *p, const uint16_t *coverage, size_t pixels, const void **chunk,
		  size_t *bytes)
{
	struct basis_pack head = {.data_bytes = p->data_bytes};
	struct buffer cover = {.data = NULL};
	int ret = end_part(p);

	if (ret == 0)
		ret = buffer_compress(&cover, coverage, pixels * sizeof(*coverage),
				      &head.coverage_bytes);
	head.parts = (uint32_t)(p->parts.bytes / sizeof(struct basis_pack_part));
	p->chunk.bytes = 0;
	if (ret == 0)
		ret = buffer_append(&p->chunk, &head, sizeof(head));
	if (ret == 0)
		ret = buffer_append(&p->chunk, p->parts.data, p->parts.bytes);
	if (ret == 0)
		ret = buffer_append(&p->chunk, cover.data, cover.bytes);
	if (ret == 0)
		ret = buffer_append(&p->chunk, p->packed.data, p->packed.bytes);
	free(cover.data);
	p->data_bytes = 0;
	p->parts.bytes = p->packed.bytes = 0;
	*chunk = p->chunk.data;
	*bytes = p->chunk.bytes;
	return ret;
}

void packer_destroy(struct packer *p)
{
	if (!p)
		return;
	for (int s = 0; s < BASIS_PACK_STREAMS; s++)
		free(p->raw.at[s]);
	free(p->parts.data);
	free(p->packed.data);
	free(p->chunk.data);
	free(p);
}

/* ---- unpacking ---- */

/* First block of a part, and the start of its streams. */
struct pack_place {
	size_t block;
	const uint8_t *at;
};

static int place_parts(struct pack *pack, const struct basis_reader *reader, const uint8_t *at,
		       const uint8_t *end, size_t blocks)
{
	size_t block = 0;

	for (int k = 0; k < pack->parts; k++) {
		const struct basis_pack_part *part = &pack->part[k];

		pack->place[k] = (struct pack_place){block, at};
		if (part->blocks < 1 || part->blocks > blocks - block || part->reserved)
			return basis_damaged(
				reader,
				"part %d of a pose holds %u blocks, expected 1 or more of the %zu that are left",
				k, part->blocks, blocks - block);
		block += part->blocks;
		for (int s = 0; s < BASIS_PACK_STREAMS; s++) {
			if (part->bytes[s] > (size_t)(end - at))
				return basis_damaged(
					reader, "part %d of a pose is longer than its chunk", k);
			at += part->bytes[s];
		}
	}
	if (block != blocks || at != end)
		return basis_damaged(
			reader,
			"parts of a pose hold %zu blocks and leave %zu bytes, expected %zu and 0",
			block, (size_t)(end - at), blocks);
	return 0;
}

int pack_open(struct pack *pack, const struct basis_reader *reader, const void *chunk, size_t bytes,
	      const struct basis_blocks_chunk *blocks)
{
	const struct basis_pack *head = chunk;
	const uint8_t *at = chunk, *end = at + bytes;
	int ret;

	*pack = (struct pack){.entries = blocks->entries,
			      .coarse = (int)reader->basis->info.coarse};
	if (bytes < sizeof(*head) ||
	    head->parts > (bytes - sizeof(*head)) / sizeof(struct basis_pack_part) ||
	    head->coverage_bytes >
		    bytes - sizeof(*head) - head->parts * sizeof(struct basis_pack_part) ||
	    head->data_bytes != blocks->data_bytes)
		return basis_damaged(
			reader,
			"PACK chunk of pose %d, expected a table, and payloads of %zu bytes",
			blocks->pose, blocks->data_bytes);
	if (basis_is_bomb(head->data_bytes, bytes))
		return basis_damaged(
			reader,
			"PACK chunk of pose %d, %zu bytes, unpacks to %zu, expected at most %d times as many",
			blocks->pose, bytes, blocks->data_bytes, BASIS_MADE_TIMES);
	pack->parts = (int)head->parts;
	pack->part = (const void *)(at + sizeof(*head));
	pack->data_bytes = head->data_bytes;
	pack->coverage = (const uint8_t *)(pack->part + pack->parts);
	pack->coverage_bytes = head->coverage_bytes;
	pack->place = calloc((size_t)pack->parts + 1, sizeof(*pack->place));
	if (!pack->place)
		return fault_say(reader->fault, -ENOMEM, "%s: out of memory", reader->name);
	ret = place_parts(pack, reader, pack->coverage + pack->coverage_bytes, end, blocks->count);
	if (ret < 0)
		pack_close(pack);
	return ret;
}

void pack_close(struct pack *pack)
{
	free(pack->place);
	*pack = (struct pack){.parts = 0};
}

static int zstd_expand(void *to, size_t bytes, const void *from, size_t packed)
{
	if (!bytes)
		return packed ? -EBADMSG : 0;
	return ZSTD_decompress(to, bytes, from, packed) == bytes ? 0 : -EBADMSG;
}

int pack_coverage(const struct pack *pack, uint16_t *coverage, size_t pixels)
{
	return zstd_expand(coverage, pixels * sizeof(*coverage), pack->coverage,
			   pack->coverage_bytes);
}

int pack_unpack(const struct pack *pack, int part, uint8_t *data)
{
	const struct pack_place *place = &pack->place[part];
	const struct basis_block_entry *e = pack->entries + place->block;
	const uint8_t *packed = place->at;
	struct streams raw = {.bytes = {0}};
	size_t bytes[BASIS_PACK_STREAMS] = {0}, all = 0;
	uint8_t *memory;
	int ret = 0;

	for (uint32_t b = 0; b < pack->part[part].blocks; b++)
		count_payload(&e[b], pack->coarse, bytes);
	for (int s = 0; s < BASIS_PACK_STREAMS; s++)
		all += bytes[s];
	memory = malloc(all + 1);
	if (!memory)
		return -ENOMEM;
	all = 0;
	for (int s = 0; s < BASIS_PACK_STREAMS && ret == 0; s++) {
		raw.at[s] = memory + all;
		ret = zstd_expand(raw.at[s], bytes[s], packed, pack->part[part].bytes[s]);
		packed += pack->part[part].bytes[s];
		all += bytes[s];
	}
	for (uint32_t b = 0; ret == 0 && b < pack->part[part].blocks; b++)
		ret = unfold_payload(&e[b], pack->coarse, &raw, data + e[b].offset);
	free(memory);
	return ret;
}
