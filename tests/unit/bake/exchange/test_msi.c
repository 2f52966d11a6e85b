/* SPDX-License-Identifier: MIT */
/* Files of the thesis's program: written, read back in every variant, damaged; and the thesis's own
 * loop over both. */
#include <errno.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/base/random.h"
#include "bake/exchange/msi.h"
#include "tests/support/bake/small_scene.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define WIDTH 40
#define HEIGHT 30

static const struct msi_variant variants[] = {{false, 8}, {false, 4}, {true, 4}, {true, 8}};

/* A bake, and the same as the thesis's program would hold it. */
static struct world_of_thesis {
	struct basis basis;
	struct dome dome;
	struct pool *pool;
	struct thesis *thesis;
} own;

static struct thesis *thesis_of(const struct basis *basis, struct pool *pool)
{
	struct fault fault = {.text = ""};
	struct thesis *thesis;

	if (thesis_create(&thesis, basis, &basis->poses[0].exact, pool, &fault))
		fail_msg("%s", fault.text);
	return thesis;
}

static int test_msi_begin(void **state)
{
	if (small_scene_begin(state))
		return -1;
	small_scene_write_sphere("ball.obj", 0.5, 12);
	small_scene_write(
		"ball.ini",
		"[camera]\nposition = 1 -3 1.5\nlook_at = 0 0 0.4\nwidth = %d\nheight = %d\n"
		"[dome]\nfrequency = 2\n[render]\nsamples = 16\n[ground]\n[object ball]\n"
		"file = ball.obj\nup = z\nstand = yes\nmaterial = m\n[material m]\n"
		"colour = 0.8 0.5 0.3\n",
		WIDTH, HEIGHT);
	own.basis = small_scene_bake("ball.ini");
	assert_int_equal(dome_create(&own.dome, 2, NULL), 0);
	assert_int_equal(pool_create(&own.pool, 2), 0);
	own.thesis = thesis_of(&own.basis, own.pool);
	return 0;
}

static int test_msi_end(void **state)
{
	thesis_destroy(own.thesis);
	pool_destroy(own.pool);
	dome_free(&own.dome);
	basis_close(&own.basis);
	return small_scene_end(state);
}

static void put_number(FILE *to, uint64_t value, int bytes, bool big_endian)
{
	for (int k = 0; k < bytes; k++)
		putc((int)(value >> 8 * (big_endian ? bytes - 1 - k : k) & 255), to);
}

/* Writes the file with the header of a machine of this variant. */
static void write_msi(const char *name, const struct msi_variant *variant)
{
	const int number[3] = {WIDTH, HEIGHT, own.dome.count};
	uint8_t *data = malloc(4 << 20);
	struct fault fault = {.text = ""};
	size_t bytes;
	FILE *file;

	if (msi_write(small_scene_path(name), own.thesis, WIDTH, HEIGHT, own.dome.count, &fault))
		fail_msg("%s", fault.text);
	file = fopen(small_scene_path(name), "rb+");
	assert_non_null(file);
	bytes = fread(data, 1, 4 << 20, file);
	rewind(file);
	for (int k = 0; k < 3; k++)
		put_number(file, (uint64_t)number[k], 4, variant->big_endian);
	put_number(file, bytes - 8 + (size_t)variant->long_bytes, variant->long_bytes,
		   variant->big_endian);
	fwrite(data + 20, 1, bytes - 20, file);
	assert_int_equal(ftruncate(fileno(file), ftell(file)), 0);
	fclose(file);
	free(data);
}

static void check_same(const struct msi *msi)
{
	for (int p = 0; p < WIDTH * HEIGHT; p++) {
		const uint8_t *row, *read = msi->data + msi->start[p];
		const enum thesis_role role = thesis_pixel(own.thesis, p % WIDTH, p / WIDTH, &row);

		expect_equal(*read, role, "p=%d", p);
		if (role)
			assert_memory_equal(read + 1, row,
					    3 * (size_t)role * (size_t)own.dome.count);
	}
}

TEST("variants")
{
	struct fault fault = {.text = ""};
	struct msi msi;

	for (size_t k = 0; k < 4; k++) {
		write_msi("a.msi", &variants[k]);
		assert_int_equal(msi_open(&msi, small_scene_path("a.msi"), &fault), 0);
		expect_equal(msi.variant.big_endian, variants[k].big_endian, "k=%zu", k);
		expect_equal(msi.variant.long_bytes, variants[k].long_bytes, "k=%zu", k);
		expect_equal(msi.width, WIDTH, "k=%zu", k);
		expect_equal(msi.height, HEIGHT, "k=%zu", k);
		expect_equal(msi.lights, own.dome.count, "k=%zu", k);
		check_same(&msi);
		msi_close(&msi);
		msi_close(&msi);
	}
}

/* ---- the thesis's loop ---- */

static struct basis import(const char *name)
{
	const struct import_settings settings = {.target = {.rms = 0.5, .max = 1, .cell = 1},
						 .exact = true,
						 .threads = 2,
						 .quiet = true};
	struct fault fault = {.text = ""};
	struct msi_source from;
	struct basis basis;
	struct assembly_report report;
	struct msi msi;
	int *place = calloc((size_t)own.dome.count, sizeof(*place));

