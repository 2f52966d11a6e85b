/* SPDX-License-Identifier: MIT */
/* The basis file: the reader returns what the writer wrote, and a writer that fails leaves no file.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <errno.h>
#include <signal.h>
#include <sys/resource.h>

#include "hal/basis/basis_lines.h"
#include "tests/support/basis/copied_basis.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { LIGHTS = 3, POSES = 2, PAYLOAD = 8192 };

static const struct basis_light three_lights[LIGHTS] = {
	{{1, 0, 0}, 1}, {{0, 1, 0}, 2}, {{0, 0, 1}, 3}};
static const double one_ground[1][3][LIGHTS] = {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}};
static const struct basis_coarse two_coarse[LIGHTS] = {
	{{0}, {32768}}, {{0, 1}, {1, 32767}}, {{1}, {32768}}};

/* A shown block of two pixels: a pattern, and two columns of 8 bits. */
static struct basis_block_payload shown_block(uint8_t *payload, uint32_t tile)
{
	struct basis_block_payload block = {.entry = {.tile = tile,
						      .kind = BASIS_KIND_T,
						      .channels = 1,
						      .bits = 8,
						      .tinted = 1,
						      .pixels = 2,
						      .patterns = 1,
						      .columns = 2,
						      .record_bytes = 36 + 68,
						      .cut_share = 0.375F},
					    .payload = payload};
	const struct basis_layout at = basis_layout(&block.entry, 2);

	assert_true(at.bytes <= PAYLOAD);
	memset(payload, 0, at.bytes);
	((uint16_t *)(payload + at.pixel))[1] = 2 * BASIS_TILE;
	((uint16_t *)(payload + at.tint))[5] = 12345;
	((float *)(payload + at.pattern_scale))[0] = 0x1p-20F;
	((int16_t *)(payload + at.pattern))[1] = -30000;
	((int16_t *)(payload + at.coefficient))[1] = 3;
	((uint16_t *)(payload + at.light))[0] = 1;
	((uint16_t *)(payload + at.light))[1] = 2;
	((float *)(payload + at.column_scale))[1] = 0.25F;
	((uint32_t *)(payload + at.column))[1] = 36;
	payload[at.record] = 5; /* times 7 and -7 */
	memset(payload + at.record + 4, 0x77, 32);
	payload[at.record + 4] = 0x7e;
	payload[at.record + 5] = 0x70;
	payload[at.record + 36] = 255;
	payload[at.record + 40] = 0x81;
	block.entry.bytes = at.bytes;
	return block;
}

static struct basis_block_payload exact_block(uint8_t *payload, uint32_t tile)
{
	struct basis_block_payload block = {.entry = {.tile = tile,
						      .kind = BASIS_KIND_T,
						      .channels = 3,
						      .bits = 16,
						      .pixels = 1,
						      .columns = LIGHTS,
						      .cut_share = 1},
					    .payload = payload};
	const struct basis_layout at = basis_layout(&block.entry, 2);

	assert_true(at.bytes <= PAYLOAD);
	memset(payload, 0, at.bytes);
	for (int i = 0; i < LIGHTS; i++)
		((uint16_t *)(payload + at.light))[i] = (uint16_t)i;
	((float *)(payload + at.column_scale))[2] = 0.125F;
	((int16_t *)(payload + at.column))[32] = (int16_t)(-32767 + (int)tile);
	block.entry.bytes = at.bytes;
	return block;
}

/* Writes two poses: one of a shown block and two exact blocks, one of nothing. */
static struct basis_info_chunk write_two_poses(const char *path, const uint16_t *coverage,
					       const float (*peak)[3])
{
	struct basis_info_chunk info = {.width = 17,
					.height = 3,
					.lights = LIGHTS,
					.dome_frequency = 1,
					.grounds = 1,
					.poses = POSES,
					.coarse = 2};
	uint8_t payload[PAYLOAD] __attribute__((aligned(64)));
	struct basis_block_payload block;
	struct basis_writer *writer;
	struct fault fault = {""};

	assert_int_equal(basis_writer_open(&writer, path, &info, three_lights, &one_ground[0][0][0],
					   two_coarse, "[camera]\nf = 1\n", &fault),
			 0);
	block = exact_block(payload, 0);
	assert_int_equal(basis_writer_exact_blocks(writer, &block, 1, &fault), 0);
	block = shown_block(payload, 1);
	assert_int_equal(basis_writer_blocks(writer, &block, 1, &fault), 0);
	block = exact_block(payload, 1);
	assert_int_equal(basis_writer_exact_blocks(writer, &block, 1, &fault), 0);
	assert_int_equal(basis_writer_pose_end(writer, coverage, peak, &fault), 0);
	assert_int_equal(basis_writer_exact_blocks(writer, NULL, 0, &fault), 0);
	assert_int_equal(basis_writer_pose_end(writer, coverage, peak, &fault), 0);
	info.object_error = 0.125;
	info.ratio_error = 0.25;
	info.noise_levels = 0.5;
	info.column_cut = 1;
	info.sky_rms = 2;
	info.sky_max = 3;
	info.cell_rms = 4;
	info.cell_max = 5;
	assert_int_equal(access(path, F_OK), -1); /* the file appears only when it is complete */
	assert_int_equal(basis_writer_finish(writer, &info, "seed = 1\n", &fault), 0);
	return info;
}

