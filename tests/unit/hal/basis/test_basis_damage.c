/* SPDX-License-Identifier: MIT */
/* The basis file: any damage is refused, with a message that says what is wrong and where. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include <errno.h>

#include "hal/basis/basis_lines.h"
#include "tests/support/basis/copied_basis.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

TEST("refuses every truncation")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path);
	struct fault fault;

	assert_int_equal(copied_open(&whole, &fault), 0);
	for (size_t bytes = 0; bytes < whole.bytes; bytes += bytes < 16384 ? 64 : 1024) {
		/* Memory of exactly the remaining length, so that a sanitizer sees any read
		 * beyond. */
		struct copied cut = {aligned_alloc(BASIS_ALIGN, bytes + BASIS_ALIGN), bytes};

		assert_non_null(cut.data);
		memcpy(cut.data, whole.data, bytes);
		expect_equal(copied_open(&cut, &fault), -EBADMSG, "bytes=%zu", bytes);
		assert_memory_equal(fault.text, "mem.inlay: ", 11);
		if (bytes >= BASIS_PAGE) { /* the same, with a header that declares that length */
			((struct basis_file_header *)cut.data)->file_bytes = bytes;
			synthetic_reseal(cut.data, bytes);
			expect_equal(copied_open(&cut, &fault), -EBADMSG, "bytes=%zu", bytes);
			expect_equal(copied_open_part(&cut, BASIS_SHOWN, &fault), -EBADMSG,
				     "bytes=%zu", bytes);
		}
		free(cut.data);
	}
	copied_free(&whole);
}

static bool is_inside(const struct basis_chunk_entry *chunk, size_t byte)
{
	return byte >= chunk->offset && byte < chunk->offset + chunk->bytes;
}

TEST("refuses every flipped bit")
{
	struct chance chance = chance_begin("flipped bits");
	struct synthetic *s = *state;
	struct copied copy = copied_file(s->path);
	const struct basis_chunk_entry exact[] = {*copied_chunk(&copy, BASIS_CHUNK_EXACT_BLOCKS),
						  *copied_chunk(&copy, BASIS_CHUNK_EXACT_DATA)};
	const size_t dense = 2 * BASIS_PAGE; /* header, table and INFO: every bit */
	struct fault fault;

	for (size_t bit = 0; bit < copy.bytes * 8;) {
		const size_t byte = bit / 8;
		int ret;

		copy.data[byte] ^= (uint8_t)(1 << bit % 8);
		ret = copied_open(&copy, &fault);
		if (ret != -EBADMSG && ret != -ENOTSUP)
			fail_msg("bit %zu of byte %zu flipped, and basis_open says %d", bit % 8,
				 byte, ret);
		ret = copied_open_part(&copy, BASIS_SHOWN, &fault);
		if ((ret == 0) != (is_inside(&exact[0], byte) || is_inside(&exact[1], byte)))
			fail_msg(
				"bit %zu of byte %zu flipped, and without the exact layer it is %d",
				bit % 8, byte, ret);
		copy.data[byte] ^= (uint8_t)(1 << bit % 8);
		bit += byte < dense ? 1 + (bit > 4096 ? 30 : 0)
				    : (size_t)chance_int(&chance, 1, 8000);
	}
	assert_int_equal(copied_open(&copy, &fault), 0);
	copied_free(&copy);
}

/* Where the exact layer is not asked for, none of its bytes are read. */
TEST("leaves the exact layer alone")
{
	struct synthetic *s = *state;
	struct copied copy = copied_file(s->path);
	const struct basis_chunk_entry data = *copied_chunk(&copy, BASIS_CHUNK_EXACT_DATA);
	struct fault fault;

	/* The end of its last page may hold other data. */
	assert_true(data.bytes > 4 * BASIS_PAGE);
	assert_int_equal(
		mprotect(copy.data + data.offset, data.bytes / BASIS_PAGE * BASIS_PAGE, PROT_NONE),
		0);
	assert_int_equal(copied_open_part(&copy, BASIS_SHOWN, &fault), 0);
	copied_free(&copy);
}

