/* SPDX-License-Identifier: MIT */
/* Row conversions of each instruction set against the C ones, and parts of frames against whole
 * frames. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/processor.h"
#include "hal/frame/frame_reader.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { WIDTH_MAX = 131, GUARD = 16 };

/* Table number i; NULL: this processor does not support it. */
static const struct frame_rows *table(int i)
{
	const struct frame_rows *rows = frame_rows_all[i];

	return rows && (rows->needs & ~processor_features()) == 0 ? rows : NULL;
}

static void convert(const struct frame_rows *rows, enum pixel_format format, const struct ycbcr *k,
		    const uint8_t *y, const uint8_t *cbcr, int count, uint32_t *to)
{
	switch (format) {
	case PIXEL_YUYV:
		rows->yuyv(k, y, count, to);
		break;
	case PIXEL_UYVY:
		rows->uyvy(k, y, count, to);
		break;
	case PIXEL_NV12:
		rows->nv12(k, y, cbcr, count, to);
		break;
	default:
		rows->grey(k, y, count, to);
		break;
	}
}

static const enum pixel_format formats[] = {PIXEL_YUYV, PIXEL_UYVY, PIXEL_NV12, PIXEL_GREY};

/* Memory of exactly that many random bytes, so that a sanitizer sees a read beyond. */
static uint8_t *random_bytes(struct chance *chance, size_t bytes)
{
	uint8_t *data = malloc(bytes ? bytes : 1);

	assert_non_null(data);
	for (size_t i = 0; i < bytes; i++)
		data[i] = (uint8_t)(chance_bits(chance) >> 13);
	return data;
}

static void check_row(struct chance *chance, const struct frame_rows *rows,
		      enum pixel_format format, const struct ycbcr *k, int count)
{
	const int offset = (int)(chance_bits(chance) % 3);
	const size_t row = frame_plane_stride(format, 0, count);
	const size_t chroma = frame_plane_stride(format, 1, count);
	uint8_t *y = random_bytes(chance, (size_t)offset + row);
	uint8_t *cbcr = random_bytes(chance, (size_t)offset + chroma);
	uint32_t want[WIDTH_MAX], got[WIDTH_MAX + 2 * GUARD];

	memset(got, 0x5a, sizeof(got));
	convert(frame_rows_all[0], format, k, y + offset, cbcr + offset, count, want);
	convert(rows, format, k, y + offset, cbcr + offset, count, got + GUARD);
	expect_same_picture((const uint8_t *)(got + GUARD), (const uint8_t *)want,
			    4 * (size_t)count, 4 * (size_t)count,
			    "%s, format %d, %d pixels, offset %d", rows->name, format, count,
			    offset);
	for (int i = 0; i < GUARD; i++) {
		expect_equal(got[i], 0x5a5a5a5a, "i=%d", i);
		expect_equal(got[GUARD + count + i], 0x5a5a5a5a, "i=%d", i);
	}
	free(y);
	free(cbcr);
}

TEST("every table gives the same bits")
{
	struct chance chance = chance_begin("frame_rows");

	for (int i = 1; frame_rows_all[i]; i++) {
		if (!table(i)) {
			print_message("# %s: not on this processor\n", frame_rows_all[i]->name);
			continue;
		}
		for (size_t f = 0; f < sizeof(formats) / sizeof(formats[0]); f++)
			for (int kind = 0; kind < 4; kind++)
				for (int count = 0; count <= WIDTH_MAX; count++) {
					struct ycbcr k;

					ycbcr_prepare(&k, (enum colour_matrix)(kind & 1),
						      (enum colour_range)(kind >> 1));
					check_row(&chance, table(i), formats[f], &k, count);
				}
	}
}

/* All 2^24 colours, for one matrix and range. */
static void every_colour(const struct frame_rows *rows, const struct ycbcr *k)
{
	enum { COUNT = 256 * 256 };
	static uint8_t packed[2 * COUNT];
	static uint32_t want[COUNT], got[COUNT];

	for (int cb = 0; cb < 256; cb++) {
		size_t at = 0;

		for (int cr = 0; cr < 256; cr++)
			for (int y = 0; y < 256; y += 2) {
				packed[at++] = (uint8_t)y;
				packed[at++] = (uint8_t)cb;
				packed[at++] = (uint8_t)(y + 1);
				packed[at++] = (uint8_t)cr;
			}
		convert(frame_rows_all[0], PIXEL_YUYV, k, packed, NULL, COUNT, want);
		convert(rows, PIXEL_YUYV, k, packed, NULL, COUNT, got);
		expect_same_picture((const uint8_t *)got, (const uint8_t *)want, sizeof(want),
				    sizeof(want), "%s, chroma", rows->name);
	}
}

