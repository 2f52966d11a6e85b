/* The basis file: what is written is read back, and whatever is damaged is refused in a sentence.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>

#include "hal/basis/basis_layout.h"
#include "tests/synthetic_basis.h"

static const struct synthetic_options small = {
	.width = 37,
	.height = 21,
	.lights = 50,
	.grounds = 2,
	.receiver_lights = 9,
	.object_share = 0.3,
	.ground_share = 0.3,
	.stand_in_share = 0.3,
	.peak = 1,
	.bounce = 0.3,
	.seed = 7,
};

/* A whole file in memory that may be changed. */
struct copy {
	uint8_t *data;
	size_t bytes;
};

static struct copy copy_file(const char *path)
{
	struct copy copy = {0};
	FILE *stream = fopen(path, "rb");
	struct stat s;

	assert_non_null(stream);
	assert_int_equal(fstat(fileno(stream), &s), 0);
	copy.bytes = (size_t)s.st_size;
	copy.data = aligned_alloc(BASIS_PAGE,
				  (copy.bytes + BASIS_PAGE - 1) / BASIS_PAGE * BASIS_PAGE);
	assert_non_null(copy.data);
	assert_int_equal(fread(copy.data, 1, copy.bytes, stream), copy.bytes);
	fclose(stream);
	return copy;
}

static int try_open(const struct copy *copy, size_t bytes, struct fault *fault)
{
	struct basis basis;
	int ret;

	fault->text[0] = '\0';
	ret = basis_open_memory(&basis, copy->data, bytes, "mem.inlay", fault);
	basis_close(&basis);
	return ret;
}

static struct basis_chunk_entry *find_chunk(const struct copy *copy, uint32_t type)
{
	struct basis_file_header *header = (struct basis_file_header *)copy->data;
	struct basis_chunk_entry *chunk = (struct basis_chunk_entry *)(header + 1);

	for (uint32_t i = 0; i < header->chunk_count; i++) {
		if (chunk[i].type == type)
			return &chunk[i];
	}
	fail_msg("chunk %08x is missing", type);
	return NULL;
}

static void *chunk_data(const struct copy *copy, uint32_t type)
{
	return copy->data + find_chunk(copy, type)->offset;
}

static int setup(void **state)
{
	struct synthetic *s = calloc(1, sizeof(*s));

	assert_non_null(s);
	synthetic_open(s, &small);
	*state = s;
	return 0;
}

static int teardown(void **state)
{
	synthetic_close(*state);
	free(*state);
	return 0;
}

/* ---- whole files ---- */

