/* SPDX-License-Identifier: MIT */
/* A shard is read as it was written. One with a wrong number in it, but right checksums, is refused
 * before that number is used. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <errno.h>

#include "tests/support/basis/copied_basis.h"

#include "bake/tiles/shard.h"
#include "bake/tiles/shard_format.h"
#include "tests/support/bake/reseal_shard.h"
#include "tests/support/chance.h"
#include "tests/support/test.h"

struct shard_sample {
	char folder[64], path[80];
	struct copied whole, c; /* a test changes c and restores it */
	struct shard_header *header;
	struct shard_record *record; /* record of the first tile */
	struct tile_account *account;
	struct basis_block_entry *entry; /* its first entry */
};

/* ---- a shard of a synthetic file's blocks ---- */

static int take_layer(const struct copied *file, bool exact, int tile,
		      struct basis_block_payload *to)
{
	const uint32_t list = exact ? BASIS_CHUNK_EXACT_BLOCKS : BASIS_CHUNK_BLOCKS;
	const struct basis_block_entry *e = copied_data(file, list);
	const size_t all = copied_chunk(file, list)->bytes / sizeof(*e);
	const uint8_t *data = copied_data(file, exact ? BASIS_CHUNK_EXACT_DATA : BASIS_CHUNK_DATA);
	int count = 0;

	for (size_t k = 0; k < all; k++)
		if (e[k].tile == (uint32_t)tile)
			to[count++] = (struct basis_block_payload){e[k], data + e[k].offset};
	return count;
}

static void add_tile(struct shard_writer *writer, const struct copied *file, int number)
{
	struct basis_block_payload blocks[64];
	struct finished_tile tile = {.tile = number, .blocks = blocks};
	struct fault fault = {""};

	tile.shown = take_layer(file, false, number, blocks);
	tile.exact = take_layer(file, true, number, blocks + tile.shown);
	assert_in_range(tile.exact, 1, 32);
	synthetic_must(shard_writer_add(writer, &tile, &fault), &fault);
}

static const struct basis_footprint sample_foot = {
	.corner = {-1, 2}, .side = 0.5F, .row = {[3] = 5}};

static void write_sample(const struct shard_sample *sample)
{
	const struct shard_place place = {0, 1};
	struct synthetic s;
	struct copied file;
	struct plan plan = {.light = NULL};
	struct shard_writer *writer;
	struct fault fault = {""};

	synthetic_open(&s, &copied_small);
	file = copied_file(s.path);
	plan.info = s.basis.info;
	plan.light = copied_data(&file, BASIS_CHUNK_DOME);
	plan.ground = copied_data(&file, BASIS_CHUNK_GROUND);
	plan.gather = copied_data(&file, BASIS_CHUNK_COARSE);
	synthetic_must(shard_writer_open(&writer, &plan, &place, sample->path, &fault), &fault);
	for (int tile = 0; tile < plan_tiles(&plan); tile++)
		add_tile(writer, &file, tile);
	synthetic_must(shard_writer_pose_end(writer, s.basis.poses[0].peak, &sample_foot, &fault),
		       &fault);
	synthetic_must(shard_writer_finish(writer, &fault), &fault);
	copied_free(&file);
	synthetic_close(&s);
}

static int setup(void **state)
{
	static struct shard_sample sample;
	uint8_t *at;
	size_t n;

	snprintf(sample.folder, sizeof(sample.folder), "/tmp/inlay-shard-XXXXXX");
	assert_non_null(mkdtemp(sample.folder));
	snprintf(sample.path, sizeof(sample.path), "%s/a.shard", sample.folder);
	write_sample(&sample);
	sample.whole = copied_file(sample.path);
	sample.c = copied_file(sample.path);
	at = sample.c.data;
	sample.header = (struct shard_header *)at;
	n = sample.header->info.lights;
	at += sizeof(*sample.header) + n * sizeof(struct basis_light) +
	      3 * n * sample.header->info.grounds * sizeof(double) +
	      n * sizeof(struct basis_coarse) + 2 * (size_t)PLAN_TEXT_MAX;
	sample.record = (struct shard_record *)at;
	sample.account = (struct tile_account *)(at + sizeof(*sample.record));
	sample.entry = (struct basis_block_entry *)(sample.account + 1);
	*state = &sample;
	return 0;
}

static int teardown(void **state)
{
	struct shard_sample *sample = *state;

	copied_free(&sample->whole);
	copied_free(&sample->c);
	unlink(sample->path);
	return rmdir(sample->folder);
}

/* ---- reading ---- */

