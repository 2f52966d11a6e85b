/* SPDX-License-Identifier: MIT */
/* A file of several poses: each pose is the same as in a file of its own, whichever poses are in
 * memory. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <errno.h>
#include <sched.h>

#include "tests/support/basis/copied_basis.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"

#include "hal/basis/basis_places.h"
#include "tests/support/basis/random_frame.h"
#include "tests/support/test.h"
#include "tests/support/thorough.h"

enum { POSES = 7 };

/* Writes poses first, first + 1, ...: the blocks of the synthetic file, each pose without some of
 * its tiles. */
static void write_poses(const struct synthetic *s, const char *path, int first, int count,
			const struct basis_pose_name *names, const struct basis_footprint *feet)
{
	struct copied copy = copied_file(s->path);
	const struct basis *basis = &s->basis;
	const struct basis_block_entry *entries = copied_data(&copy, BASIS_CHUNK_BLOCKS);
	const uint8_t *data = copied_data(&copy, BASIS_CHUNK_DATA);
	struct basis_info_chunk info = basis->info;
	struct basis_writer *writer;
	struct fault fault = {""};

	info.poses = (uint32_t)count;
	synthetic_must(basis_writer_open(&writer, path, &info, basis->lights, basis->ground,
					 basis->coarse, "", &fault),
		       &fault);
	for (int p = first; p < first + count; p++) {
		for (int n = 0; n < basis->poses[0].shown.block_count; n++) {
			const struct basis_block_payload block = {entries[n],
								  data + entries[n].offset};

			if ((int)(entries[n].tile % POSES) == p)
				continue;
			synthetic_must(basis_writer_blocks(writer, &block, 1, &fault), &fault);
		}
		synthetic_must(basis_writer_pose_end(writer, basis->poses[0].coverage,
						     basis->poses[0].peak, &fault),
			       &fault);
	}
	if (names)
		synthetic_must(basis_writer_names(writer, names, &fault), &fault);
	if (feet)
		synthetic_must(basis_writer_feet(writer, feet, &fault), &fault);
	synthetic_must(basis_writer_finish(writer, &info, "", &fault), &fault);
	copied_free(&copy);
}

static void open_basis(struct basis *basis, const char *path)
{
	struct fault fault = {""};

	if (basis_open(basis, path, BASIS_SHOWN, &fault))
		fail_msg("%s", fault.text);
}

static const char *path_of(const struct synthetic *s, const char *name)
{
	static char path[100];

	snprintf(path, sizeof(path), "%s/%s", s->folder, name);
	return path;
}

static void same_pose(const struct basis *basis, int pose, const struct basis *alone)
{
	const struct basis_layer *a = &basis->poses[pose].shown, *b = &alone->poses[0].shown;

	assert_int_equal(a->block_count, b->block_count);
	for (int n = 0; n < a->block_count; n++) {
		expect_equal(a->blocks[n].bytes, b->blocks[n].bytes, "block %d of pose %d", n,
			     pose);
		expect_that(memcmp(a->blocks[n].pixel, b->blocks[n].pixel, a->blocks[n].bytes) == 0,
			    "block %d of pose %d", n, pose);
	}
	assert_memory_equal(basis->poses[pose].coverage, alone->poses[0].coverage,
			    (size_t)basis->info.width * basis->info.height * 2);
	assert_memory_equal(basis->poses[pose].peak, alone->poses[0].peak,
			    ((size_t)basis->info.lights + 1) * 12);
}

/* Steps and jumps in any order, with and without announced neighbours: the picture is that of the
 * pose's own file, bit for bit. */