static void writes_and_reads_back(void **state)
{
	enum { LIGHTS = 3, POSES = 2 };
	const struct basis_light lights[LIGHTS] = {{{1, 0, 0}, 1}, {{0, 1, 0}, 2}, {{0, 0, 1}, 3}};
	const double ground[1][3][LIGHTS] = {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}};
	struct basis_info_chunk info = {.width = 17,
					.height = 3,
					.lights = LIGHTS,
					.dome_frequency = 1,
					.grounds = 1,
					.poses = POSES};
	const struct basis_layout at = basis_layout(BASIS_KIND_T, 2, 1, 2);
	struct basis_block_payload block = {.entry = {.tile = 1,
						      .kind = BASIS_KIND_T,
						      .encoding = BASIS_ENCODING_DENSE,
						      .pixels = 2,
						      .channels = 1,
						      .lights = 2}};
	uint16_t coverage[17 * 3];
	float peak[LIGHTS + 1][3] = {{0.5F, 0.25F, 0}, {1, 2, 3}, {0, 0, 0}, {9, 8, 7}};
	uint8_t payload[1024] __attribute__((aligned(64))) = {0};
	struct basis_writer *writer;
	struct fault fault = {""};
	struct basis basis;
	struct synthetic *s = *state;
	char path[100];

	snprintf(path, sizeof(path), "%s/two.inlay", s->folder);
	assert_true(at.bytes <= sizeof(payload));
	((uint16_t *)(payload + at.pixel))[1] = 2 * BASIS_TILE;
	((uint16_t *)(payload + at.light))[0] = 1;
	((uint16_t *)(payload + at.light))[1] = 2;
	((float *)(payload + at.scale))[0] = 0.5F;
	((int16_t *)(payload + at.row))[0] = 32767;
	((int16_t *)(payload + at.row))[1] = -5;
	((int32_t *)(payload + at.total))[0] = 32762;
	block.entry.bytes = at.bytes;
	block.payload = payload;
	for (int i = 0; i < 17 * 3; i++)
		coverage[i] = (uint16_t)(i * 1000);

	assert_int_equal(basis_writer_open(&writer, path, &info, lights, &ground[0][0][0],
					   "[camera]\nf = 1\n", &fault),
			 0);
	assert_int_equal(basis_writer_blocks(writer, &block, 1, &fault), 0);
	assert_int_equal(basis_writer_pose_end(writer, coverage, (const float(*)[3])peak, &fault),
			 0);
	assert_int_equal(basis_writer_pose_end(writer, coverage, (const float(*)[3])peak, &fault),
			 0);
	info.object_error = 0.125;
	info.ratio_error = 0.25;
	info.noise_levels = 0.5;
	assert_int_equal(access(path, F_OK), -1); /* not before it is whole */
	assert_int_equal(basis_writer_finish(writer, &info, "seed = 1\n", &fault), 0);

	assert_int_equal(basis_open(&basis, path, &fault), 0);
	assert_memory_equal(&basis.info, &info, sizeof(info));
	assert_memory_equal(basis.lights, lights, sizeof(lights));
	assert_memory_equal(basis_ground(&basis, 0, 1), ground[0][1], sizeof(ground[0][1]));
	assert_string_equal(basis.camera, "[camera]\nf = 1\n");
	assert_string_equal(basis.provenance, "seed = 1\n");
	assert_int_equal(basis.tiles_across, 2);
	assert_int_equal(basis.tiles_down, 1);
	for (int p = 0; p < POSES; p++) {
		const struct basis_pose *pose = &basis.poses[p];

		assert_memory_equal(pose->coverage, coverage, sizeof(coverage));
		assert_memory_equal(pose->peak, peak, sizeof(peak));
		assert_int_equal(pose->block_count, p == 0);
		assert_int_equal(pose->tiles[0].block_count, 0);
		assert_int_equal(pose->tiles[1].block_count, p == 0);
		assert_int_equal(pose->tiles[1].x, 16);
		assert_int_equal(pose->tiles[1].width, 1);
		assert_int_equal(pose->tiles[1].height, 3);
	}
	assert_int_equal(basis.poses[0].blocks[0].pixel[1], 2 * BASIS_TILE);
	assert_int_equal(basis.poses[0].blocks[0].light[1], 2);
	assert_int_equal(basis.poses[0].blocks[0].stride, 32);
	assert_int_equal(basis.poses[0].blocks[0].row[1], -5);
	assert_int_equal((uintptr_t)basis.poses[0].blocks[0].row % BASIS_ALIGN, 0);
	basis_close(&basis);
	basis_close(&basis);
	unlink(path);
}

static void a_failed_writer_leaves_nothing(void **state)
{
	const struct basis_light light = {{0, 0, 1}, 1};
	struct basis_info_chunk info = {.width = 1, .height = 1, .lights = 1, .poses = 2};
	const uint16_t coverage = 0;
	const float peak[2][3] = {{0}};
	struct basis_writer *writer;
	struct fault fault = {""};
	struct synthetic *s = *state;
	char path[100];

	snprintf(path, sizeof(path), "%s/none.inlay", s->folder);
	assert_int_equal(basis_writer_open(&writer, path, &info, &light, NULL, "", &fault), 0);
	assert_int_equal(basis_writer_pose_end(writer, &coverage, peak, &fault), 0);
	assert_int_equal(basis_writer_finish(writer, &info, "", &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "1 poses finished, expected 2"));
	assert_int_equal(access(path, F_OK), -1);

	assert_int_equal(basis_writer_open(&writer, path, &info, &light, NULL, "", &fault), 0);
	basis_writer_abandon(writer);
	basis_writer_abandon(NULL);
	assert_int_equal(rmdir(s->folder), -1); /* holds the other file, and nothing else: */
	assert_int_equal(unlink(s->path), 0);
	assert_int_equal(rmdir(s->folder), 0);
	assert_int_equal(mkdir(s->folder, 0700), 0);
	synthetic_write(s, &small);

	info.lights = 0;
	assert_int_equal(basis_writer_open(&writer, path, &info, &light, NULL, "", &fault),
			 -EINVAL);
	assert_null(writer);
	info.lights = 1;
	assert_int_equal(basis_writer_open(&writer, "/nowhere/at/all.inlay", &info, &light, NULL,
					   "", &fault),
			 -ENOENT);
}