/* One block of a kind, to be changed. */
struct parts {
	struct basis_block_entry *entry;
	struct basis_layout at;
	uint8_t *payload;
	uint16_t *pixel, *tint, *light;
	float *pattern_scale, *column_scale;
	int16_t *pattern, *coefficient, *column16;
	uint32_t *record_at;
	uint8_t *record;
};

/* Block number n of a kind in a layer. */
static struct parts find_block(const struct copied *c, bool exact, enum basis_kind kind, int nth)
{
	const uint32_t blocks = exact ? BASIS_CHUNK_EXACT_BLOCKS : BASIS_CHUNK_BLOCKS;
	struct basis_block_entry *e = copied_data(c, blocks);
	const size_t count = copied_chunk(c, blocks)->bytes / sizeof(*e);
	const int coarse =
		(int)((struct basis_info_chunk *)copied_data(c, BASIS_CHUNK_INFO))->coarse;
	size_t i = 0;
	struct parts b;

	while (i < count && (e[i].kind != kind || nth-- > 0))
		i++;
	assert_true(i < count);
	b.entry = &e[i];
	b.at = basis_layout(&e[i], coarse);
	b.payload = (uint8_t *)copied_data(c, exact ? BASIS_CHUNK_EXACT_DATA : BASIS_CHUNK_DATA) +
		    e[i].offset;
	b.pixel = (uint16_t *)(b.payload + b.at.pixel);
	b.tint = (uint16_t *)(b.payload + b.at.tint);
	b.pattern_scale = (float *)(b.payload + b.at.pattern_scale);
	b.pattern = (int16_t *)(b.payload + b.at.pattern);
	b.coefficient = (int16_t *)(b.payload + b.at.coefficient);
	b.light = (uint16_t *)(b.payload + b.at.light);
	b.column_scale = (float *)(b.payload + b.at.column_scale);
	b.column16 = (int16_t *)(b.payload + b.at.column);
	b.record_at = (uint32_t *)(b.payload + b.at.column);
	b.record = b.payload + b.at.record;
	return b;
}

/* Checks that a file with right checksums is refused with a message that contains `text`, and
 * restores it. */
static void refused(struct copied *broken, const struct copied *whole, int line, const char *text)
{
	struct fault fault;
	int ret;

	synthetic_reseal(broken->data, broken->bytes);
	ret = copied_open(broken, &fault);
	if (ret != -EBADMSG || !strstr(fault.text, text))
		fail_msg("line %d: %d, \"%s\", expected \"%s\"", line, ret, fault.text, text);
	memcpy(broken->data, whole->data, whole->bytes);
}

#define REFUSED(text, change)                                                                      \
	do {                                                                                       \
		change;                                                                            \
		refused(&c, &whole, __LINE__, text);                                               \
	} while (0)