TEST("each is as alone")
{
	static const int order[] = {0, 1, 2, 1, 0, 6, 5, 3, 3, 6, 0, 4};
	struct chance chance = chance_begin("poses");
	const struct synthetic *s = *state;
	struct basis joint, alone[POSES];
	struct fault fault = {""};
	struct random_frame f, one[POSES];

	write_poses(s, path_of(s, "joint.inlay"), 0, POSES, NULL, NULL);
	open_basis(&joint, path_of(s, "joint.inlay"));
	for (int p = 0; p < POSES; p++) {
		write_poses(s, path_of(s, "alone.inlay"), p, 1, NULL, NULL);
		open_basis(&alone[p], path_of(s, "alone.inlay"));
	}
	random_frame_begin(&f, &joint, NULL, &chance);
	for (int p = 0; p < POSES; p++)
		random_frame_begin(&one[p], &alone[p], NULL, &chance);
	for (size_t k = 0; k < sizeof(order) / sizeof(*order); k++) {
		const int pose = order[k], next = (pose + 1) % POSES;

		if (k % 3)
			basis_poses_expect(&joint, (int[]){pose, next}, 2);
		random_frame_run(&f, pose);
		assert_int_equal(compositor_run(one[pose].compositor, 0, &f.lights, &f.backdrop,
						one[pose].out, f.stride),
				 0);
		expect_same_picture(f.out, one[pose].out, f.stride, f.bytes, "pose %d, step %zu",
				    pose, k);
		same_pose(&joint, pose, &alone[pose]);
	}
	assert_int_equal(basis_pose_load(&joint, 2, &fault), 0);
	for (int p = 0; p < POSES; p++) {
		random_frame_end(&one[p]);
		basis_close(&alone[p]);
	}
	random_frame_end(&f);
	basis_close(&joint);
	unlink(path_of(s, "joint.inlay"));
	unlink(path_of(s, "alone.inlay"));
}

static int in_memory(const struct basis *basis)
{
	int count = 0;

	for (uint32_t p = 0; p < basis->info.poses; p++)
		count += basis->poses[p].shown.tiles != NULL;
	return count;
}

TEST("only those in use are there")
{
	const struct synthetic *s = *state;
	struct fault fault = {""};
	struct basis basis;
	unsigned turn;

	write_poses(s, path_of(s, "joint.inlay"), 0, POSES, NULL, NULL);
	open_basis(&basis, path_of(s, "joint.inlay"));
	assert_int_equal(in_memory(&basis), 1);
	assert_non_null(basis.poses[0].shown.tiles);
	turn = basis.poses[0].turn;
	assert_int_equal(basis_pose_load(&basis, 0, &fault), 0);
	assert_int_equal(basis.poses[0].turn, turn); /* still at the same place */
	for (int p = 0; p < 4 * POSES; p++) {
		const int pose = p % POSES, next = (p + 1) % POSES;

		assert_int_equal(basis_pose_load(&basis, pose, &fault), 0);
		basis_poses_expect(&basis, (int[]){pose, next, next}, 3);
		expect_at_most(in_memory(&basis), 2, "p=%d", p);
		assert_non_null(basis.poses[pose].coverage);
	}
	/* The turn of a pose tells a caller that the pose has left memory since. */
	turn = basis.poses[POSES - 1].turn;
	basis_poses_expect(&basis, NULL, 0);
	assert_int_equal(in_memory(&basis), 0);
	assert_true(basis.poses[POSES - 1].turn != turn);
	turn = basis.poses[0].turn;
	assert_int_equal(basis_pose_load(&basis, 0, &fault), 0);
	assert_true(basis.poses[0].turn != turn);
	basis_close(&basis);
	unlink(path_of(s, "joint.inlay"));
}

/* The file of a running kiosk is overwritten, or its medium is pulled out: poses in memory stay as
 * they are, others are refused. */
TEST("outlives its file")
{
	const struct synthetic *s = *state;
	struct basis joint, alone, before;
	struct fault fault = {""};

	write_poses(s, path_of(s, "joint.inlay"), 0, POSES, NULL, NULL);
	open_basis(&joint, path_of(s, "joint.inlay"));
	write_poses(s, path_of(s, "alone.inlay"), 0, 1, NULL, NULL);
	open_basis(&alone, path_of(s, "alone.inlay"));
	assert_int_equal(truncate(path_of(s, "joint.inlay"), 0), 0);
	assert_int_equal(truncate(path_of(s, "alone.inlay"), 100), 0);

	write_poses(s, path_of(s, "before.inlay"), 0, 1, NULL, NULL);
	open_basis(&before, path_of(s, "before.inlay"));
	same_pose(&joint, 0, &before);
	same_pose(&alone, 0, &before);
	assert_int_equal(basis_pose_load(&joint, 2, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "cut short"));
	same_pose(&joint, 0, &before);

	basis_close(&joint);
	basis_close(&alone);
	basis_close(&before);
	unlink(path_of(s, "joint.inlay"));
	unlink(path_of(s, "alone.inlay"));
	unlink(path_of(s, "before.inlay"));
}

