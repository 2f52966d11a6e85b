/* SPDX-License-Identifier: MIT */
/* Interlaced frames into BGRX: every order of fields, every format and every method, against a
 * woven picture that the test takes apart and puts together again in double precision. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <turbojpeg.h>

#include "hal/frame/frame_decode.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { SIDE_MAX = 64, ROOM = SIDE_MAX * SIDE_MAX * 4 };

/* A picture and the same one as fields. The padding of rows differs from plane to plane. */
struct field_rig {
	struct frame woven, frame;
	uint8_t whole[FRAME_PLANES][ROOM], split[FRAME_PLANES][2][ROOM * 2];
	struct canvas canvas, expected[2]; /* the fields by themselves, in whole-height canvases */
};

static struct chance chance;

static int planes_of(enum pixel_format format)
{
	return frame_plane_count(format);
}

static int rows_of(const struct frame *frame, int plane)
{
	return (int)frame_plane_bytes(frame->format, plane, 1, frame->height);
}

static struct frame_plane copy_rows(uint8_t *to, const struct frame_plane *from, size_t row,
				    size_t stride, int rows, int first, int step)
{
	for (int y = 0; y < rows; y++)
		memcpy(to + (size_t)y * stride,
		       from->data + (size_t)(first + y * step) * from->stride, row);
	return (struct frame_plane){to, stride, stride * (size_t)(rows - 1) + row};
}

/* Sets the frame's planes so that they describe the woven picture in that order of fields. */
static void lay_out(struct field_rig *r, enum frame_fields fields, bool bottom_first)
{
	r->frame = r->woven;
	r->frame.fields = fields;
	r->frame.bottom_first = bottom_first;
	if (fields == FIELDS_INTERLACED)
		return;
	for (int p = 0; p < planes_of(r->woven.format); p++) {
		const struct frame_plane *from = &r->woven.planes[p];
		const size_t row = frame_plane_stride(r->woven.format, p, r->woven.width);
		const size_t stride = row + 4 + (size_t)p * 4;
		const int half = rows_of(&r->woven, p) / 2;
		const bool swapped = fields == FIELDS_BOTTOM_TOP || fields == FIELDS_BOTTOM;
		uint8_t *first = r->split[p][0], *second = r->split[p][1];
		struct frame_plane one, other;

		if (fields == FIELDS_TOP_BOTTOM || fields == FIELDS_BOTTOM_TOP)
			second = first + stride * (size_t)half;
		one = copy_rows(first, from, row, stride, half, swapped, 2);
		other = copy_rows(second, from, row, stride, half, !swapped, 2);
		r->frame.planes[p] = one;
		if (fields == FIELDS_PAIR)
			r->frame.bottom_planes[p] = other;
		else if (fields != FIELDS_TOP && fields != FIELDS_BOTTOM)
			r->frame.planes[p].bytes = stride * (size_t)half + other.bytes;
	}
}

static uint8_t *pixel_of(const struct canvas *canvas, int x, int y)
{
	return canvas->pixels + (size_t)y * canvas->stride + (size_t)x * 4;
}

/* Decodes each field as a progressive picture of half the height; test_frame.c checks that
 * decoding. */
static void decode_fields_apart(struct field_rig *r)
{
	struct frame_decoder *decoder;

	assert_int_equal(frame_decoder_create(&decoder, DEINTERLACE_WEAVE, PICTURE_UPRIGHT), 0);
	for (int bottom = 0; bottom < 2; bottom++) {
		struct frame field = r->woven;

		field.fields = FIELDS_NONE;
		field.height /= 2;
		for (int p = 0; p < planes_of(field.format); p++) {
			field.planes[p].data += bottom ? r->woven.planes[p].stride : 0;
			field.planes[p].bytes -= bottom ? r->woven.planes[p].stride : 0;
			field.planes[p].stride *= 2;
		}
		assert_int_equal(canvas_create(&r->expected[bottom], field.width, field.height), 0);
		assert_int_equal(frame_decode(decoder, &field, &r->expected[bottom], NULL), 0);
	}
	frame_decoder_destroy(decoder);
}