	assert_non_null(place);
	for (int i = 0; i < own.dome.count; i++)
		place[i] = i;
	assert_int_equal(msi_open(&msi, small_scene_path(name), &fault), 0);
	assert_int_equal(msi_source_create(&from, &msi, &own.dome, place, thesis_rate(own.thesis)),
			 0);
	assert_non_null(from.ground); /* the ground is flat and visible */
	{
		const struct import_source source = {
			.width = msi.width,
			.height = msi.height,
			.dome = &own.dome,
			.ground = from.ground,
			.provenance = "",
			.fill = msi_fill,
			.context = &from,
		};

		if (import_run(&source, &settings, small_scene_path("in.inlay"), &report, &fault))
			fail_msg("%s", fault.text);
	}
	msi_source_free(&from);
	msi_close(&msi);
	free(place);
	if (basis_open(&basis, small_scene_path("in.inlay"), BASIS_WITH_EXACT, &fault) < 0)
		fail_msg("%s", fault.text);
	return basis;
}

static void light_up(struct light_selection *lights, const struct basis *basis, int kind)
{
	struct random random = {7};
	float radiance[64][3];

	for (int i = 0; i < own.dome.count; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = kind == 0   ? 0.6f
					 : kind == 1 ? (float)(i == 4) * 8
						     : random_next(&random);
	light_selection_choose(lights, basis, 0, (const float(*)[3])radiance, 0, THRESHOLD_DROP, 1);
}

/* Largest difference in levels of pictures that the thesis's loop makes of both. */
static int loop_difference(struct thesis *other, const struct basis *basis, int kind)
{
	struct canvas background, a, b;
	struct light_selection lights;
	int most = 0;

	assert_int_equal(canvas_create(&background, WIDTH, HEIGHT), 0);
	assert_int_equal(canvas_create(&a, WIDTH, HEIGHT), 0);
	assert_int_equal(canvas_create(&b, WIDTH, HEIGHT), 0);
	memset(background.pixels, 180, background.stride * HEIGHT);
	assert_int_equal(light_selection_create(&lights, basis), 0);
	light_up(&lights, basis, kind);
	thesis_light(own.thesis, &lights);
	thesis_light(other, &lights);
	thesis_run(own.thesis, &background, &a, own.pool);
	thesis_run(other, &background, &b, own.pool);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < 4 * WIDTH; x++) {
			const size_t at = (size_t)y * a.stride + (size_t)x;
			const int off = abs(a.pixels[at] - b.pixels[at]);

			if (x % 4 != 3 && off > most)
				most = off;
		}
	light_selection_free(&lights);
	canvas_free(&background);
	canvas_free(&a);
	canvas_free(&b);
	return most;
}

TEST("loop")
{
	struct thesis *other;
	struct basis basis;

	write_msi("a.msi", &variants[2]);
	basis = import("a.msi");
	other = thesis_of(&basis, own.pool);
	for (int kind = 0; kind < 3; kind++) {
		const int most = loop_difference(other, &basis, kind);

		print_message("light %d: at most %d levels\n", kind, most);
		expect_at_most(most, 1, "kind=%d", kind);
	}
	thesis_destroy(other);
	basis_close(&basis);
}

/* ---- damage ---- */

static void refused(const uint8_t *data, size_t bytes, const char *words)
{
	struct fault fault = {.text = ""};
	struct msi msi;
	FILE *file = fopen(small_scene_path("bad.msi"), "wb");

	assert_non_null(file);
	assert_int_equal(fwrite(data, 1, bytes, file), bytes);
	assert_int_equal(fclose(file), 0);
	assert_int_equal(msi_open(&msi, small_scene_path("bad.msi"), &fault), -EBADMSG);
	if (!strstr(fault.text, words))
		fail_msg("expected \"%s\": %s", words, fault.text);
	assert_null(msi.data);
}

TEST("damage")
{
	static const uint8_t tiny[] = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 24, 0, 0, 0, 1, 9, 9, 9};
	uint8_t *data = malloc(4 << 20);
	size_t bytes, first;
	FILE *file;

	assert_non_null(data);
	for (size_t k = 0; k < 4; k++) {
		const bool big = variants[k].big_endian;

		write_msi("a.msi", &variants[k]);
		file = fopen(small_scene_path("a.msi"), "rb");
		assert_non_null(file);
		bytes = fread(data, 1, 4 << 20, file);
		fclose(file);
		first = 12 + (size_t)variants[k].long_bytes;
		refused(data, bytes - 1, "as it says itself");
		refused(data, bytes / 2, "as it says itself");
		refused(data, first, "as it says itself");
		refused(data, 7, "ends in its header");
		data[bytes] = 0;
		refused(data, bytes + 1, "as it says itself");
		data[first] = 3;
		refused(data, bytes, "expected 0, 1 or 2");
		data[first] = 0;
		data[big ? 3 : 0]++; /* one column more */
		refused(data, bytes, "no .msi, or damaged");
		memset(data, 0, 12);
		refused(data, bytes, "no size and count of lights");
		memset(data, 255, 12);
		refused(data, bytes, "no size and count of lights");
	}
	/* the header says 24 bytes, and there are 20 */
	refused(tiny, sizeof(tiny), "expected 24");
	free(data);
}

TEST_GROUP(test_msi_begin, test_msi_end);