static void write_file(const char *path, const struct copied *copy, size_t bytes)
{
	FILE *stream = fopen(path, "wb");

	assert_non_null(stream);
	assert_int_equal(fwrite(copy->data, 1, bytes, stream), bytes);
	assert_int_equal(fclose(stream), 0);
}

static void cannot_be_loaded(const struct basis *basis, int pose, const char *words)
{
	struct fault fault = {""};

	basis_poses_expect(basis, NULL, 0); /* so that a pose that failed before is tried again */
	assert_int_equal(basis_pose_load(basis, pose, &fault), -EBADMSG);
	if (!strstr(fault.text, words))
		fail_msg("\"%s\", expected \"%s\"", fault.text, words);
}

static void can_be_loaded(const struct basis *basis, int pose)
{
	struct fault fault = {""};

	basis_poses_expect(basis, NULL, 0);
	if (basis_pose_load(basis, pose, &fault))
		fail_msg("%s", fault.text);
}

/* A pose whose bytes are not those that were checked is refused. It loads again when they are back,
 * in whichever way the file was restored. */
TEST("is loaded when its file is back")
{
	const struct synthetic *s = *state;
	struct fault fault = {""};
	struct copied whole, other;
	struct basis basis;
	char path[100];

	snprintf(path, sizeof(path), "%s", path_of(s, "joint.inlay"));
	write_poses(s, path, 0, POSES, NULL, NULL);
	whole = copied_file(path);
	other = copied_file(path);
	for (size_t k = 0; k < copied_chunk(&other, BASIS_CHUNK_PACK)[0].bytes; k++)
		((uint8_t *)copied_data(&other, BASIS_CHUNK_PACK))[k] ^= 1;
	open_basis(&basis, path);

	write_file(path, &whole, 100);
	cannot_be_loaded(&basis, 0, "cut short");
	write_file(path, &whole, whole.bytes);
	assert_int_equal(basis_pose_load(&basis, 0, &fault), -EBADMSG); /* not tried again */
	assert_true(basis_pose_ready(&basis, 0));
	can_be_loaded(&basis, 0);

	write_file(path, &other, other.bytes);
	cannot_be_loaded(&basis, 0, "pose 0 does not have its checksum");
	can_be_loaded(&basis, 1);

	/* Another file of the same name. */
	unlink(path);
	cannot_be_loaded(&basis, 0, "pose 0 does not have its checksum");
	write_file(path, &other, 100);
	cannot_be_loaded(&basis, 0, "pose 0 does not have its checksum");
	unlink(path);
	write_file(path, &whole, whole.bytes);
	can_be_loaded(&basis, 0);
	unlink(path);
	can_be_loaded(&basis, 2);

	basis_close(&basis);
	copied_free(&whole);
	copied_free(&other);
}

/* The thread that loads ahead reports the reason of a failure, too. */
TEST("tells why it was not there ahead")
{
	const struct synthetic *s = *state;
	struct fault fault = {""};
	struct basis basis;

	write_poses(s, path_of(s, "joint.inlay"), 0, POSES, NULL, NULL);
	open_basis(&basis, path_of(s, "joint.inlay"));
	assert_int_equal(truncate(path_of(s, "joint.inlay"), 100), 0);
	basis_poses_expect(&basis, (int[]){0, 4}, 2);
	while (!basis_pose_ready(&basis, 4))
		sched_yield();
	assert_int_equal(basis_pose_load(&basis, 4, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "cut short"));
	assert_int_equal(basis_pose_load(&basis, 0, &fault), 0);
	basis_close(&basis);
	unlink(path_of(s, "joint.inlay"));
}