static void writing_twice_gives_the_same_bytes(void **state)
{
	struct synthetic *s = *state;
	struct copy first = copy_file(s->path), second;

	synthetic_write(s, &small);
	second = copy_file(s->path);
	assert_int_equal(first.bytes, second.bytes);
	assert_memory_equal(first.data, second.data, first.bytes);
	free(first.data);
	free(second.data);
}

static void write_file(const char *path, const void *data, size_t bytes)
{
	FILE *stream = fopen(path, "wb");

	assert_non_null(stream);
	assert_int_equal(fwrite(data, 1, bytes, stream), bytes);
	assert_int_equal(fclose(stream), 0);
}

static void names_what_is_not_a_basis(void **state)
{
	struct synthetic *s = *state;
	struct fault fault = {""};
	struct basis basis;
	char path[100];

	snprintf(path, sizeof(path), "%s/bad.inlay", s->folder);
	assert_int_equal(basis_open(&basis, path, &fault), -ENOENT);
	assert_non_null(strstr(fault.text, "bad.inlay"));
	assert_int_equal(basis_open(&basis, s->folder, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "not a plain file"));
	write_file(path, "", 0);
	assert_int_equal(basis_open(&basis, path, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "empty"));
	write_file(path, "GIF89a and more", 15);
	assert_int_equal(basis_open(&basis, path, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "not a basis file"));
	write_file(path, BASIS_MAGIC "\2\0\0\0abcdefghijklmnopqrstuvwxyz", 36);
	assert_int_equal(basis_open(&basis, path, &fault), -ENOTSUP);
	assert_non_null(strstr(fault.text, "version 2"));
	basis_close(&basis); /* after a failure there is nothing to close, and no harm in it */
	unlink(path);
}

/* ---- damage ---- */

static void refuses_every_truncation(void **state)
{
	struct synthetic *s = *state;
	struct copy whole = copy_file(s->path);
	struct fault fault;

	assert_int_equal(try_open(&whole, whole.bytes, &fault), 0);
	for (size_t bytes = 0; bytes < whole.bytes; bytes += 64) {
		/* Exactly as long as what is left, so that a sanitizer sees any read beyond. */
		struct copy cut = {aligned_alloc(BASIS_ALIGN, bytes + BASIS_ALIGN), bytes};

		assert_non_null(cut.data);
		memcpy(cut.data, whole.data, bytes);
		assert_int_equal(try_open(&cut, bytes, &fault), -EBADMSG);
		assert_memory_equal(fault.text, "mem.inlay: ", 11);
		free(cut.data);
	}
	free(whole.data);
}

static void refuses_every_flipped_bit(void **state)
{
	struct chance chance = chance_begin("flipped bits");
	struct synthetic *s = *state;
	struct copy copy = copy_file(s->path);
	struct fault fault;
	const size_t dense = 2 * BASIS_PAGE; /* header, table and INFO: every bit */

	for (size_t bit = 0; bit < copy.bytes * 8;) {
		int ret;

		copy.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		ret = try_open(&copy, copy.bytes, &fault);
		if (ret != -EBADMSG && ret != -ENOTSUP)
			fail_msg("bit %zu of byte %zu flipped, and basis_open says %d", bit % 8,
				 bit / 8, ret);
		copy.data[bit / 8] ^= (uint8_t)(1 << bit % 8);
		bit += bit / 8 < dense ? 1 + (bit > 4096 ? 30 : 0)
				       : (size_t)chance_int(&chance, 1, 2000);
	}
	assert_int_equal(try_open(&copy, copy.bytes, &fault), 0);
	free(copy.data);
}

/* The first block of a kind, to be changed. */
struct parts {
	struct basis_block_entry *entry;
	struct basis_layout at;
	uint8_t *payload;
	uint16_t *pixel, *light;
	float *scale;
	int32_t *total;
	int16_t *row;
};