TEST("refuses broken numbers")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	struct basis_info_chunk *info = copied_data(&c, BASIS_CHUNK_INFO);
	struct basis_light *lights = copied_data(&c, BASIS_CHUNK_DOME);
	double *ground = copied_data(&c, BASIS_CHUNK_GROUND);
	float *peak = copied_data(&c, BASIS_CHUNK_PEAK);
	char *camera = copied_data(&c, BASIS_CHUNK_CAMERA);
	double *errors[] = {&info->column_cut, &info->object_error, &info->ratio_error,
			    &info->sky_rms,    &info->sky_max,	    &info->cell_rms,
			    &info->cell_max,   &info->noise_levels};
	struct fault fault;

	synthetic_reseal(c.data, c.bytes); /* this change alone breaks nothing */
	assert_int_equal(copied_open(&c, &fault), 0);
	info->light_shape = 1;
	synthetic_reseal(c.data, c.bytes);
	assert_int_equal(copied_open(&c, &fault), -ENOTSUP);
	assert_non_null(
		strstr(fault.text, "its lights are tents, expected cells: bake the scene again"));
	info->light_shape = 0;

	REFUSED("pixels, expected", info->width = 0);
	REFUSED("pixels, expected", info->height = 20000);
	REFUSED("0 lights, expected", info->lights = 0);
	REFUSED("40000 lights, expected", info->lights = 40000);
	REFUSED("DOME chunk of", info->lights = 51);
	REFUSED("GRND chunk of", info->grounds = 3);
	REFUSED("ground terms, expected", info->grounds = UINT32_MAX);
	REFUSED("poses in", info->poses = UINT32_MAX);
	REFUSED("poses in", info->poses = 0);
	REFUSED("pose 1 has no BLCK", info->poses = 2);
	REFUSED("COVR chunk of", info->width = 38);
	REFUSED("0 coarse lights, expected 1 to 50", info->coarse = 0);
	REFUSED("51 coarse lights, expected 1 to 50", info->coarse = 51);
	REFUSED("COAR chunk of 600 bytes, expected 0", info->coarse = 50);
	REFUSED("light shape 2 (and 0), expected", info->light_shape = 2);
	REFUSED("light shape 0 (and 1), expected", info->reserved = 1);
	for (int i = 0; i < 8; i++) {
		char text[40];

		snprintf(text, sizeof(text), "declared error %d is", i);
		REFUSED(text, *errors[i] = NAN);
		REFUSED(text, *errors[i] = -1);
		REFUSED(text, *errors[i] = INFINITY);
	}
	REFUSED("direction 3", lights[3].direction[1] = 2);
	REFUSED("direction 3", lights[3].direction[1] = NAN);
	REFUSED("solid angle 0", lights[0].solid_angle_sr = -1);
	REFUSED("solid angle 49", lights[49].solid_angle_sr = NAN);
	REFUSED("solid angle 7", lights[7].solid_angle_sr = 1e300);
	REFUSED("value 5 of the ground", ground[5] = NAN);
	REFUSED("value 5 of the ground", ground[5] = -1);
	REFUSED("value 5 of the ground", ground[5] = 1e300);
	REFUSED("peak 0", peak[2] = INFINITY);
	REFUSED("peak 50", peak[150] = -1);
	REFUSED("only NUL", camera[2] = 0);
	REFUSED("only NUL", camera[strlen(camera)] = 'x');
	copied_free(&whole);
	copied_free(&c);
}

TEST("refuses broken gathers")
{
	static const struct {
		const char *text;
		struct basis_coarse wrong;
	} cases[] = {
		{"coarse light 20 (weight 32768) of light 7", {{20}, {32768}}},
		{"coarse light 65535", {{0, 65535}, {1, 32767}}},
		{"coarse light 3 (weight 5)", {{3, 3}, {32763, 5}}},
		{"coarse light 2 (weight 5)", {{3, 2}, {32763, 5}}},
		{"coarse light 4 (weight 5)", {{3, 9, 4}, {32758, 5, 5}}},
		{"coarse light 1 (weight 0)", {{1}, {0}}},
		{"coarse light 9 (weight 0)", {{3, 9}, {32768, 0}}},
		{"coarse light 9 (weight 32768)", {{0, 9}, {0, 32768}}},
		{"coarse light 9 (weight 1)", {{3, 0, 9}, {32767, 0, 1}}},
		{"weights of light 7 sum to 0, expected 32768", {{0}, {0}}},
		{"sum to 32769", {{3, 9}, {32768, 1}}},
		{"sum to 32767", {{3, 9, 19}, {32765, 1, 1}}},
		{"sum to 98304", {{3, 9, 19}, {32768, 32768, 32768}}},
	};
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	struct basis_coarse *coarse = copied_data(&c, BASIS_CHUNK_COARSE);

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++)
		REFUSED(cases[i].text, coarse[7] = cases[i].wrong);
	copied_free(&whole);
	copied_free(&c);
}