TEST("every colour is the same")
{
	for (int i = 1; frame_rows_all[i]; i++)
		for (int kind = 0; table(i) && kind < 4; kind++) {
			struct ycbcr k;

			ycbcr_prepare(&k, (enum colour_matrix)(kind & 1),
				      (enum colour_range)(kind >> 1));
			every_colour(table(i), &k);
		}
}

TEST("rows are reversed")
{
	uint32_t row[WIDTH_MAX + 2];

	for (int i = 0; frame_rows_all[i]; i++)
		for (int count = 0; table(i) && count <= WIDTH_MAX; count++) {
			for (int x = 0; x < WIDTH_MAX + 2; x++)
				row[x] = (uint32_t)x;
			table(i)->reverse(row + 1, count);
			for (int x = 0; x < WIDTH_MAX + 2; x++)
				expect_equal(row[x], x >= 1 && x <= count ? count + 1 - x : x,
					     "%s, %d pixels, place %d", table(i)->name, count, x);
		}
}

/* Wrong in one bit of one pixel, which the comparison must find. */
static void wrong_yuyv(const struct ycbcr *k, const uint8_t *from, int count, uint32_t *bgrx)
{
	ycbcr_row_yuyv(k, from, count, bgrx);
	if (count)
		bgrx[count - 1] ^= 1;
}

TEST("a wrong table is caught")
{
	struct frame_rows wrong = *frame_rows_all[0];
	struct ycbcr k;
	const uint8_t packed[4] = {90, 120, 91, 140};
	uint32_t want[2], got[2];

	wrong.yuyv = wrong_yuyv;
	ycbcr_prepare(&k, MATRIX_BT709, RANGE_LIMITED);
	convert(frame_rows_all[0], PIXEL_YUYV, &k, packed, NULL, 2, want);
	convert(&wrong, PIXEL_YUYV, &k, packed, NULL, 2, got);
	assert_memory_not_equal(got, want, sizeof(want));
}

TEST("the environment masks")
{
	setenv("INLAY_KERNEL", "c", 1);
	assert_string_equal(frame_rows_choose()->name, "c");
	setenv("INLAY_KERNEL", "no such thing", 1);
	assert_string_equal(frame_rows_choose()->name, "c");
	unsetenv("INLAY_KERNEL");
	print_message("# %s\n", frame_rows_choose()->name);
}

/* ---- parts of frames ---- */

struct picture_fixture {
	struct frame frame;
	struct canvas canvas;
	uint8_t *memory[FRAME_PLANES];
};

static void make_frame(struct picture_fixture *f, struct chance *chance, enum pixel_format format,
		       int width, int height, size_t extra)
{
	const struct view whole = {.width = width, .height = height, .squash = 1};
	struct frame_reader reader;

	memset(f, 0, sizeof(*f));
	f->frame = (struct frame){.format = format,
				  .width = width,
				  .height = height,
				  .matrix = MATRIX_BT709,
				  .range = RANGE_LIMITED};
	for (int p = 0; p < frame_plane_count(format); p++) {
		const size_t stride = frame_plane_stride(format, p, width) + extra;
		const size_t bytes = frame_plane_bytes(format, p, stride, height) - extra;

		f->memory[p] = random_bytes(chance, bytes);
		f->frame.planes[p] = (struct frame_plane){f->memory[p], stride, bytes};
	}
	assert_int_equal(canvas_create(&f->canvas, width, height), 0);
	assert_int_equal(frame_reader_open(&reader, &f->frame, &whole, NULL), 0);
	frame_reader_make(&reader, 0, 0, width, height, f->canvas.pixels, f->canvas.stride);
}

static void drop_frame(struct picture_fixture *f)
{
	canvas_free(&f->canvas);
	for (int p = 0; p < FRAME_PLANES; p++)
		free(f->memory[p]);
}

static uint32_t pixel_of(const struct picture *picture, int x, int y)
{
	uint32_t pixel;

	memcpy(&pixel, picture->origin + x * picture->x_step + y * picture->y_step, 4);
	return pixel;
}