static struct parts first_block(const struct copy *c, enum basis_kind kind)
{
	struct basis_block_entry *e = chunk_data(c, BASIS_CHUNK_BLOCKS);
	const size_t count = find_chunk(c, BASIS_CHUNK_BLOCKS)->bytes / sizeof(*e);
	size_t i = 0;
	struct parts b;

	while (i < count && e[i].kind != kind)
		i++;
	assert_true(i < count);
	b.entry = &e[i];
	b.at = basis_layout(kind, e[i].pixels, e[i].channels, (int)e[i].lights);
	b.payload = (uint8_t *)chunk_data(c, BASIS_CHUNK_DATA) + e[i].offset;
	b.pixel = (uint16_t *)(b.payload + b.at.pixel);
	b.light = (uint16_t *)(b.payload + b.at.light);
	b.scale = (float *)(b.payload + b.at.scale);
	b.total = (int32_t *)(b.payload + b.at.total);
	b.row = (int16_t *)(b.payload + b.at.row);
	return b;
}

/* A file whose checksums are right must be refused, in words that hold `text`; then it is whole
 * again. */
static void refused(struct copy *broken, const struct copy *whole, int line, const char *text)
{
	struct fault fault;
	int ret;

	synthetic_reseal(broken->data, broken->bytes);
	ret = try_open(broken, broken->bytes, &fault);
	if (ret != -EBADMSG || !strstr(fault.text, text))
		fail_msg("line %d: %d, \"%s\", expected \"%s\"", line, ret, fault.text, text);
	memcpy(broken->data, whole->data, whole->bytes);
}

#define REFUSED(text, change)                                                                      \
	do {                                                                                       \
		change;                                                                            \
		refused(&c, &whole, __LINE__, text);                                               \
	} while (0)

static void refuses_broken_chunks(void **state)
{
	struct synthetic *s = *state;
	struct copy whole = copy_file(s->path), c = copy_file(s->path);
	struct basis_info_chunk *info = chunk_data(&c, BASIS_CHUNK_INFO);
	struct basis_light *lights = chunk_data(&c, BASIS_CHUNK_DOME);
	double *ground = chunk_data(&c, BASIS_CHUNK_GROUND);
	float *peak = chunk_data(&c, BASIS_CHUNK_PEAK);
	char *camera = chunk_data(&c, BASIS_CHUNK_CAMERA);
	struct basis_chunk_entry *dome = find_chunk(&c, BASIS_CHUNK_DOME);
	struct basis_chunk_entry *last = find_chunk(&c, BASIS_CHUNK_PROVENANCE);
	struct fault fault;

	synthetic_reseal(c.data, c.bytes); /* which alone breaks nothing */
	assert_int_equal(try_open(&c, c.bytes, &fault), 0);

	REFUSED("pixels, expected", info->width = 0);
	REFUSED("pixels, expected", info->height = 20000);
	REFUSED("0 lights, expected", info->lights = 0);
	REFUSED("40000 lights, expected", info->lights = 40000);
	REFUSED("DOME chunk of", info->lights = 51);
	REFUSED("GRND chunk of", info->grounds = 3);
	REFUSED("ground terms, expected", info->grounds = UINT32_MAX);
	REFUSED("poses in", info->poses = UINT32_MAX);
	REFUSED("poses in", info->poses = 0);
	REFUSED("COVR chunk of 0", info->poses = 2);
	REFUSED("COVR chunk of", info->width = 38);
	REFUSED("reserved", info->reserved = 1);
	REFUSED("declared errors", info->ratio_error = NAN);
	REFUSED("declared errors", info->object_error = -1);
	REFUSED("declared errors", info->noise_levels = INFINITY);
	REFUSED("direction 3", lights[3].direction[1] = 2);
	REFUSED("direction 3", lights[3].direction[1] = NAN);
	REFUSED("solid angle 0", lights[0].solid_angle_sr = -1);
	REFUSED("solid angle 49", lights[49].solid_angle_sr = NAN);
	REFUSED("value 5 of the ground", ground[5] = NAN);
	REFUSED("value 5 of the ground", ground[5] = -1);
	REFUSED("value 5 of the ground", ground[5] = 1e300);
	REFUSED("peak 0", peak[2] = INFINITY);
	REFUSED("peak 50", peak[150] = -1);
	REFUSED("only NUL", camera[2] = 0);
	REFUSED("only NUL", camera[strlen(camera)] = 'x');
	REFUSED("no INFO", find_chunk(&c, BASIS_CHUNK_INFO)->type = 77);
	REFUSED("no BLCK and DATA", find_chunk(&c, BASIS_CHUNK_DATA)->type = 77);
	REFUSED("no BLCK and DATA", find_chunk(&c, BASIS_CHUNK_BLOCKS)->type = 77);
	REFUSED("twice", find_chunk(&c, BASIS_CHUNK_CAMERA)->type = BASIS_CHUNK_DOME);
	REFUSED("twice", find_chunk(&c, BASIS_CHUNK_CAMERA)->type = BASIS_CHUNK_DATA);
	REFUSED("belongs to pose 1", dome->pose = 1);
	REFUSED("belongs to pose 9", find_chunk(&c, BASIS_CHUNK_PEAK)->pose = 9);
	REFUSED("expected a multiple of", dome->offset += 64);
	REFUSED("after the chunk before", dome->offset = BASIS_PAGE);
	REFUSED("inside the file", last->offset = UINT64_MAX - 4095);
	REFUSED("inside the file", last->bytes = UINT64_MAX);
	REFUSED("are not 0", c.data[2 * BASIS_PAGE - 1] = 1);
	REFUSED("after the last chunk", last->bytes = 0);
	REFUSED("multiple of 40", find_chunk(&c, BASIS_CHUNK_BLOCKS)->bytes -= 8);
	free(whole.data);
	free(c.data);
}