TEST("names")
{
	static const struct basis_pose_name good[3] = {{"front"}, {""}, {"side-2_b"}};
	static const struct basis_pose_name bad[][3] = {
		{{"a"}, {"a"}, {""}},
		{{"12"}, {""}, {""}},
		{{"a b"}, {""}, {""}},
		{{"a\0b"}, {""}, {""}},
		{{"0123456789012345678901234567890a"}, {""}, {""}}};
	const struct synthetic *s = *state;
	struct fault fault = {""};
	struct copied copy;
	struct basis basis;
	struct basis_pose_name *at;

	write_poses(s, path_of(s, "joint.inlay"), 0, 3, good, NULL);
	open_basis(&basis, path_of(s, "joint.inlay"));
	assert_string_equal(basis_pose_name(&basis, 2), "side-2_b");
	assert_string_equal(basis_pose_name(&basis, 1), "");
	assert_int_equal(basis_find_pose(&basis, "front", &fault), 0);
	assert_int_equal(basis_find_pose(&basis, "1", &fault), 1);
	assert_int_equal(basis_find_pose(&basis, "3", &fault), -EINVAL);
	assert_int_equal(basis_find_pose(&basis, "", &fault), -EINVAL);
	assert_int_equal(basis_find_pose(&basis, "back", &fault), -EINVAL);
	assert_string_equal(
		fault.text,
		"the basis has no pose \"back\", expected a number 0..2 or a name that it has");
	basis_close(&basis);
	copy = copied_file(path_of(s, "joint.inlay"));
	at = copied_data(&copy, BASIS_CHUNK_POSES);
	for (size_t k = 0; k < sizeof(bad) / sizeof(*bad); k++) {
		memcpy(at, bad[k], sizeof(bad[k]));
		synthetic_reseal(copy.data, copy.bytes);
		expect_equal(copied_open(&copy, &fault), -EBADMSG, "k=%zu", k);
		assert_non_null(strstr(fault.text, "names of poses"));
	}
	memset(at, 0, sizeof(good));
	copied_chunk(&copy, BASIS_CHUNK_POSES)->bytes -= 32;
	synthetic_reseal(copy.data, copy.bytes);
	assert_int_equal(copied_open(&copy, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "POSE chunk of 64 bytes, expected 96"));
	copied_free(&copy);
	unlink(path_of(s, "joint.inlay"));
}

TEST("footprints")
{
	static const struct basis_footprint good[2] = {
		{.corner = {-1, 2}, .side = 0.125F, .row = {[3] = 5}}, {.side = 0}};
	static const struct basis_footprint bad[] = {{.corner = {NAN, 0}, .side = 1},
						     {.corner = {0, -2e9F}, .side = 1},
						     {.side = -1},
						     {.side = INFINITY},
						     {.side = 0, .row = {[63] = 1}},
						     {.side = 1, .reserved = 1}};
	const struct synthetic *s = *state;
	struct basis_writer *writer;
	struct fault fault = {""};
	struct copied copy;
	struct basis basis;

	write_poses(s, path_of(s, "joint.inlay"), 0, 2, NULL, NULL);
	open_basis(&basis, path_of(s, "joint.inlay"));
	assert_null(basis.feet);
	basis_close(&basis);
	write_poses(s, path_of(s, "joint.inlay"), 0, 2, NULL, good);
	open_basis(&basis, path_of(s, "joint.inlay"));
	assert_memory_equal(basis.feet, good, sizeof(good));
	basis_close(&basis);
	copy = copied_file(path_of(s, "joint.inlay"));
	for (size_t k = 0; k < sizeof(bad) / sizeof(*bad); k++) {
		struct basis_footprint *at = copied_data(&copy, BASIS_CHUNK_FOOT);

		at[1] = bad[k];
		synthetic_reseal(copy.data, copy.bytes);
		expect_equal(copied_open(&copy, &fault), -EBADMSG, "k=%zu", k);
		assert_non_null(strstr(fault.text, "footprint of pose 1"));
		synthetic_must(basis_writer_open(&writer, path_of(s, "bad.inlay"), &s->basis.info,
						 s->basis.lights, s->basis.ground, s->basis.coarse,
						 "", &fault),
			       &fault);
		expect_equal(basis_writer_feet(writer, &bad[k], &fault), -EINVAL, "k=%zu", k);
		basis_writer_abandon(writer);
	}
	copied_chunk(&copy, BASIS_CHUNK_FOOT)->bytes -= 528;
	memset(copied_data(&copy, BASIS_CHUNK_FOOT), 0, sizeof(good));
	synthetic_reseal(copy.data, copy.bytes);
	assert_int_equal(copied_open(&copy, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "FOOT chunk of 528 bytes, expected 1056"));
	copied_free(&copy);
	unlink(path_of(s, "joint.inlay"));
}