static void check_part(struct chance *chance, const struct frame_reader *reader,
		       const struct picture *want)
{
	const int x = (int)(chance_bits(chance) % (unsigned)want->width);
	const int y = (int)(chance_bits(chance) % (unsigned)want->height);
	const int width = 1 + (int)(chance_bits(chance) % (unsigned)(want->width - x));
	const int height = 1 + (int)(chance_bits(chance) % (unsigned)(want->height - y));
	const size_t stride = 4 * ((size_t)width + chance_bits(chance) % 4);
	const size_t bytes = stride * (size_t)(height - 1) + 4 * (size_t)width;
	uint32_t *out = malloc(bytes), *scratch = malloc(4 * (size_t)width);

	assert_non_null(out);
	assert_non_null(scratch);
	frame_reader_make(reader, x, y, width, height, (uint8_t *)out, stride);
	for (int j = 0; j < height; j++) {
		const uint32_t *row = frame_reader_row(reader, x, y + j, width, scratch);

		for (int i = 0; i < width; i++) {
			const uint32_t pixel = pixel_of(want, x + i, y + j);

			expect_equal(out[(size_t)j * stride / 4 + (size_t)i], pixel,
				     "pixel (%d, %d)", x + i, y + j);
			expect_equal(row[i] & 0xffffff, pixel & 0xffffff, "pixel (%d, %d), by rows",
				     x + i, y + j);
		}
	}
	free(out);
	free(scratch);
}

static void check_views(struct chance *chance, const struct picture_fixture *f)
{
	for (int flips = 0; flips < 4; flips++) {
		struct view view = {.x = (int)(chance_bits(chance) % (unsigned)f->frame.width),
				    .y = (int)(chance_bits(chance) % (unsigned)f->frame.height),
				    .hflip = flips & 1,
				    .vflip = flips & 2,
				    .squash = 1};
		struct frame_reader reader, again;
		struct picture want;

		assert_int_equal(view_resolve(&view, f->frame.width, f->frame.height, NULL), 0);
		want = view_picture(&view, f->canvas.pixels, f->canvas.stride);
		assert_int_equal(frame_reader_open(&reader, &f->frame, &view, NULL), 0);
		again = frame_reader_of(&want);
		for (int n = 0; n < 8; n++) {
			check_part(chance, &reader, &want);
			check_part(chance, &again, &want);
		}
	}
}

/* Odd corners, flips and odd strides: a part shows the same as the whole picture. */
TEST("parts are those of the whole")
{
	struct chance chance = chance_begin("frame_reader");

	for (int format = PIXEL_YUYV; format <= PIXEL_GREY; format++)
		for (int width = 1; width <= 67; width += 1 + width / 9)
			for (int height = 1; height <= 9; height += 4) {
				struct picture_fixture f;

				make_frame(&f, &chance, (enum pixel_format)format, width, height,
					   (size_t)(width % 4));
				check_views(&chance, &f);
				drop_frame(&f);
			}
}

TEST("what is not raw is refused")
{
	const struct view view = {.width = 16, .height = 4, .squash = 1};
	const struct view beyond = {.x = 1, .width = 16, .height = 4, .squash = 1};
	struct chance chance = chance_begin("frame_reader");
	struct picture_fixture f;
	struct frame_reader reader;

	make_frame(&f, &chance, PIXEL_YUYV, 16, 4, 0);
	assert_true(frame_is_raw(&f.frame));
	assert_int_equal(frame_reader_open(&reader, &f.frame, &beyond, NULL), -EINVAL);
	f.frame.planes[0].bytes--;
	assert_int_equal(frame_reader_open(&reader, &f.frame, &view, NULL), -EINVAL);
	f.frame.planes[0].bytes++;
	f.frame.fields = FIELDS_INTERLACED;
	assert_int_equal(frame_reader_open(&reader, &f.frame, &view, NULL), -ENOTSUP);
	f.frame.fields = FIELDS_NONE;
	f.frame.format = PIXEL_MJPEG;
	assert_int_equal(frame_reader_open(&reader, &f.frame, &view, NULL), -ENOTSUP);
	f.frame.format = PIXEL_RGBF;
	assert_false(frame_is_raw(&f.frame));
	drop_frame(&f);
}