static void deinterlace_make(struct field_rig *r, enum pixel_format format, int width, int height)
{
	memset(r, 0, sizeof(*r));
	r->woven = (struct frame){
		.format = format, .width = width, .height = height, .range = RANGE_FULL};
	for (int p = 0; p < planes_of(format); p++) {
		const size_t row = frame_plane_stride(format, p, width), stride = row + 3;

		for (size_t i = 0; i < ROOM; i++)
			r->whole[p][i] = (uint8_t)chance_bits(&chance);
		r->woven.planes[p] = (struct frame_plane){
			r->whole[p], stride, stride * (size_t)(rows_of(&r->woven, p) - 1) + row};
	}
	assert_int_equal(canvas_create(&r->canvas, width, height), 0);
	decode_fields_apart(r);
}

static void deinterlace_drop(struct field_rig *r)
{
	canvas_free(&r->canvas);
	canvas_free(&r->expected[0]);
	canvas_free(&r->expected[1]);
}

static double woven_at(const struct field_rig *r, int x, int y, int c)
{
	return pixel_of(&r->expected[y % 2], x, y / 2)[c];
}

/* Value of a field at line y of the picture. Lines of the field lie at every other line; between
 * two of them the value is their mean, beyond the last it is the last. */
static double field_at(const struct field_rig *r, bool bottom, int x, double y, int c)
{
	const int last = r->canvas.height / 2 - 1;
	const double line = (y - (bottom ? 1 : 0)) / 2;
	const double below = fmin(fmax(ceil(line), 0), last);
	const double above = fmin(fmax(floor(line), 0), last);

	return (pixel_of(&r->expected[bottom], x, (int)above)[c] +
		pixel_of(&r->expected[bottom], x, (int)below)[c]) /
	       2.0;
}

static double blended_at(const struct field_rig *r, int x, int y, int c)
{
	const int last = r->canvas.height - 1;
	const int above = y > 0 ? y - 1 : 1, below = y < last ? y + 1 : last - 1;

	return woven_at(r, x, above, c) / 4 + woven_at(r, x, y, c) / 2 +
	       woven_at(r, x, below, c) / 4;
}

static double expected_at(const struct field_rig *r, enum deinterlace way, int x, int y, int c)
{
	const enum frame_fields fields = r->frame.fields;

	if (fields == FIELDS_TOP || fields == FIELDS_BOTTOM)
		return field_at(r, fields == FIELDS_BOTTOM, x, y, c);
	switch (way) {
	case DEINTERLACE_BOB:
		return field_at(r, !r->frame.bottom_first, x, y, c);
	case DEINTERLACE_BLEND:
		return blended_at(r, x, y, c);
	default:
		return woven_at(r, x, y, c);
	}
}

static void decodes_as_expected(struct field_rig *r, enum deinterlace way)
{
	struct frame_decoder *decoder;
	struct fault fault = {""};

	assert_int_equal(frame_decoder_create(&decoder, way, PICTURE_UPRIGHT), 0);
	if (frame_decode(decoder, &r->frame, &r->canvas, &fault))
		fail_msg("%s", fault.text);
	for (int y = 0; y < r->canvas.height; y++)
		for (int x = 0; x < r->canvas.width; x++) {
			const uint8_t *got = pixel_of(&r->canvas, x, y);

			expect_equal(got[3], 255, "fourth byte of pixel (%d, %d)", x, y);
			for (int c = 0; c < 3; c++) {
				const double exact = expected_at(r, way, x, y, c);

				if (got[c] != floor(exact + 0.5))
					fail_msg(
						"%s, %s, fields %d: line %d, column %d is %d, expected %.2f",
						pixel_format_names[r->frame.format],
						deinterlace_names[way], r->frame.fields, y, x,
						got[c], exact);
			}
		}
	frame_decoder_destroy(decoder);
}