/* Repairs the checksums of the changed shard and reads all of it. 0, or the error of the reader. */
static int read_changed(const struct shard_sample *sample, struct fault *fault)
{
	FILE *out = fopen(sample->path, "wb");
	struct finished_tile tile;
	struct shard shard;
	int next;

	reseal_shard(sample->c.data, sample->c.bytes);
	assert_non_null(out);
	assert_int_equal(fwrite(sample->c.data, 1, sample->c.bytes, out), sample->c.bytes);
	assert_int_equal(fclose(out), 0);
	fault->text[0] = '\0';
	next = shard_open(&shard, sample->path, fault);
	for (uint32_t pose = 0; next == 0 && pose < shard.plan.info.poses; pose++) {
		while ((next = shard_next(&shard, &tile, fault)) == 1)
			finished_tile_free(&tile);
	}
	shard_close(&shard);
	memcpy(sample->c.data, sample->whole.data, sample->whole.bytes);
	return next;
}

TEST("comes back")
{
	const struct shard_sample *sample = *state;
	struct fault fault = {""};
	struct finished_tile tile;
	struct shard shard;

	assert_int_equal(read_changed(sample, &fault), 0);
	synthetic_must(shard_open(&shard, sample->path, &fault), &fault);
	assert_int_equal(shard_next(&shard, &tile, &fault), 1);
	assert_int_equal(tile.shown, sample->record->shown);
	assert_int_equal(tile.exact, sample->record->exact);
	for (int k = 0; k < tile.shown + tile.exact; k++)
		assert_memory_equal(&tile.blocks[k].entry, &sample->entry[k],
				    sizeof(*sample->entry));
	assert_memory_equal(tile.blocks[0].payload, sample->entry + tile.shown + tile.exact,
			    sample->entry->bytes);
	finished_tile_free(&tile);
	while (shard_next(&shard, &tile, &fault) == 1)
		finished_tile_free(&tile);
	assert_memory_equal(&shard.foot, &sample_foot, sizeof(sample_foot));
	shard_close(&shard);
}

#define REFUSED(change)                                                                            \
	do {                                                                                       \
		change;                                                                            \
		if (read_changed(s, &fault) != -EBADMSG)                                           \
			fail_msg("accepted: %s", #change);                                         \
		assert_memory_equal(fault.text, s->path, strlen(s->path));                         \
	} while (0)

TEST("refuses wrong numbers")
{
	struct shard_sample *s = *state;
	struct basis_block_entry *last = s->entry + s->record->shown + s->record->exact - 1;
	struct fault fault;

	REFUSED(s->header->info.lights = BASIS_LIGHTS_MAX);
	REFUSED(s->header->info.grounds = BASIS_GROUNDS_MAX);
	REFUSED(s->header->info.width = 0);
	REFUSED(s->header->info.poses = 2);
	REFUSED(s->header->has_gather = 0);
	REFUSED((s->header->info.poses = BASIS_POSES_MAX, s->header->has_names = 1));
	REFUSED(s->record->bytes = UINT64_MAX);
	REFUSED(s->record->bytes -= 1);
	REFUSED(s->record->shown = UINT32_MAX);
	REFUSED((s->record->shown = UINT32_MAX, s->record->exact = 1));
	REFUSED((s->record->shown += 1, s->record->exact -= 1));
	REFUSED(s->record->glass = UINT32_MAX);
	REFUSED(s->record->glass = 1);
	REFUSED(s->record->tile = 1);
	REFUSED(s->record->pose = 1);
	REFUSED(s->account->noise_count = INT64_MAX);
	REFUSED(s->entry->columns = 0xfffffff0);
	REFUSED(s->entry->columns += 1);
	REFUSED(s->entry->patterns = UINT16_MAX);
	REFUSED(s->entry->patterns += 1);
	REFUSED(s->entry->pixels = UINT16_MAX);
	REFUSED(s->entry->record_bytes = UINT32_MAX);
	REFUSED(s->entry->record_bytes -= 4);
	REFUSED(s->entry->channels = 2);
	REFUSED(s->entry->bits = 4);
	REFUSED(s->entry->kind = 9);
	REFUSED(s->entry->tinted = 1);
	REFUSED(s->entry->ground = 7);
	REFUSED(s->entry->cut_share = 0);
	REFUSED(s->entry->cut_share = 2);
	REFUSED(s->entry->reserved = 1);
	REFUSED(s->entry->bytes += 64);
	REFUSED((s->entry[0].bytes -= 64, s->entry[1].bytes += 64));
	REFUSED(last->columns -= 1);
	REFUSED(last->pixels += 32);
}

/* Any single wrong bit: refused with a message, or the tiles are valid. */
TEST("survives any bit")
{
	struct shard_sample *s = *state;
	struct chance chance = chance_begin("shard");
	struct fault fault;

	for (int n = 0; n < 1000; n++) {
		const int most = (int)(n % 2 ? s->whole.bytes : sizeof(*s->header)) - 1;
		const int at = chance_int(&chance, 0, most);

		s->c.data[at] ^= (uint8_t)(1 << chance_int(&chance, 0, 7));
		if (read_changed(s, &fault) != 0)
			assert_memory_equal(fault.text, s->path, strlen(s->path));
	}
}

TEST_GROUP(setup, teardown);