static void check_shown(const struct basis_layer *layer, int blocks)
{
	const struct basis_block *b = layer->blocks;

	assert_int_equal(layer->block_count, blocks);
	assert_int_equal(layer->tiles[0].block_count, 0);
	assert_int_equal(layer->tiles[1].block_count, blocks);
	assert_int_equal(layer->tiles[1].x, 16);
	assert_int_equal(layer->tiles[1].width, 1);
	assert_int_equal(layer->tiles[1].height, 3);
	if (!blocks)
		return;
	assert_ptr_equal(layer->tiles[1].blocks, b);
	assert_int_equal(layer->tiles[1].bytes, b->bytes);
	assert_true(b->kind == BASIS_KIND_T && b->pixels == 2 && b->channels == 1 && b->bits == 8);
	assert_true(b->cut_share == 0.375F);
	assert_true(b->patterns == 1 && b->columns == 2 && b->stride == 32 && b->ground == 0);
	assert_int_equal(b->pixel[1], 2 * BASIS_TILE);
	assert_int_equal(b->tint[5], 12345);
	assert_true(b->pattern_scale[0] == 0x1p-20F && b->column_scale[1] == 0.25F);
	assert_int_equal(b->pattern[1], -30000);
	assert_int_equal(b->coefficient[1], 3);
	assert_int_equal(b->light[1], 2);
	assert_null(b->column16);
	assert_int_equal(basis_column8_value(b, 0, 0, 0), 35);
	assert_int_equal(basis_column8_value(b, 0, 0, 1), -35);
	assert_int_equal(basis_column8_value(b, 1, 0, 0), -127);
	assert_int_equal(basis_column8_value(b, 1, 0, 1), 0);
	assert_int_equal((uintptr_t)b->record % BASIS_ALIGN, 0);
}

static void check_exact(const struct basis_layer *layer)
{
	assert_int_equal(layer->block_count, 2);
	for (int t = 0; t < 2; t++) {
		const struct basis_block *b = layer->tiles[t].blocks;

		expect_equal(layer->tiles[t].block_count, 1, "t=%d", t);
		expect_that(b->columns == LIGHTS && b->patterns == 0 && b->bits == 16, "t=%d", t);
		assert_null(b->tint);
		assert_null(b->record);
		expect_equal(b->column_scale[2], 0.125F, "t=%d", t);
		expect_equal(b->column16[32], -32767 + t, "t=%d", t);
	}
}