/* Writes two poses without blocks, the second with places. */
static void write_places(const struct synthetic *s, const char *path,
			 const float *const distance[BASIS_SURFACES])
{
	struct basis_info_chunk info = s->basis.info;
	struct basis_writer *writer;
	struct fault fault = {""};

	info.poses = 2;
	synthetic_must(basis_writer_open(&writer, path, &info, s->basis.lights, s->basis.ground,
					 s->basis.coarse, "", &fault),
		       &fault);
	assert_int_equal(basis_writer_places(writer, distance, &fault), -EINVAL);
	for (int p = 0; p < 2; p++)
		synthetic_must(basis_writer_pose_end(writer, s->basis.poses[0].coverage,
						     s->basis.poses[0].peak, &fault),
			       &fault);
	synthetic_must(basis_writer_places(writer, distance, &fault), &fault);
	synthetic_must(basis_writer_finish(writer, &info, "", &fault), &fault);
}

/* Such a change of the chunk is refused with this message. */
static void damage_places(const char *path, void (*change)(struct basis_places *), const char *text)
{
	struct copied copy = copied_file(path);
	struct fault fault = {""};

	change(copied_data(&copy, BASIS_CHUNK_PLACES));
	synthetic_reseal(copy.data, copy.bytes);
	assert_int_equal(copied_open(&copy, &fault), -EBADMSG);
	if (!strstr(fault.text, text))
		fail_msg("%s", fault.text);
	copied_free(&copy);
}

static void nearest_nan(struct basis_places *places)
{
	places->nearest[1] = NAN;
}

static void one_byte_more(struct basis_places *places)
{
	places->bytes[0]++;
}

TEST("places of surfaces")
{
	const struct synthetic *s = *state;
	const size_t pixels = (size_t)s->basis.info.width * s->basis.info.height;
	const char *path = path_of(s, "places.inlay");
	float *map[BASIS_SURFACES];
	float *back = calloc(pixels, sizeof(*back));
	struct basis basis;
	struct copied copy;
	struct fault fault = {""};

	for (int k = 0; k < BASIS_SURFACES; k++) {
		map[k] = calloc(pixels, sizeof(*map[k]));
		assert_non_null(map[k]);
	}
	assert_non_null(back);
	for (size_t at = 0; at < pixels; at += 1 + at % 3)
		map[0][at] = 0.7F + (float)(at % 97) * (float)(at % 89);
	write_places(s, path, (const float *const *)map);
	open_basis(&basis, path);
	assert_false(basis_has_places(&basis, 0));
	assert_int_equal(basis_places_read(&basis, 0, BASIS_OBJECT, back), -ENODATA);
	assert_true(basis_has_places(&basis, 1));
	assert_int_equal(basis_places_read(&basis, 1, BASIS_RECEIVER, back), 0);
	for (size_t at = 0; at < pixels; at++)
		expect_equal(back[at], 0, "pixel %zu", at);
	assert_int_equal(basis_places_read(&basis, 1, BASIS_OBJECT, back), 0);
	for (size_t at = 0; at < pixels; at++) { /* steps of 1 / distance */
		const double is = map[0][at] > 0 ? 1 / (double)map[0][at] : 0;
		const double was = back[at] > 0 ? 1 / (double)back[at] : 0;

		expect_below(fabs(is - was), (is > 1e-3 ? 0.5001 : 1) / 0.7 / BASIS_PLACE_ONE,
			     "pixel %zu", at);
	}
	basis_close(&basis);
	damage_places(path, nearest_nan, "nearest place at nan");
	damage_places(path, one_byte_more, "PLAC chunk of");

	/* what zstd refuses is found when it is read */
	copy = copied_file(path);
	memset((struct basis_places *)copied_data(&copy, BASIS_CHUNK_PLACES) + 1, 0x55, 16);
	synthetic_reseal(copy.data, copy.bytes);
	assert_int_equal(basis_open_memory(&basis, copy.data, copy.bytes, "mem", BASIS_ALL, &fault),
			 0);
	assert_int_equal(basis_places_read(&basis, 1, BASIS_OBJECT, back), -EBADMSG);
	basis_close(&basis);
	copied_free(&copy);
	unlink(path);
	for (int k = 0; k < BASIS_SURFACES; k++)
		free(map[k]);
	free(back);
}

/* ---- damage ---- */

struct damaged {
	struct copied whole, c;
	struct basis_pack *pack;
	struct basis_pack_part *part;
	struct basis_block_entry *entry;
};