/* As T, a V block of three channels has sums of rows as totals. */
static void turn_into_object(const struct parts *v)
{
	assert_int_equal(v->entry->channels, 3);
	v->entry->kind = BASIS_KIND_T;
	v->entry->ground = 0;
	for (int r = 0; r < v->entry->pixels * 3; r++) {
		v->total[r] = 0;
		for (int i = 0; i < v->at.stride; i++)
			v->total[r] += v->row[r * v->at.stride + i];
	}
}

static void remove_last_block(const struct copy *c)
{
	struct basis_chunk_entry *chunk = find_chunk(c, BASIS_CHUNK_BLOCKS);

	chunk->bytes -= sizeof(struct basis_block_entry);
	memset(c->data + chunk->offset + chunk->bytes, 0, sizeof(struct basis_block_entry));
}

static void refuses_broken_blocks(void **state)
{
	struct synthetic *s = *state;
	struct copy whole = copy_file(s->path), c = copy_file(s->path);
	const struct parts t = first_block(&c, BASIS_KIND_T), v = first_block(&c, BASIS_KIND_V);
	const struct parts d = first_block(&c, BASIS_KIND_D), u = first_block(&c, BASIS_KIND_U);
	uint16_t *last_pixel = &u.pixel[u.entry->pixels - 1];

	REFUSED("tile 6, expected less than 6", t.entry->tile = 6);
	REFUSED("kind 4", t.entry->kind = 4);
	REFUSED("encoding 0", t.entry->encoding = 0);
	REFUSED("0 pixels", t.entry->pixels = 0);
	REFUSED("257 pixels", t.entry->pixels = 257);
	REFUSED("2 channels", t.entry->channels = 2);
	REFUSED("0 lights", t.entry->lights = 0);
	REFUSED("51 lights", t.entry->lights = 51);
	REFUSED("ground term 2, expected less", v.entry->ground = 2);
	REFUSED("ground term 1, expected 0", t.entry->ground = 1);
	REFUSED("reserved", t.entry->reserved = 1);
	REFUSED("bytes, expected", t.entry->bytes -= 64);
	REFUSED("lies at byte", t.entry->offset = UINT64_MAX - 63);
	REFUSED("lies at byte", v.entry->offset = 0);
	REFUSED("lies at byte", v.entry->offset += 32);
	REFUSED("ascending tiles", t.entry->tile = 1);
	REFUSED("light 50, expected", t.light[t.entry->lights - 1] = 50);
	REFUSED("ascending numbers", t.light[1] = t.light[0]);
	REFUSED("pixel 256, expected", t.pixel[t.entry->pixels - 1] = 256);
	REFUSED("ascending numbers", t.pixel[1] = t.pixel[0]);
	REFUSED("padding between", ((uint16_t *)v.light)[-1] = 1);
	REFUSED("padding between", ((uint8_t *)v.total)[-1] = 1);
	REFUSED("padding of row 0", t.row[t.at.stride - 1] = 1);
	REFUSED("scale nan", t.scale[0] = NAN);
	REFUSED("scale inf", t.scale[0] = INFINITY);
	REFUSED("scale -1", t.scale[0] = -1);
	REFUSED("scale -0", t.scale[0] = -0.0F);
	REFUSED("value -32768 in row 0", t.row[3] = INT16_MIN);
	REFUSED("value -1 in row 0, expected at least 0", u.row[3] = -1);
	REFUSED("of row 0, expected", t.total[0]++);
	REFUSED("expected", v.total[0] += 2);
	REFUSED("expected U after a D", u.entry->kind = BASIS_KIND_D);
	REFUSED("kind U without", d.entry->kind = BASIS_KIND_U);
	REFUSED("not those of the D", *last_pixel += *last_pixel < 255 ? 1 : -1);
	REFUSED("has a row of its kind already", turn_into_object(&v));
	REFUSED("after the last block", remove_last_block(&c));
	free(whole.data);
	free(c.data);
}