TEST("refuses broken chunks")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	struct basis_chunk_entry *dome = copied_chunk(&c, BASIS_CHUNK_DOME);
	struct basis_chunk_entry *last = copied_chunk(&c, BASIS_CHUNK_PROVENANCE);

	REFUSED("no INFO", copied_chunk(&c, BASIS_CHUNK_INFO)->type = 77);
	REFUSED("no BLCK and DATA", copied_chunk(&c, BASIS_CHUNK_DATA)->type = 77);
	REFUSED("no BLCK and DATA", copied_chunk(&c, BASIS_CHUNK_BLOCKS)->type = 77);
	REFUSED("one of BLCX and DATX", copied_chunk(&c, BASIS_CHUNK_EXACT_DATA)->type = 77);
	REFUSED("one of BLCX and DATX", copied_chunk(&c, BASIS_CHUNK_EXACT_BLOCKS)->type = 77);
	REFUSED("COAR chunk of 0 bytes", copied_chunk(&c, BASIS_CHUNK_COARSE)->type = 77);
	REFUSED("COVR chunk of 0 bytes", copied_chunk(&c, BASIS_CHUNK_COVERAGE)->type = 77);
	REFUSED("PEAK chunk of 0 bytes", copied_chunk(&c, BASIS_CHUNK_PEAK)->type = 77);
	REFUSED("DOME chunk of 0 bytes", dome->type = 77);
	REFUSED("twice", copied_chunk(&c, BASIS_CHUNK_CAMERA)->type = BASIS_CHUNK_DOME);
	REFUSED("twice", copied_chunk(&c, BASIS_CHUNK_CAMERA)->type = BASIS_CHUNK_DATA);
	REFUSED("twice", copied_chunk(&c, BASIS_CHUNK_CAMERA)->type = BASIS_CHUNK_EXACT_DATA);
	REFUSED("belongs to pose 1", dome->pose = 1);
	REFUSED("belongs to pose 1", copied_chunk(&c, BASIS_CHUNK_COARSE)->pose = 1);
	REFUSED("belongs to pose 9", copied_chunk(&c, BASIS_CHUNK_PEAK)->pose = 9);
	REFUSED("belongs to pose 1 of 1", copied_chunk(&c, BASIS_CHUNK_EXACT_DATA)->pose = 1);
	REFUSED("expected a multiple of", dome->offset += 64);
	REFUSED("after the chunk before", dome->offset = BASIS_PAGE);
	REFUSED("inside the file", last->offset = UINT64_MAX - 4095);
	REFUSED("inside the file", last->bytes = UINT64_MAX);
	REFUSED("are not 0", c.data[2 * BASIS_PAGE - 1] = 1);
	REFUSED("after the last chunk", last->bytes = 0);
	REFUSED("BLCK chunk", copied_chunk(&c, BASIS_CHUNK_BLOCKS)->bytes += 8);
	REFUSED("BLCX chunk", copied_chunk(&c, BASIS_CHUNK_EXACT_BLOCKS)->bytes += 8);
	copied_free(&whole);
	copied_free(&c);
}

TEST("refuses broken glass")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	struct basis_chunk_entry *chunk = copied_chunk(&c, BASIS_CHUNK_GLASS);
	struct basis_glass *glass = copied_data(&c, BASIS_CHUNK_GLASS);
	const size_t last = chunk->bytes / sizeof(*glass) - 1;

	assert_true(last > 20);
	REFUSED("GLAS chunk of", chunk->bytes--);
	REFUSED("pixel 0 that is seen through is 37,", glass[0].x = 37);
	REFUSED("expected one of 37x21", glass[last].y = 21);
	REFUSED("pixel 4 that is seen through", glass[4] = glass[3]);
	REFUSED("expected the order of tiles, rows and columns", glass[4] = glass[2]);
	REFUSED("expected the order of tiles, rows and columns", glass[1] = glass[last]);
	REFUSED("belongs to pose 1 of 1", chunk->pose = 1);
	REFUSED("twice", copied_chunk(&c, BASIS_CHUNK_CAMERA)->type = BASIS_CHUNK_GLASS);
	copied_free(&whole);
	copied_free(&c);
}