static void poses_refuse(struct damaged *d, const char *words)
{
	struct fault fault;

	synthetic_reseal(d->c.data, d->c.bytes);
	assert_int_equal(copied_open(&d->c, &fault), -EBADMSG);
	if (!strstr(fault.text, words))
		fail_msg("\"%s\", expected \"%s\"", fault.text, words);
	memcpy(d->c.data, d->whole.data, d->whole.bytes);
}

#define REFUSED(words, change)                                                                     \
	do {                                                                                       \
		change;                                                                            \
		poses_refuse(&d, words);                                                           \
	} while (0)

TEST("refuses a broken pack")
{
	const struct synthetic *s = *state;
	struct chance chance = chance_begin("broken packs");
	struct damaged d;
	struct fault fault;
	uint64_t bytes;

	write_poses(s, path_of(s, "joint.inlay"), 0, 2, NULL, NULL);
	d.whole = copied_file(path_of(s, "joint.inlay"));
	d.c = copied_file(path_of(s, "joint.inlay"));
	d.pack = copied_data(&d.c, BASIS_CHUNK_PACK);
	d.part = (struct basis_pack_part *)(d.pack + 1);
	d.entry = copied_data(&d.c, BASIS_CHUNK_BLOCKS);
	bytes = copied_chunk(&d.c, BASIS_CHUNK_PACK)->bytes;
	REFUSED("pose 0: blocks of", d.pack->data_bytes += 64);
	REFUSED("unpacks to", d.pack->data_bytes = UINT64_MAX);
	REFUSED("PACK chunk of pose 0", d.pack->parts = UINT32_MAX);
	REFUSED("PACK chunk of pose 0", d.pack->coverage_bytes = (uint32_t)bytes);
	REFUSED("expected", d.pack->coverage_bytes -= 1);
	REFUSED("0 blocks", d.part->blocks = 0);
	REFUSED("are left", d.part->blocks += 1);
	REFUSED("parts of a pose hold", d.part->blocks -= 1);
	REFUSED("blocks, expected", d.part->reserved = 1);
	REFUSED("longer than its chunk", d.part->bytes[1] = UINT32_MAX);
	REFUSED("leave", d.part->bytes[3] -= 1);
	REFUSED("cannot be unpacked", (d.part->bytes[1] -= 1, d.part->bytes[2] += 1));
	REFUSED("behind the block before it", d.entry[1].offset += 64);
	REFUSED("behind the block before it", d.entry[0].bytes += 64);
	REFUSED("kind", d.entry[0].kind = 9);
	REFUSED("PACK, and DATA", copied_chunk(&d.c, BASIS_CHUNK_CAMERA)->type = BASIS_CHUNK_DATA);
	REFUSED("no BLCK and DATA", copied_chunk(&d.c, BASIS_CHUNK_PACK)->type = 77);
	memset((uint8_t *)d.pack + 8, 0, bytes - 8);
	REFUSED("expected 16 and more", copied_chunk(&d.c, BASIS_CHUNK_PACK)->bytes = 8);
	/* Random damage in the packed streams: refused, or still valid data. */
	for (int n = 0; n < (thorough() ? 3000 : 300); n++) {
		const uint64_t at = (uint64_t)chance_int(&chance, 16, (int)bytes - 1);

		((uint8_t *)d.pack)[at] ^= (uint8_t)(1 << chance_int(&chance, 0, 7));
		synthetic_reseal(d.c.data, d.c.bytes);
		if (copied_open(&d.c, &fault) != 0)
			assert_memory_equal(fault.text, "mem.inlay: ", 11);
		((uint8_t *)d.pack)[at] = d.whole.data[(size_t)((uint8_t *)d.pack - d.c.data) + at];
	}
	copied_free(&d.whole);
	copied_free(&d.c);
	unlink(path_of(s, "joint.inlay"));
}

/* The checks of packed poses know the largest number of columns. */
TEST("may have groups")
{
	const struct synthetic_options options = {.width = 9,
						  .height = 7,
						  .lights = 20,
						  .grounds = 1,
						  .coarse = 4,
						  .patterns = 1,
						  .columns = 12,
						  .bits = 8,
						  .object_share = 0.5,
						  .ground_share = 0.5,
						  .column_cut = 0.01,
						  .groups = 4,
						  .peak = 1,
						  .seed = 6};
	struct synthetic s;
	struct basis basis;

	synthetic_open(&s, &options);
	write_poses(&s, path_of(&s, "joint.inlay"), 1, 2, NULL, NULL);
	open_basis(&basis, path_of(&s, "joint.inlay"));
	same_pose(&basis, 0, &s.basis);
	basis_close(&basis);
	unlink(path_of(&s, "joint.inlay"));
	synthetic_close(&s);
}