TEST("writes and reads back")
{
	uint16_t coverage[17 * 3];
	const float peak[LIGHTS + 1][3] = {{0.5F, 0.25F, 0}, {1, 2, 3}, {0, 0, 0}, {9, 8, 7}};
	struct synthetic *s = *state;
	struct basis_info_chunk info;
	struct fault fault = {""};
	struct basis basis;
	char path[100];

	snprintf(path, sizeof(path), "%s/two.inlay", s->folder);
	for (int i = 0; i < 17 * 3; i++)
		coverage[i] = (uint16_t)(i * 1000);
	info = write_two_poses(path, coverage, peak);
	for (int part = BASIS_SHOWN; part <= BASIS_ALL; part++) {
		if (part == BASIS_WITH_EXACT) { /* which the second pose does not have */
			expect_equal(basis_open(&basis, path, BASIS_WITH_EXACT, &fault), -ENODATA,
				     "part=%d", part);
			assert_non_null(strstr(fault.text, "pose 1 has no exact layer"));
			basis_close(&basis);
			continue;
		}
		if (basis_open(&basis, path, (enum basis_part)part, &fault) < 0)
			fail_msg("%s", fault.text);
		assert_memory_equal(&basis.info, &info, sizeof(info));
		assert_memory_equal(basis.lights, three_lights, sizeof(three_lights));
		assert_memory_equal(basis_ground(&basis, 0, 1), one_ground[0][1],
				    sizeof(one_ground[0][1]));
		assert_memory_equal(basis.coarse, two_coarse, sizeof(two_coarse));
		assert_string_equal(basis.camera, "[camera]\nf = 1\n");
		assert_string_equal(basis.provenance, "seed = 1\n");
		expect_equal(basis.tiles_across, 2, "part=%d", part);
		expect_equal(basis.tiles_down, 1, "part=%d", part);
		for (int p = 0; p < POSES; p++) {
			assert_int_equal(basis_pose_load(&basis, p, &fault), 0);
			assert_memory_equal(basis.poses[p].coverage, coverage, sizeof(coverage));
			assert_memory_equal(basis.poses[p].peak, peak, sizeof(peak));
			check_shown(&basis.poses[p].shown, p == 0);
		}
		assert_null(basis.poses[1].exact.tiles);
		if (part == BASIS_ALL)
			check_exact(&basis.poses[0].exact);
		else
			assert_null(basis.poses[0].exact.tiles);
		basis_close(&basis);
		basis_close(&basis);
	}
	unlink(path);
}

/* The file in which the writer collects the exact layer starts anew with each pose. */
TEST("each pose has its own exact layer")
{
	static const int tiles[3][2] = {{0, 1}, {-1, -1}, {1, -1}};
	const struct basis_info_chunk info = {
		.width = 17, .height = 1, .lights = LIGHTS, .poses = 3, .coarse = LIGHTS};
	const uint16_t coverage[17] = {0};
	const float peak[LIGHTS + 1][3] = {{0}};
	uint8_t payload[PAYLOAD] __attribute__((aligned(64)));
	struct synthetic *s = *state;
	struct basis_writer *writer;
	struct fault fault = {""};
	struct basis basis;
	char path[100];

	snprintf(path, sizeof(path), "%s/three.inlay", s->folder);
	assert_int_equal(
		basis_writer_open(&writer, path, &info, three_lights, NULL, NULL, "", &fault), 0);
	for (int p = 0; p < 3; p++) {
		for (int n = 0; n < 2 && tiles[p][n] >= 0; n++) {
			const struct basis_block_payload block = exact_block(payload,
									     (uint32_t)tiles[p][n]);

			assert_int_equal(basis_writer_exact_blocks(writer, &block, 1, &fault), 0);
		}
		assert_int_equal(basis_writer_pose_end(writer, coverage, peak, &fault), 0);
	}
	assert_int_equal(basis_writer_finish(writer, &info, "", &fault), 0);
	if (basis_open(&basis, path, BASIS_ALL, &fault) < 0)
		fail_msg("%s", fault.text);
	check_exact(&basis.poses[0].exact);
	assert_null(basis.poses[1].exact.tiles);
	assert_int_equal(basis.poses[2].exact.block_count, 1);
	assert_int_equal(basis.poses[2].exact.tiles[0].block_count, 0);
	assert_int_equal(basis.poses[2].exact.tiles[1].blocks->column16[32], -32766);
	basis_close(&basis);
	unlink(path);
}

/* A kiosk in mode exact shows what it has checked, even when the file changes afterwards. */
TEST("the exact layer outlives its file")
{
	const struct synthetic *s = *state;
	const struct basis_layer *expected = &s->basis.poses[0].exact, *layer;
	struct copied copy = copied_file(s->path);
	struct fault fault = {""};
	struct basis basis;
	char path[100];
	FILE *stream;

	snprintf(path, sizeof(path), "%s/cut.inlay", s->folder);
	stream = fopen(path, "wb");
	assert_non_null(stream);
	assert_int_equal(fwrite(copy.data, 1, copy.bytes, stream), copy.bytes);
	fclose(stream);
	assert_int_equal(basis_open(&basis, path, BASIS_WITH_EXACT, &fault), 0);
	assert_int_equal(truncate(path, 0), 0);
	layer = &basis.poses[0].exact;
	assert_int_equal(layer->block_count, expected->block_count);
	for (int n = 0; n < layer->block_count; n++)
		assert_memory_equal(layer->blocks[n].pixel, expected->blocks[n].pixel,
				    layer->blocks[n].bytes);
	basis_close(&basis);
	copied_free(&copy);
	unlink(path);
}