TEST("every order and way")
{
	static struct field_rig rig;

	for (int format = PIXEL_YUYV; format <= PIXEL_GREY; format++)
		for (int height = pixel_format_halves_rows(format) ? 4 : 2; height <= 36;
		     height += pixel_format_halves_rows(format) ? 16 : 2) {
			deinterlace_make(&rig, (enum pixel_format)format, 5 + height, height);
			for (int fields = FIELDS_INTERLACED; fields < FIELDS_COUNT; fields++)
				for (int way = 0; way < DEINTERLACE_COUNT * 2; way++) {
					lay_out(&rig, (enum frame_fields)fields, way % 2);
					decodes_as_expected(&rig, (enum deinterlace)(way / 2));
				}
			deinterlace_drop(&rig);
		}
}

/* The check above must fail on a wrong picture. */
TEST("a field in the wrong place is noticed")
{
	static struct field_rig rig;
	struct frame_decoder *decoder;
	int differing = 0;

	deinterlace_make(&rig, PIXEL_BGRX, 16, 16);
	lay_out(&rig, FIELDS_TOP_BOTTOM, false);
	rig.frame.fields = FIELDS_BOTTOM_TOP;
	assert_int_equal(frame_decoder_create(&decoder, DEINTERLACE_WEAVE, PICTURE_UPRIGHT), 0);
	assert_int_equal(frame_decode(decoder, &rig.frame, &rig.canvas, NULL), 0);
	for (int y = 0; y < 16; y++)
		differing += pixel_of(&rig.canvas, 3, y)[0] != (int)woven_at(&rig, 3, y, 0);
	assert_true(differing > 8);
	frame_decoder_destroy(decoder);
	deinterlace_drop(&rig);
}

/* A vertical gradient stays in place, in any field and method: no bobbing by half a line. */
TEST("nothing moves by half a line")
{
	static struct field_rig rig;

	deinterlace_make(&rig, PIXEL_GREY, 8, 48);
	for (int y = 0; y < 48; y++)
		memset(rig.whole[0] + (size_t)y * rig.woven.planes[0].stride, 4 * y, 8);
	for (int way = 0; way < DEINTERLACE_COUNT * 2; way++) {
		struct frame_decoder *decoder;

		lay_out(&rig, FIELDS_PAIR, way % 2);
		assert_int_equal(frame_decoder_create(&decoder, (enum deinterlace)(way / 2),
						      PICTURE_UPRIGHT),
				 0);
		assert_int_equal(frame_decode(decoder, &rig.frame, &rig.canvas, NULL), 0);
		for (int y = 1; y < 47; y++)
			expect_equal(pixel_of(&rig.canvas, 4, y)[1], 4 * y, "line %d, way %d", y,
				     way);
		frame_decoder_destroy(decoder);
	}
	deinterlace_drop(&rig);
}

/* White in one field and black in the other, as a moving object leaves them. */
TEST("blending leaves no comb")
{
	static struct field_rig rig;
	struct frame_decoder *decoder;

	deinterlace_make(&rig, PIXEL_GREY, 8, 48);
	for (int y = 0; y < 48; y++)
		memset(rig.whole[0] + (size_t)y * rig.woven.planes[0].stride, y % 2 ? 0 : 255, 8);
	lay_out(&rig, FIELDS_INTERLACED, false);
	assert_int_equal(frame_decoder_create(&decoder, DEINTERLACE_BLEND, PICTURE_UPRIGHT), 0);
	assert_int_equal(frame_decode(decoder, &rig.frame, &rig.canvas, NULL), 0);
	for (int y = 0; y < 48; y++)
		expect_equal(pixel_of(&rig.canvas, 4, y)[1], 128, "line %d", y);
	frame_decoder_destroy(decoder);
	deinterlace_drop(&rig);
}