/* ---- small files that ask for much memory ---- */

/* Poses that hold only `blocks` blocks of zeros each, in either layer. */
struct bomb {
	uint32_t width, height, lights, poses;
	int blocks;
	bool exact;
};

static void write_bomb(const struct synthetic *s, const struct bomb *b)
{
	struct chance chance = {1};
	const struct basis_info_chunk info = {.width = b->width,
					      .height = b->height,
					      .lights = b->lights,
					      .coarse = b->lights,
					      .poses = b->poses};
	struct basis_block_payload block = {.entry = {.channels = 3,
						      .bits = 16,
						      .pixels = 256,
						      .columns = b->lights,
						      .cut_share = 1}};
	uint8_t *payload;
	struct basis_light *light = synthetic_zeros(b->lights, sizeof(*light));
	float(*peak)[3] = synthetic_zeros(b->lights + 1, sizeof(*peak));
	uint16_t *coverage = synthetic_zeros((size_t)b->width * b->height, sizeof(*coverage));
	struct basis_writer *writer;
	struct fault fault = {""};

	block.entry.bytes = basis_layout(&block.entry, (int)b->lights).bytes;
	payload = synthetic_zeros(block.entry.bytes, 1);
	/* Not only zeros, so that it packs to 1/64 to 1/4096. */
	for (size_t k = 0; k < block.entry.bytes; k += 512)
		payload[k] = (uint8_t)chance_int(&chance, 0, 255);
	block.payload = payload;
	synthetic_lights(light, (int)b->lights, &chance);
	synthetic_must(basis_writer_open(&writer, path_of(s, "bomb.inlay"), &info, light, NULL,
					 NULL, "", &fault),
		       &fault);
	for (uint32_t p = 0; p < b->poses; p++) {
		for (int k = 0; k < b->blocks; k++)
			synthetic_must((b->exact ? basis_writer_exact_blocks
						 : basis_writer_blocks)(writer, &block, 1, &fault),
				       &fault);
		synthetic_must(
			basis_writer_pose_end(writer, coverage, (const float(*)[3])peak, &fault),
			&fault);
	}
	synthetic_must(basis_writer_finish(writer, &info, "", &fault), &fault);
	free(payload);
	free(light);
	free(peak);
	free(coverage);
}

/* words NULL: the file must open. */
static void open_bomb(const struct synthetic *s, enum basis_part part, const char *words)
{
	struct fault fault = {""};
	struct basis basis;
	const int ret = basis_open(&basis, path_of(s, "bomb.inlay"), part, &fault);

	basis_close(&basis);
	if (words ? ret != -EBADMSG || !strstr(fault.text, words) : ret != 0)
		fail_msg("%d, \"%s\", expected \"%s\"", ret, fault.text, words ? words : "");
}

TEST("refuses bombs")
{
	const struct synthetic *s = *state;

	/* poses without an object, for the largest screens */
	write_bomb(s, &(struct bomb){3840, 2160, .lights = 1, .poses = 2});
	open_bomb(s, BASIS_ALL, NULL);
	write_bomb(s, &(struct bomb){4096, 4096, .lights = 1, .poses = 2});
	open_bomb(s, BASIS_SHOWN, "2 poses of 4096x4096 pixels take 3");
	/* lists of tiles, which each pose's exact layer has of its own */
	write_bomb(s, &(struct bomb){3000, 2800, 1, .poses = 24, .blocks = 1, .exact = true});
	open_bomb(s, BASIS_SHOWN, NULL);
	open_bomb(s, BASIS_ALL, "24 poses of 3000x2800 pixels take");
	write_bomb(s, &(struct bomb){16, 16, .lights = 1000, .poses = 2, .blocks = 20});
	open_bomb(s, BASIS_SHOWN, "expected at most 64 times as many");
	unlink(path_of(s, "bomb.inlay"));
}

TEST_GROUP(copied_setup, copied_teardown);