TEST("refuses broken mirrors")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	struct basis_chunk_entry *chunk = copied_chunk(&c, BASIS_CHUNK_MIRROR);
	struct basis_mirror *mirror = copied_data(&c, BASIS_CHUNK_MIRROR);
	const size_t last = chunk->bytes / sizeof(*mirror) - 1;

	assert_true(last > 20);
	REFUSED("MIRR chunk of", chunk->bytes--);
	REFUSED("mirror 0 is number 1 of pixel 37,", mirror[0].x = 37);
	REFUSED("18 of a pixel of 37x21", mirror[last].y = 21);
	REFUSED("at level 2305", mirror[1].level = 2305);
	REFUSED("expected the order of tiles, rows and columns", mirror[0] = mirror[last]);
	REFUSED("mirror 18 is number 19 of pixel",
		for (int k = 1; k < 19; k++) mirror[k] = mirror[0]);
	REFUSED("belongs to pose 1 of 1", chunk->pose = 1);
	REFUSED("twice", copied_chunk(&c, BASIS_CHUNK_CAMERA)->type = BASIS_CHUNK_MIRROR);
	copied_free(&whole);
	copied_free(&c);
}

TEST("refuses broken entries")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	const struct parts t = find_block(&c, false, BASIS_KIND_T, 0);
	const struct parts v = find_block(&c, false, BASIS_KIND_V, 0);
	const struct parts x = find_block(&c, true, BASIS_KIND_T, 0);

	REFUSED("pose 0, block 0: tile 6, expected less than 6", t.entry->tile = 6);
	REFUSED("kind 4", t.entry->kind = 4);
	REFUSED("0 pixels", t.entry->pixels = 0);
	REFUSED("257 pixels", t.entry->pixels = 257);
	REFUSED("2 channels", t.entry->channels = 2);
	REFUSED("tinted 1 with 3 channels", t.entry->tinted = 1);
	REFUSED("tinted 2", (t.entry->tinted = 2, t.entry->channels = 1));
	REFUSED("1025 patterns", t.entry->patterns = 1025);
	REFUSED("51 columns", t.entry->columns = 51);
	REFUSED("columns, expected at most 50", t.entry->columns = UINT32_MAX);
	REFUSED("0 patterns and columns", t.entry->patterns = 0; t.entry->columns = 0);
	REFUSED("7 bits", t.entry->bits = 7);
	REFUSED("0 bits", t.entry->bits = 0);
	REFUSED("8 bits, expected 16, or 8 where", t.entry->columns = 0);
	REFUSED("ground term 2, expected less", v.entry->ground = 2);
	REFUSED("ground term 1, expected 0", t.entry->ground = 1);
	REFUSED("bytes of records for 50 columns of 16 bits, expected", x.entry->record_bytes = 1);
	REFUSED("bytes of records for", t.entry->record_bytes = UINT32_MAX);
	REFUSED("0 bytes of records for", t.entry->record_bytes = 0);
	REFUSED("bytes, expected", t.entry->bytes -= 64);
	REFUSED("bytes, expected", t.entry->columns += 32);
	REFUSED("a share 0 of the cut", t.entry->cut_share = 0);
	REFUSED("a share -0.5 of the cut", t.entry->cut_share = -0.5F);
	REFUSED("nan of the cut", t.entry->cut_share = NAN);
	REFUSED("a share inf of the cut", v.entry->cut_share = INFINITY);
	REFUSED("a share 1.5 of the cut, expected above 0, at most 1", t.entry->cut_share = 1.5F);
	REFUSED("of the cut", t.entry->cut_share = 0x1.000002p0F);
	REFUSED("exact block 0: a share 0 of the cut", x.entry->cut_share = 0);
	REFUSED("1 in reserved bytes, expected 0", t.entry->reserved = 1);
	REFUSED("exact block 0: 7 in reserved bytes", x.entry->reserved = 7);
	REFUSED("lies at byte", t.entry->offset = UINT64_MAX - 63);
	REFUSED("lies at byte", v.entry->offset = 0);
	REFUSED("lies at byte", v.entry->offset += 32);
	REFUSED("order of tiles, then of kinds", t.entry->tile = 1);
	REFUSED("tile 0, kind T after tile 0, kind U", t.entry->kind = BASIS_KIND_U);
	REFUSED("exact block 0: 1 patterns", x.entry->patterns = 1);
	REFUSED("exact block 0: 0 patterns and 49 columns", x.entry->columns = 49);
	REFUSED("exact block 0: 0 patterns and 50 columns of 8 bits", x.entry->bits = 8);
	REFUSED("bits, tinted, expected", x.entry->channels = 1; x.entry->tinted = 1);
	copied_free(&whole);
	copied_free(&c);
}