TEST("odd heights are refused")
{
	static struct field_rig rig;
	struct frame_decoder *decoder;
	struct fault fault = {""};

	assert_int_equal(frame_decoder_create(&decoder, DEINTERLACE_WEAVE, PICTURE_UPRIGHT), 0);
	for (int fields = FIELDS_INTERLACED; fields < FIELDS_COUNT; fields++) {
		deinterlace_make(&rig, PIXEL_YUYV, 16, 16);
		lay_out(&rig, (enum frame_fields)fields, false);
		rig.frame.height = rig.canvas.height = 15;
		expect_equal(frame_decode(decoder, &rig.frame, &rig.canvas, &fault), -EINVAL,
			     "fields=%d", fields);
		assert_non_null(strstr(fault.text, "15"));
		deinterlace_drop(&rig);
	}
	deinterlace_make(&rig, PIXEL_NV12, 16, 16);
	lay_out(&rig, FIELDS_INTERLACED, false);
	rig.frame.height = rig.canvas.height = 14;
	assert_int_equal(frame_decode(decoder, &rig.frame, &rig.canvas, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "multiple of 4"));
	deinterlace_drop(&rig);
	frame_decoder_destroy(decoder);
}

TEST("short fields are refused")
{
	static struct field_rig rig;
	struct frame_decoder *decoder;

	assert_int_equal(frame_decoder_create(&decoder, DEINTERLACE_WEAVE, PICTURE_UPRIGHT), 0);
	for (int format = PIXEL_YUYV; format <= PIXEL_GREY; format++)
		for (int fields = FIELDS_INTERLACED; fields < FIELDS_COUNT; fields++)
			for (int p = 0; p < planes_of((enum pixel_format)format); p++) {
				struct frame_plane *last;

				deinterlace_make(&rig, (enum pixel_format)format, 16, 16);
				lay_out(&rig, (enum frame_fields)fields, false);
				last = fields == FIELDS_PAIR ? &rig.frame.bottom_planes[p]
							     : &rig.frame.planes[p];
				last->bytes--;
				expect_equal(frame_decode(decoder, &rig.frame, &rig.canvas, NULL),
					     -EINVAL, "format=%d, fields=%d, p=%d", format, fields,
					     p);
				last->bytes = 3;
				expect_equal(frame_decode(decoder, &rig.frame, &rig.canvas, NULL),
					     -EINVAL, "format=%d, fields=%d, p=%d", format, fields,
					     p);
				deinterlace_drop(&rig);
			}
	frame_decoder_destroy(decoder);
}

/* ---- JPEG ---- */

/* Compresses a picture whose even lines have one grey and whose odd lines another. JPEG keeps a
 * flat field exactly. */
static size_t compress(int width, int height, int even, int odd, uint8_t *to)
{
	static uint8_t grey[SIDE_MAX * SIDE_MAX];
	tjhandle handle = tjInitCompress();
	unsigned long bytes = ROOM;
	uint8_t *place = to;

	for (int y = 0; y < height; y++)
		memset(grey + y * width, y % 2 ? odd : even, (size_t)width);
	assert_int_equal(tjCompress2(handle, grey, width, 0, height, TJPF_GRAY, &place, &bytes,
				     TJSAMP_GRAY, 100, TJFLAG_ACCURATEDCT | TJFLAG_NOREALLOC),
			 0);
	tjDestroy(handle);
	return bytes;
}

static void holds_greys(const struct canvas *canvas, int top, int bottom)
{
	for (int y = 0; y < canvas->height; y++) {
		const int expected = y % 2 ? bottom : top, got = pixel_of(canvas, 9, y)[1];

		if (abs(expected - got) > 1)
			fail_msg("line %d is %d, expected %d", y, got, expected);
	}
}

static void jpeg_holds(struct field_rig *r, enum deinterlace way, int top, int bottom)
{
	struct frame_decoder *decoder;
	struct fault fault = {""};

	assert_int_equal(frame_decoder_create(&decoder, way, PICTURE_UPRIGHT), 0);
	if (frame_decode(decoder, &r->frame, &r->canvas, &fault))
		fail_msg("%s", fault.text);
	holds_greys(&r->canvas, top, bottom);
	frame_decoder_destroy(decoder);
}