/* The reader accepts files of every valid shape, and both layers say the same. */
TEST("accepts what may be")
{
	static const int lights[] = {1, 2, 6, 33, 50, 129};
	struct chance chance = chance_begin("shapes");

	for (int n = 0; n < 60; n++) {
		struct synthetic_options o = copied_small;
		struct fault fault = {""};
		struct synthetic s;
		struct basis with;

		o.width = chance_int(&chance, 1, 40);
		o.height = chance_int(&chance, 1, 40);
		o.lights = lights[n % 6];
		o.coarse = chance_int(&chance, 1, o.lights);
		o.patterns = chance_int(&chance, 0, 9);
		o.columns = chance_int(&chance, -1, o.lights);
		o.bits = n % 2 ? 8 : 16;
		o.layers = chance_int(&chance, 1, 4);
		o.vary = n % 3 > 0;
		o.grey = n % 5 == 0;
		o.tinted = n % 10 == 0;
		o.object_share = 1; /* a layer exists when it holds at least one block */
		o.seed = chance_bits(&chance);
		synthetic_open(&s, &o);
		expect_equal(s.basis.coarse == NULL, o.coarse == o.lights, "n=%d", n);
		assert_int_equal(basis_open(&with, s.path, BASIS_WITH_EXACT, &fault), 0);
		assert_non_null(with.poses[0].exact.tiles);
		basis_close(&with);
		synthetic_close(&s);
	}
}

/* All values of a layer for one tile and kind: [TILE_PIXELS][3][lights]. */
static double *tile_values(const struct basis *basis, const struct basis_tile *tile,
			   enum basis_kind kind)
{
	const size_t row = 3 * (size_t)basis->info.lights;
	double *all = calloc(SYNTHETIC_PIXELS * row, sizeof(*all));

	assert_non_null(all);
	for (int n = 0; n < tile->block_count; n++) {
		const struct basis_block *b = &tile->blocks[n];
		double *own = calloc((size_t)b->pixels * row, sizeof(*own));

		assert_non_null(own);
		synthetic_add_values(b, (int)basis->info.lights, basis->coarse, own);
		for (size_t k = 0; b->kind == kind && k < (size_t)b->pixels * row; k++)
			all[b->pixel[k / row] * row + k % row] += own[k];
		free(own);
	}
	return all;
}

TEST("both layers say the same")
{
	struct synthetic *s = *state;
	const struct basis *basis = &s->basis;
	const struct basis_pose *pose = &basis->poses[0];
	const double bounds[] = {basis->info.object_error, basis->info.ratio_error, 1e-5, 1e-5};

	for (int t = 0; t < basis->tiles_across * basis->tiles_down; t++) {
		for (int kind = 0; kind < BASIS_KIND_COUNT; kind++) {
			double *shown = tile_values(basis, &pose->shown.tiles[t], kind);
			double *exact = tile_values(basis, &pose->exact.tiles[t], kind);
			double most = 0, error = 0;

			for (int k = 0; k < SYNTHETIC_PIXELS * 3 * copied_small.lights; k++) {
				most = fmax(most, fabs(exact[k]));
				error = fmax(error, fabs(exact[k] - shown[k]));
			}
			expect_that(most > 0.02 && error <= bounds[kind] * 1.000001,
				    "t=%d, kind=%d", t, kind);
			expect_below(bounds[kind], 1e-4, "t=%d, kind=%d", t, kind);
			free(shown);
			free(exact);
		}
	}
}

static void is_empty_but_for(const struct synthetic *s)
{
	/* Fails, because the folder still holds that file; after it there is nothing: */
	assert_int_equal(rmdir(s->folder), -1);
	assert_int_equal(unlink(s->path), 0);
	assert_int_equal(rmdir(s->folder), 0);
	assert_int_equal(mkdir(s->folder, 0700), 0);
	synthetic_write((struct synthetic *)s, &copied_small);
}