static void remove_last_block(const struct copied *c)
{
	struct basis_chunk_entry *chunk = copied_chunk(c, BASIS_CHUNK_BLOCKS);

	chunk->bytes -= sizeof(struct basis_block_entry);
	memset(c->data + chunk->offset + chunk->bytes, 0, sizeof(struct basis_block_entry));
}

/* Blocks of one tile that contradict each other. The first tile of `copied_small` has T T V V V' V'
 * D D U; each second block lies over the first. */
TEST("refuses what does not add up")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	const struct parts v = find_block(&c, false, BASIS_KIND_V, 1);
	const struct parts last_v = find_block(&c, false, BASIS_KIND_V, 3);
	const struct parts u = find_block(&c, false, BASIS_KIND_U, 0);
	const struct parts last_u = find_block(&c, false, BASIS_KIND_U, 5);
	const struct basis_block_entry *first = copied_data(&c, BASIS_CHUNK_BLOCKS);
	const struct parts corner = find_block(&c, false, BASIS_KIND_T, 2 * 2);

	assert_true(first[8].kind == BASIS_KIND_U && first[9].tile == 1 && first + 8 == u.entry);
	assert_int_equal(corner.entry->tile, 2);
	REFUSED("expected that before", v.entry->ground ^= 1);
	REFUSED("has a V row already", last_v.entry->kind = BASIS_KIND_D; last_v.entry->ground = 0);
	REFUSED("block 9: before it, pixel", u.entry->kind = BASIS_KIND_D);
	REFUSED("of tile 5 has a D row and no U", last_u.entry->kind = BASIS_KIND_D);
	REFUSED("after the last block", remove_last_block(&c));
	REFUSED("pixel 256, expected", u.pixel[u.entry->pixels - 1] = 256);
	REFUSED("ascending numbers inside", u.pixel[1] = u.pixel[0]);
	REFUSED("inside a tile of 5x16", corner.pixel[0] = 5);
	REFUSED("inside a tile of 16x5",
		find_block(&c, false, BASIS_KIND_U, 3).pixel[0] = 5 * BASIS_TILE);
	copied_free(&whole);
	copied_free(&c);
}

/* The first line of a column of 8 bits, or the first of its last panel, that is stored whole or as
 * nibbles. */
static uint8_t *find_line(const struct parts *b, bool whole, bool last)
{
	const int lines = b->at.panels8 * b->entry->channels;

	for (uint32_t n = 0; n < b->entry->columns; n++) {
		const uint8_t *code = b->record + b->record_at[n];
		uint8_t *line = b->record + b->record_at[n] + basis_record_head(lines);

		for (int k = 0; k < lines; line += basis_line_bytes(code[k++]))
			if (code[k] && (code[k] == BASIS_LINE_WHOLE) == whole &&
			    (!last || k >= lines - b->entry->channels))
				return line;
	}
	fail_msg("no column has such a line");
	return NULL;
}