/* The list of a V block may end in N: nowhere else, and of no other kind. */
static void the_rest_is_last_and_of_v_alone(void **state)
{
	struct synthetic_options o = small;
	struct synthetic s;
	struct copy whole, c;
	struct parts b;
	int listed;

	(void)state;
	o.rest = true;
	o.ratio_cut = 1e-4;
	synthetic_open(&s, &o);
	for (int n = 0; n < s.basis.poses[0].block_count; n++) {
		const struct basis_block *block = &s.basis.poses[0].blocks[n];

		assert_true(block->rest == (block->kind == BASIS_KIND_V));
		assert_true(!block->rest || (block->lights == 10 && block->light[9] == 50));
	}
	whole = copy_file(s.path);
	c = copy_file(s.path);
	b = first_block(&c, BASIS_KIND_V);
	listed = (int)b.entry->lights - 1;
	assert_int_equal(b.light[listed], 50);
	REFUSED("light 50, expected ascending numbers below 50, or", b.light[listed - 1] = 50);
	REFUSED("light 51, expected", b.light[listed] = 51);
	REFUSED("light 65535, expected", b.light[listed] = UINT16_MAX);
	REFUSED("of pixel", b.light[listed] = 49); /* another light's total */
	REFUSED("of pixel", b.total[0] += 2);
	REFUSED("value -32768", b.row[listed] = INT16_MIN);
	for (int k = 0; k < BASIS_KIND_COUNT; k++) {
		if (k == BASIS_KIND_V)
			continue;
		b = first_block(&c, (enum basis_kind)k);
		listed = (int)b.entry->lights - 1;
		REFUSED("light 50, expected ascending numbers below 50", b.light[listed] = 50);
	}
	free(whole.data);
	free(c.data);
	synthetic_close(&s);
}

static void unknown_chunks_are_passed_over(void **state)
{
	struct synthetic *s = *state;
	struct copy copy = copy_file(s->path);
	struct fault fault;

	find_chunk(&copy, BASIS_CHUNK_CAMERA)->type = BASIS_FOURCC('N', 'E', 'W', '1');
	synthetic_reseal(copy.data, copy.bytes);
	assert_int_equal(try_open(&copy, copy.bytes, &fault), 0);
	free(copy.data);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(writes_and_reads_back),
		cmocka_unit_test(a_failed_writer_leaves_nothing),
		cmocka_unit_test(writing_twice_gives_the_same_bytes),
		cmocka_unit_test(names_what_is_not_a_basis),
		cmocka_unit_test(refuses_every_truncation),
		cmocka_unit_test(refuses_every_flipped_bit),
		cmocka_unit_test(refuses_broken_chunks),
		cmocka_unit_test(refuses_broken_blocks),
		cmocka_unit_test(the_rest_is_last_and_of_v_alone),
		cmocka_unit_test(unknown_chunks_are_passed_over),
	};

	return cmocka_run_group_tests(tests, setup, teardown);
}