TEST("a failed writer leaves nothing")
{
	struct basis_info_chunk info = {
		.width = 1, .height = 1, .lights = LIGHTS, .grounds = 0, .poses = 2, .coarse = 2};
	const float peak[LIGHTS + 1][3] = {{0}};
	uint8_t payload[PAYLOAD] __attribute__((aligned(64)));
	struct basis_block_payload block = exact_block(payload, 0);
	const uint16_t coverage = 0;
	struct basis_writer *writer;
	struct fault fault = {""};
	struct synthetic *s = *state;
	char path[100];

	snprintf(path, sizeof(path), "%s/none.inlay", s->folder);
	assert_int_equal(
		basis_writer_open(&writer, path, &info, three_lights, NULL, two_coarse, "", &fault),
		0);
	assert_int_equal(basis_writer_pose_end(writer, &coverage, peak, &fault), 0);
	assert_int_equal(basis_writer_finish(writer, &info, "", &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "1 poses finished, expected 2"));
	assert_int_equal(access(path, F_OK), -1);

	assert_int_equal(
		basis_writer_open(&writer, path, &info, three_lights, NULL, two_coarse, "", &fault),
		0);
	assert_int_equal(basis_writer_exact_blocks(writer, &block, 1, &fault), 0);
	basis_writer_abandon(writer);
	basis_writer_abandon(NULL);
	is_empty_but_for(s);
}

TEST("the writer refuses what cannot be")
{
	struct basis_info_chunk info = {
		.width = 1, .height = 1, .lights = LIGHTS, .grounds = 0, .poses = 1, .coarse = 2};
	uint8_t payload[PAYLOAD] __attribute__((aligned(64)));
	struct basis_block_payload block = exact_block(payload, 1);
	struct basis_writer *writer;
	struct fault fault = {""};
	struct synthetic *s = *state;
	char path[100];

	snprintf(path, sizeof(path), "%s/none.inlay", s->folder);
	assert_int_equal(
		basis_writer_open(&writer, path, &info, three_lights, NULL, NULL, "", &fault),
		-EINVAL);
	assert_non_null(strstr(fault.text, "2 coarse lights of 3 without a table"));
	info.coarse = 4;
	assert_int_equal(
		basis_writer_open(&writer, path, &info, three_lights, NULL, two_coarse, "", &fault),
		-EINVAL);
	info.coarse = info.lights = 0;
	assert_int_equal(
		basis_writer_open(&writer, path, &info, three_lights, NULL, NULL, "", &fault),
		-EINVAL);
	assert_null(writer);
	info.coarse = info.lights = LIGHTS;
	assert_int_equal(basis_writer_open(&writer, "/nowhere/at/all.inlay", &info, three_lights,
					   NULL, NULL, "", &fault),
			 -ENOENT);
	assert_int_equal(
		basis_writer_open(&writer, path, &info, three_lights, NULL, NULL, "", &fault), 0);
	assert_int_equal(basis_writer_exact_blocks(writer, &block, 1, &fault), 0);
	block.entry.tile = 0;
	assert_int_equal(basis_writer_exact_blocks(writer, &block, 1, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "order of tiles"));
	block.entry.kind = BASIS_KIND_U; /* the exact layer has an order of its own */
	assert_int_equal(basis_writer_blocks(writer, &block, 1, &fault), 0);
	block.entry.kind = BASIS_KIND_D;
	assert_int_equal(basis_writer_blocks(writer, &block, 1, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "then of kinds"));
	basis_writer_abandon(writer);
	is_empty_but_for(s);
}

/* The disk is full when the file itself is written, or the temporary file beside it. */
TEST("a full disk leaves nothing")
{
	const struct rlimit little = {1 << 17, RLIM_INFINITY};
	struct basis_info_chunk info = {
		.width = 1, .height = 1, .lights = LIGHTS, .poses = 1, .coarse = LIGHTS};
	uint8_t payload[PAYLOAD] __attribute__((aligned(64)));
	struct basis_block_payload block = exact_block(payload, 0);
	struct synthetic *s = *state;
	struct rlimit usual;
	char path[100];

	snprintf(path, sizeof(path), "%s/none.inlay", s->folder);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &usual), 0);
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &(struct rlimit){little.rlim_cur, usual.rlim_max}),
			 0);
	for (int exact = 0; exact < 2; exact++) {
		struct basis_writer *writer;
		struct fault fault = {""};
		int ret = basis_writer_open(&writer, path, &info, three_lights, NULL, NULL, "",
					    &fault);

		expect_equal(ret, 0, "exact=%d", exact);
		for (int n = 0; n < 1000 && ret == 0; n++)
			ret = exact ? basis_writer_exact_blocks(writer, &block, 1, &fault)
				    : basis_writer_blocks(writer, &block, 1, &fault);
		expect_equal(ret, -EFBIG, "exact=%d", exact);
		assert_non_null(strstr(fault.text, "none.inlay: cannot be written: "));
		basis_writer_abandon(writer);
	}
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &usual), 0);
	signal(SIGXFSZ, SIG_DFL);
	is_empty_but_for(s);
}