TEST("refuses broken records")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	const struct parts t = find_block(&c, false, BASIS_KIND_T, 0);
	const int lines = t.at.panels8 * t.entry->channels, after = t.entry->pixels % BASIS_LINE8;
	const uint32_t last = t.entry->columns - 1;
	uint8_t *code = t.record + t.record_at[last];

	assert_true(lines % BASIS_RECORD_ALIGN && after && after < BASIS_LINE_HALF);
	REFUSED("code 19 in column 0, expected at most 18, or 255", t.record[0] = 19);
	REFUSED("code 254 in column", code[lines - 1] = 254);
	REFUSED("column 0 lies at byte 4, expected 0", t.record_at[0] = 4);
	REFUSED("column 1 lies at byte", t.record_at[1] = UINT32_MAX);
	REFUSED("column 1 lies at byte", memset(t.record, 0, (size_t)lines));
	REFUSED("bytes, expected at most", memset(code, BASIS_LINE_WHOLE, (size_t)lines));
	REFUSED("columns take", memset(code, 0, (size_t)lines));
	REFUSED("padding of column 0", t.record[lines] = 1);
	REFUSED("value -128 in column", find_line(&t, true, false)[0] = 0x80);
	REFUSED("value 8 in column", find_line(&t, false, false)[31] |= 0x0f);
	REFUSED("value 8 in column", find_line(&t, false, false)[31] |= 0xf0);
	REFUSED("after the last pixel", find_line(&t, true, true)[after] = 1);
	REFUSED("after the last pixel", find_line(&t, false, true)[after] ^= 1);
	REFUSED("after the last pixel", find_line(&t, false, true)[0] ^= 0x10);
	copied_free(&whole);
	copied_free(&c);
}

/* Columns of groups are valid only where columns may be left out: in the shown layer, of T and V.
 */
TEST("refuses groups elsewhere")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	const struct parts t = find_block(&c, false, BASIS_KIND_T, 0);
	const struct parts v = find_block(&c, false, BASIS_KIND_V, 0);
	const struct parts d = find_block(&c, false, BASIS_KIND_D, 0);
	const struct parts x = find_block(&c, true, BASIS_KIND_T, 0);
	struct basis_info_chunk *info = copied_data(&c, BASIS_CHUNK_INFO);
	struct fault fault;

	info->column_cut = 0.001;
	t.light[4] = 69;
	v.light[4] = 69;
	synthetic_reseal(c.data, c.bytes);
	assert_int_equal(copied_open(&c, &fault), 0);
	memcpy(whole.data, c.data, c.bytes);
	REFUSED("light 70, expected ascending numbers below 70", t.light[4] = 70);
	REFUSED("light 50, expected ascending numbers below 50", d.light[4] = 50);
	REFUSED("light 50, expected ascending numbers below 50", x.light[49] = 50);
	REFUSED("light 69, expected ascending numbers below 50", info->column_cut = 0);
	REFUSED("71 columns, expected at most 70", t.entry->columns = 71);
	copied_free(&whole);
	copied_free(&c);
}