TEST("jpeg in fields")
{
	static struct field_rig rig;
	static uint8_t pair[ROOM * 2];
	size_t bytes, second;

	deinterlace_make(&rig, PIXEL_BGRX, 32, 32);
	rig.frame = (struct frame){.format = PIXEL_MJPEG, .width = 32, .height = 32};

	/* both fields woven into one picture */
	bytes = compress(32, 32, 60, 180, pair);
	rig.frame.planes[0] = (struct frame_plane){pair, 0, bytes};
	rig.frame.fields = FIELDS_INTERLACED;
	jpeg_holds(&rig, DEINTERLACE_WEAVE, 60, 180);
	jpeg_holds(&rig, DEINTERLACE_BOB, 180, 180);
	jpeg_holds(&rig, DEINTERLACE_BLEND, 120, 120);

	/* two pictures of half the height, with stray bytes between them and a thumbnail in the
	 * first */
	bytes = compress(32, 16, 60, 60, pair);
	memmove(pair + 10, pair + 2, bytes - 2);
	memcpy(pair + 2, "\xff\xe1\x00\x06\xff\xd9\xff\xd8", 8);
	bytes += 8;
	memset(pair + bytes, 0, 7);
	second = bytes + 7;
	bytes = second + compress(32, 16, 180, 180, pair + second);
	rig.frame.planes[0].bytes = bytes;
	rig.frame.fields = FIELDS_TOP_BOTTOM;
	jpeg_holds(&rig, DEINTERLACE_WEAVE, 60, 180);
	rig.frame.fields = FIELDS_BOTTOM_TOP;
	rig.frame.bottom_first = true;
	jpeg_holds(&rig, DEINTERLACE_WEAVE, 180, 60);
	jpeg_holds(&rig, DEINTERLACE_BOB, 180, 180);
	rig.frame.fields = FIELDS_INTERLACED;
	jpeg_holds(&rig, DEINTERLACE_WEAVE, 180, 60);

	/* the second field in memory of its own */
	rig.frame.fields = FIELDS_PAIR;
	rig.frame.bottom_first = false;
	rig.frame.planes[0].bytes = second;
	rig.frame.bottom_planes[0] = (struct frame_plane){pair + second, 0, bytes - second};
	jpeg_holds(&rig, DEINTERLACE_WEAVE, 60, 180);

	/* one field alone */
	rig.frame.fields = FIELDS_BOTTOM;
	jpeg_holds(&rig, DEINTERLACE_WEAVE, 60, 60);
	deinterlace_drop(&rig);
}

TEST("jpeg without its second field is refused")
{
	static struct field_rig rig;
	static uint8_t one[ROOM * 2];
	struct frame_decoder *decoder;
	struct fault fault = {""};
	size_t bytes;

	deinterlace_make(&rig, PIXEL_BGRX, 32, 32);
	bytes = compress(32, 16, 60, 60, one);
	rig.frame = (struct frame){.format = PIXEL_MJPEG,
				   .width = 32,
				   .height = 32,
				   .fields = FIELDS_TOP_BOTTOM,
				   .planes = {{one, 0, bytes}}};
	assert_int_equal(frame_decoder_create(&decoder, DEINTERLACE_WEAVE, PICTURE_UPRIGHT), 0);
	assert_int_equal(frame_decode(decoder, &rig.frame, &rig.canvas, &fault), -EBADMSG);
	bytes += compress(32, 8, 60, 60, one + bytes);
	rig.frame.planes[0].bytes = bytes;
	assert_int_equal(frame_decode(decoder, &rig.frame, &rig.canvas, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "32x8"));
	bytes = compress(32, 32, 60, 60, one); /* a whole picture is not one field */
	rig.frame.planes[0].bytes = bytes;
	rig.frame.fields = FIELDS_TOP;
	assert_int_equal(frame_decode(decoder, &rig.frame, &rig.canvas, &fault), -EBADMSG);
	frame_decoder_destroy(decoder);
	deinterlace_drop(&rig);
}

static int begin_group(__attribute__((unused)) void **state)
{
	chance = chance_begin("deinterlace");
	return 0;
}

TEST_GROUP(begin_group, NULL);