TEST("writing twice gives the same bytes")
{
	struct synthetic *s = *state;
	struct copied first = copied_file(s->path), second;

	synthetic_write(s, &copied_small);
	second = copied_file(s->path);
	assert_int_equal(first.bytes, second.bytes);
	assert_memory_equal(first.data, second.data, first.bytes);
	copied_free(&first);
	copied_free(&second);
}

static void write_file(const char *path, const void *data, size_t bytes)
{
	FILE *stream = fopen(path, "wb");

	assert_non_null(stream);
	assert_int_equal(fwrite(data, 1, bytes, stream), bytes);
	assert_int_equal(fclose(stream), 0);
}

TEST("names what is not a basis")
{
	struct synthetic *s = *state;
	struct fault fault = {""};
	struct basis basis;
	char path[100];

	snprintf(path, sizeof(path), "%s/bad.inlay", s->folder);
	assert_int_equal(basis_open(&basis, path, BASIS_SHOWN, &fault), -ENOENT);
	assert_non_null(strstr(fault.text, "bad.inlay"));
	assert_int_equal(basis_open(&basis, s->folder, BASIS_SHOWN, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "not a plain file"));
	write_file(path, "", 0);
	assert_int_equal(basis_open(&basis, path, BASIS_SHOWN, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "empty"));
	write_file(path, "GIF89a and more", 15);
	assert_int_equal(basis_open(&basis, path, BASIS_SHOWN, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "not a basis file"));
	write_file(path, BASIS_MAGIC "\11\0\0\0abcdefghijklmnopqrstuvwxyz", 36);
	assert_int_equal(basis_open(&basis, path, BASIS_SHOWN, &fault), -ENOTSUP);
	assert_non_null(
		strstr(fault.text,
		       "bad.inlay: basis file of version 9, expected version 10: bake it again"));
	assert_null(strchr(fault.text, '\n'));
	basis_close(&basis); /* after a failure, closing does no harm */
	unlink(path);
}

TEST("the exact layer may be absent")
{
	struct synthetic_options o = copied_small;
	struct fault fault = {""};
	struct basis basis;
	struct synthetic s;

	o.exact = false;
	synthetic_open(&s, &o);
	assert_null(s.basis.poses[0].exact.tiles);
	assert_int_equal(basis_open(&basis, s.path, BASIS_WITH_EXACT, &fault), -ENODATA);
	assert_non_null(strstr(fault.text, "no exact layer"));
	assert_non_null(strstr(fault.text, s.path));
	synthetic_close(&s);
}

TEST("unknown chunks are passed over")
{
	struct synthetic *s = *state;
	struct copied copy = copied_file(s->path);
	struct fault fault;

	copied_chunk(&copy, BASIS_CHUNK_CAMERA)->type = BASIS_FOURCC('N', 'E', 'W', '1');
	synthetic_reseal(copy.data, copy.bytes);
	assert_int_equal(copied_open(&copy, &fault), 0);
	copied_free(&copy);
}

/* Packed lines of every code unpack to the same values, and take the bytes that the format says. */
TEST("lines come back")
{
	struct chance chance = chance_begin("lines");

	for (int code = 0; code <= UINT8_MAX; code++) {
		const bool whole = code == BASIS_LINE_WHOLE;
		const int unit = whole ? 1 : code, top = whole ? 127 : code ? 7 : 0;
		int8_t value[BASIS_LINE8], back[BASIS_LINE8];
		uint8_t packed[BASIS_LINE8 + 1];
		size_t bytes;

		if (code > BASIS_LINE_FACTOR_MAX && !whole)
			continue;
		for (int k = 0; k < BASIS_LINE8; k++)
			value[k] = (int8_t)(unit * (k < 2 ? top * (2 * k - 1)
							  : chance_int(&chance, -top, top)));
		memset(packed, 0xa5, sizeof(packed));
		bytes = basis_line_pack((uint8_t)code, value, packed);
		expect_equal(bytes, whole ? 64 : code ? 32 : 0, "code=%d", code);
		expect_equal(packed[bytes], 0xa5, "code=%d", code);
		basis_line_unpack((uint8_t)code, packed, back);
		assert_memory_equal(back, value, sizeof(value));
	}
}

TEST_GROUP(copied_setup, copied_teardown);