TEST("refuses broken arrays")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	const struct parts t = find_block(&c, false, BASIS_KIND_T, 0);
	const struct parts x = find_block(&c, true, BASIS_KIND_U, 0);
	const int after = t.entry->pixels % BASIS_LINE16;
	const int after_x = x.entry->pixels % BASIS_LINE16;

	assert_true(after && after_x);
	REFUSED("light 50, expected", t.light[4] = 50);
	REFUSED("light 65535, expected", t.light[4] = UINT16_MAX);
	REFUSED("ascending numbers below 50", t.light[1] = t.light[0]);
	REFUSED("padding between", ((uint8_t *)t.pattern_scale)[-1] = 1);
	REFUSED("padding between", ((uint8_t *)t.pattern)[-1] = 1);
	REFUSED("padding between", ((uint8_t *)t.column_scale)[-1] = 1);
	REFUSED("padding between", ((uint8_t *)t.record_at)[-1] = 1);
	REFUSED("padding between", t.record[-1] = 1);
	REFUSED("padding between", t.payload[t.at.bytes - 1] = 1);
	REFUSED("padding between", t.light[5] = 1);
	REFUSED("padding of pattern 2", t.pattern[2 * 32 + 20] = 1);
	REFUSED("padding of pattern 0", t.pattern[31] = 1);
	REFUSED("value -32768 in pattern 1", t.pattern[32 + 19] = INT16_MIN);
	REFUSED("value -32768 among coefficients", t.coefficient[0] = INT16_MIN);
	REFUSED("value -32768 among columns", x.column16[0] = INT16_MIN);
	REFUSED("coefficients after the last",
		t.coefficient[(t.at.panels16 - 1) * 3 * BASIS_LINE16 + after] = 1);
	REFUSED("coefficients after the last", ((int16_t *)(t.payload + t.at.light))[-1] = 1);
	REFUSED("columns after the last",
		x.column16[(x.at.panels16 - 1) * 50 * BASIS_LINE16 + after_x] = 1);
	REFUSED("columns after the last", x.payload[x.at.bytes - 1] = 1);
	copied_free(&whole);
	copied_free(&c);
}

TEST("refuses broken tints")
{
	struct synthetic_options o = copied_small;
	struct synthetic s;
	struct copied whole, c;
	struct fault fault;
	struct parts t;

	o.grey = o.tinted = true;
	synthetic_open(&s, &o);
	whole = copied_file(s.path);
	c = copied_file(s.path);
	t = find_block(&c, false, BASIS_KIND_T, 0);
	memset(t.tint, 0xff, 3 * t.entry->pixels * sizeof(uint16_t)); /* any value is valid */
	synthetic_reseal(c.data, c.bytes);
	assert_int_equal(copied_open(&c, &fault), 0);
	memcpy(c.data, whole.data, whole.bytes);
	REFUSED("padding between", t.tint[-1] = 1);
	REFUSED("padding between", t.tint[3 * t.entry->pixels] = 1);
	copied_free(&whole);
	copied_free(&c);
	synthetic_close(&s);
}

/* Scales up to the largest that keeps values in bounds are valid, the next float is not. */
TEST("bounds values")
{
	struct synthetic *s = *state;
	struct copied whole = copied_file(s->path), c = copied_file(s->path);
	const struct parts t = find_block(&c, false, BASIS_KIND_T, 0);
	const struct parts x = find_block(&c, true, BASIS_KIND_T, 0);
	float *scales[] = {&t.column_scale[4], &x.column_scale[49], &t.pattern_scale[1]};
	const char *names[] = {"of column 4", "of column 49", "of pattern 1"};
	double times[] = {127, 32767, 0};

	for (int k = 0; k < 20; k++)
		times[2] += 32767.0 * abs(t.pattern[32 + k]);
	for (int i = 0; i < 3; i++) {
		float most = (float)(BASIS_VALUE_MAX / times[i]);
		struct fault fault;

		if ((double)most * times[i] > BASIS_VALUE_MAX)
			most = nextafterf(most, 0);
		*scales[i] = most;
		synthetic_reseal(c.data, c.bytes);
		assert_int_equal(copied_open(&c, &fault), 0);
		*scales[i] = 0;
		synthetic_reseal(c.data, c.bytes);
		assert_int_equal(copied_open(&c, &fault), 0);
		REFUSED("makes values of", *scales[i] = nextafterf(most, INFINITY));
		REFUSED(names[i], *scales[i] = nextafterf(most, INFINITY));
		REFUSED(names[i], *scales[i] = 3e38F);
		REFUSED("scale nan", *scales[i] = NAN);
		REFUSED("scale inf", *scales[i] = INFINITY);
		REFUSED("scale -1", *scales[i] = -1);
		REFUSED("scale -0", *scales[i] = -0.0F);
		REFUSED(names[i], *scales[i] = -0.0F);
	}
	copied_free(&whole);
	copied_free(&c);
}

TEST_GROUP(copied_setup, copied_teardown);
