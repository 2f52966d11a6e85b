/* SPDX-License-Identifier: MIT */
/* H.264 from a played device: each stream is encoded here, by FFmpeg's program, and compared with
 * its source. */
#include <dlfcn.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "drivers/v4l2/v4l2.h"
#include "tests/support/captured_log.h"
#include "tests/support/played_v4l2.h"
#include "tests/support/test.h"

enum { WIDTH = 64, HEIGHT = 48, PICTURES = 30, KEY = 10, UNITS_MAX = 64 };
enum { PICTURE_BYTES = WIDTH * HEIGHT * 3 / 2, STREAM_MAX = 1 << 20 };

#define PSNR_MIN 38.0 /* dB; the encoder's own loss is 40 to 46 */

static const uint32_t only_h264[] = {V4L2_PIX_FMT_H264, 0};
static const uint32_t h264_and_grey[] = {V4L2_PIX_FMT_H264, V4L2_PIX_FMT_GREY, 0};
static const uint32_t h264_and_jpeg[] = {V4L2_PIX_FMT_H264, V4L2_PIX_FMT_MJPEG, 0};

static uint8_t source[PICTURES * PICTURE_BYTES];

struct stream {
	uint8_t data[STREAM_MAX];
	size_t at[UNITS_MAX + 1]; /* where each access unit begins */
	int count;
};

static size_t read_output(const char *command, uint8_t *to, size_t room)
{
	FILE *output = popen(command, "r");
	size_t bytes;

	assert_non_null(output);
	bytes = fread(to, 1, room, output);
	assert_int_equal(pclose(output), 0);
	return bytes;
}

static bool is_delimiter(const uint8_t *at)
{
	return at[0] == 0 && at[1] == 0 && at[2] == 0 && at[3] == 1 && (at[4] & 31) == 9;
}

#define PICTURE "-f lavfi -i testsrc2=size=64x48:rate=10 -frames:v 30 -pix_fmt yuv420p "
#define ENCODER "-c:v libx264 -preset veryfast -tune zerolatency -qp 12 -g 10 "
#define X264 "-x264-params aud=1:repeat-headers=1:scenecut=0"

/* Appends what ffmpeg encodes with these options, access unit by access unit. */
static void stream_append(struct stream *s, const char *options)
{
	const size_t from = s->at[s->count];
	char command[512];
	size_t bytes;

	snprintf(command, sizeof(command), "ffmpeg -v error -nostdin %s -f h264 -", options);
	bytes = read_output(command, s->data + from, STREAM_MAX - from);
	for (size_t i = from; i + 5 < from + bytes; i++)
		if (is_delimiter(s->data + i))
			s->at[s->count++] = i;
	s->at[s->count] = from + bytes;
}

static struct stream *stream_make(const char *options)
{
	struct stream *s = calloc(1, sizeof(*s));

	assert_non_null(s);
	stream_append(s, options);
	assert_int_equal(s->count, PICTURES);
	return s;
}

/* ---- the camera ---- */

static bool library_is_missing;

void *__real_dlopen(const char *name, int flags);
void *__wrap_dlopen(const char *name, int flags);
void *__wrap_dlopen(const char *name, int flags)
{
	return __real_dlopen(library_is_missing ? "libavcodec.so.missing" : name, flags);
}

/* Delivers bytes as the next buffer, the camera's n-th. */
static int camera_send(struct played_rig *rig, uint32_t n, const uint8_t *data, size_t bytes,
		       struct frame *frame)
{
	assert_in_range(bytes, 0, PLAYED_BUFFER_BYTES);
	assert_int_equal(pwrite(played_file, data, bytes, 0), (ssize_t)bytes);
	played_deliver(0, n, (uint32_t)bytes, 0);
	return camera_grab(&rig->camera, frame, &rig->fault);
}

static int camera_send_unit(struct played_rig *rig, uint32_t n, const struct stream *s, int unit,
			    struct frame *frame)
{
	return camera_send(rig, n, s->data + s->at[unit], s->at[unit + 1] - s->at[unit], frame);
}

static double psnr(const struct frame *frame, int picture)
{
	const uint8_t *was = source + (size_t)picture * PICTURE_BYTES;
	double sum = 0;

	for (int p = 0; p < 3; p++) {
		const int width = p ? WIDTH / 2 : WIDTH, height = p ? HEIGHT / 2 : HEIGHT;

		for (int y = 0; y < height; y++)
			for (int x = 0; x < width; x++, was++) {
				const int d =
					frame->planes[p].data[(size_t)y * frame->planes[p].stride +
							      (size_t)x] -
					*was;
				sum += d * d;
			}
	}
	return 10 * log10(255.0 * 255.0 * PICTURE_BYTES / fmax(sum, 1));
}

static void check_picture(struct played_rig *rig, struct frame *frame, int picture)
{
	assert_int_equal(frame->format, PIXEL_YU12);
	assert_int_equal(frame->width, WIDTH);
	assert_int_equal(frame->height, HEIGHT);
	assert_int_equal(frame_check(frame, &rig->fault), 0);
	if (psnr(frame, picture) < PSNR_MIN)
		fail_msg("picture %d: %.1f dB, expected %.1f", picture, psnr(frame, picture),
			 PSNR_MIN);
	camera_release(&rig->camera, frame);
}

static void rig_start(struct played_rig *rig, const uint32_t *formats)
{
	played_prepare(rig, formats);
	rig->settings.width = WIDTH;
	rig->settings.height = HEIGHT;
	played_must_start(rig);
	assert_int_equal(rig->camera.format, PIXEL_H264);
}

/* ---- tests ---- */

/* First of all: the library stays loaded once it is. */
TEST("a missing library is named")
{
	struct played_rig rig;

	library_is_missing = true;
	played_prepare(&rig, h264_and_grey);
	rig.settings.format = PIXEL_H264;
	assert_int_equal(played_start(&rig), -ENOTSUP);
	assert_int_equal(rig.camera.situation, CAMERA_UNSUPPORTED_FORMAT);
	assert_non_null(strstr(rig.fault.text, "offers H264, GREY"));
	assert_non_null(strstr(rig.fault.text, "libavcodec"));
	played_finish(&rig);
	rig.settings.format = PIXEL_NONE;
	played_must_start(&rig); /* without the wish the other one is taken */
	assert_int_equal(rig.camera.format, PIXEL_GREY);
	played_finish(&rig);
	library_is_missing = false;
}

TEST("others are preferred")
{
	struct played_rig rig;

	played_prepare(&rig, h264_and_jpeg);
	played_must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_MJPEG);
	played_finish(&rig);
	rig.settings.format = PIXEL_H264;
	played_must_start(&rig);
	assert_int_equal(rig.camera.format, PIXEL_H264);
	played_finish(&rig);
}

/* Each picture comes out of the grab() that its access unit comes with. */
static void pictures_come_at_once(const char *options)
{
	struct stream *s = stream_make(options);
	struct played_rig rig;
	struct frame frame;

	rig_start(&rig, only_h264);
	for (int i = 0; i < s->count; i++) {
		assert_int_equal(camera_send_unit(&rig, (uint32_t)i, s, i, &frame), 0);
		assert_int_equal(frame.sequence, i);
		assert_int_equal(played_queued(),
				 PLAYED_BUFFERS_MAX); /* the buffer has been given back */
		check_picture(&rig, &frame, i);
	}
	assert_int_equal(rig.camera.broken + rig.camera.lost, 0);
	played_finish(&rig);
	free(s);
}

TEST("each profile is decoded")
{
	pictures_come_at_once(PICTURE ENCODER X264);
	pictures_come_at_once(PICTURE ENCODER "-profile:v baseline " X264 ":slices=3");
	pictures_come_at_once(PICTURE ENCODER "-profile:v main " X264 ":ref=3:weightp=2");
	pictures_come_at_once(PICTURE ENCODER X264 ":cqm=jvt");
}

/* The newest picture needs those that it overtakes. */
TEST("overtaken pictures are decoded")
{
	struct stream *s = stream_make(PICTURE ENCODER X264);
	struct played_rig rig;
	struct frame frame;

	rig_start(&rig, only_h264);
	for (int i = 0; i < 3; i++) {
		const size_t bytes = s->at[i + 1] - s->at[i];

		assert_int_equal(pwrite(played_file, s->data + s->at[i], bytes,
					(off_t)i * 2 * PLAYED_BUFFER_BYTES),
				 (ssize_t)bytes);
		played_deliver(i, (uint32_t)i, (uint32_t)bytes, 0);
	}
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), 0);
	assert_int_equal(rig.camera.lost, 2);
	check_picture(&rig, &frame, 2);
	played_finish(&rig);
	free(s);
}

/* What goes wrong with one access unit. */
enum wrong { LOST, LOST_UNSEEN, SHORT, SHORTER, FLAGGED, EMPTY, GARBAGE, WRONG_COUNT };

static int send_wrong(struct played_rig *rig, uint32_t *n, const struct stream *s, int unit,
		      enum wrong wrong, struct frame *frame)
{
	static const uint8_t garbage[] = {0, 0, 0, 1, 0x41, 0x9a, 0xff, 0, 0x17, 0x80, 0x33};
	const uint8_t *data = s->data + s->at[unit];
	const size_t bytes = s->at[unit + 1] - s->at[unit];

	switch (wrong) {
	case LOST:
		(*n)++;
		return -EAGAIN;
	case LOST_UNSEEN: /* in the camera itself */
		return -EAGAIN;
	case SHORT:
		return camera_send(rig, (*n)++, data, bytes - bytes / 8 - 1, frame);
	case SHORTER:
		return camera_send(rig, (*n)++, data, bytes / 2, frame);
	case FLAGGED:
		played_deliver(0, (*n)++, (uint32_t)bytes, V4L2_BUF_FLAG_ERROR);
		return camera_grab(&rig->camera, frame, &rig->fault);
	case EMPTY:
		return camera_send(rig, (*n)++, data, 0, frame);
	default:
		return camera_send(rig, (*n)++, garbage, sizeof(garbage), frame);
	}
}

static int told;

/* Nothing is shown from what is wrong to the next key frame; what is shown is right. */
static void check_wrong(const struct stream *s, int unit, enum wrong wrong)
{
	const int key = unit % KEY == 0 ? unit + KEY : (unit / KEY + 1) * KEY;
	struct captured_log log;
	struct played_rig rig;
	struct frame frame;
	char line[512] = "";
	uint32_t n = 0;
	int lines = 0;
	FILE *said;

	rig_start(&rig, only_h264);
	for (int i = 0; i < unit; i++) {
		assert_int_equal(camera_send_unit(&rig, n++, s, i, &frame), 0);
		check_picture(&rig, &frame, i);
	}
	log = captured_log_begin();
	assert_int_equal(send_wrong(&rig, &n, s, unit, wrong, &frame), -EAGAIN);
	for (int i = unit + 1; i < key; i++)
		if (camera_send_unit(&rig, n++, s, i, &frame) != -EAGAIN)
			fail_msg("%d of unit %d: a picture at unit %d", wrong, unit, i);
	said = captured_log_end(&log);
	while (fgets(line, sizeof(line), said)) {
		assert_non_null(strstr(line, "until the next key frame"));
		lines++;
	}
	fclose(said);
	assert_in_range(lines, 0, 1); /* the log itself leaves out what it has said before */
	told += lines;
	for (int i = key; i < s->count; i++) {
		assert_int_equal(camera_send_unit(&rig, n++, s, i, &frame), 0);
		check_picture(&rig, &frame, i);
	}
	assert_int_equal(rig.camera.broken, key - unit - (wrong == LOST || wrong == LOST_UNSEEN));
	assert_int_equal(rig.camera.lost, wrong == LOST);
	played_finish(&rig);
}

TEST("nothing damaged is shown")
{
	static const char *const kinds[] = {X264, "-profile:v baseline " X264 ":slices=3"};

	told = 0;
	for (int k = 0; k < 2; k++) {
		char options[512];
		struct stream *s;

		snprintf(options, sizeof(options), PICTURE ENCODER "%s", kinds[k]);
		s = stream_make(options);
		for (int unit = 0; unit < PICTURES - 2; unit += 3)
			for (int wrong = LOST; unit > 0 && wrong < WRONG_COUNT; wrong++)
				if (unit < PICTURES - KEY && unit % KEY < KEY - 1)
					check_wrong(s, unit, (enum wrong)wrong);
		for (int wrong = LOST; wrong < WRONG_COUNT; wrong++)
			check_wrong(s, KEY, (enum wrong)wrong); /* the key frame itself */
		free(s);
	}
	assert_in_range(told, 3, 12);
}

TEST("a stream is joined in its middle")
{
	struct stream *s = stream_make(PICTURE ENCODER X264);
	struct played_rig rig;
	struct frame frame;

	rig_start(&rig, only_h264);
	for (int i = 4; i < s->count; i++) {
		const int err = camera_send_unit(&rig, (uint32_t)i, s, i, &frame);

		assert_int_equal(err, i < KEY ? -EAGAIN : 0);
		assert_true(rig.camera.keyless_ns > 0);
		if (!err)
			check_picture(&rig, &frame, i);
	}
	assert_int_equal(rig.camera.broken, KEY - 4);
	played_finish(&rig);
	free(s);
}

/* Some encoders never send a key frame, and refresh a column of blocks in each picture: pictures
 * are shown again once the whole picture is new. */
TEST("a gradual refresh ends the wait")
{
	struct stream *s = stream_make(PICTURE ENCODER X264 ":intra-refresh=1");
	struct played_rig rig;
	struct frame frame;
	int shown = 0;

	rig_start(&rig, only_h264);
	for (int i = 0; i < s->count; i++) {
		if (i == 3)
			continue;
		if (camera_send_unit(&rig, (uint32_t)i, s, i, &frame) == 0) {
			assert_true(i < 3 || i >= KEY);
			check_picture(&rig, &frame, i);
			shown++;
		}
	}
	assert_in_range(shown, 10, PICTURES - 8);
	played_finish(&rig);
	free(s);
}

TEST("the size may change")
{
	struct stream *s = stream_make(PICTURE ENCODER X264);
	struct played_rig rig;
	struct frame frame;

	stream_append(
		s, "-f lavfi -i testsrc2=size=128x96:rate=10 -frames:v 5 -pix_fmt yuv420p " ENCODER
			   X264);
	rig_start(&rig, only_h264);
	for (int i = KEY * 2; i < s->count; i++) {
		assert_int_equal(camera_send_unit(&rig, (uint32_t)i, s, i, &frame), 0);
		assert_int_equal(frame.width, i < PICTURES ? WIDTH : 128);
		assert_int_equal(frame.height, i < PICTURES ? HEIGHT : 96);
		assert_int_equal(frame_check(&frame, &rig.fault), 0);
		camera_release(&rig.camera, &frame);
	}
	played_finish(&rig);
	free(s);
}

/* 1080 lines are 1088 to the encoder; here 48 of 50. */
TEST("padding is cut off")
{
	struct stream *s = calloc(1, sizeof(*s));
	struct played_rig rig;
	struct frame frame;

	stream_append(
		s, "-f lavfi -i testsrc2=size=68x50:rate=10 -frames:v 2 -pix_fmt yuv420p " ENCODER
			   X264);
	rig_start(&rig, only_h264);
	assert_int_equal(camera_send_unit(&rig, 0, s, 0, &frame), 0);
	assert_int_equal(frame.width, WIDTH);
	assert_int_equal(frame.height, HEIGHT);
	assert_int_equal(frame_check(&frame, &rig.fault), 0);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);
	free(s);
}

static void check_colours(const char *vui, int range_set, enum colour_matrix matrix,
			  enum colour_range range)
{
	struct played_rig rig;
	struct frame frame;
	struct stream *s;
	char options[512];

	snprintf(options, sizeof(options), PICTURE ENCODER X264 "%s", vui);
	s = stream_make(options);
	played_prepare(&rig, only_h264);
	rig.settings.range = range_set;
	played_must_start(&rig);
	assert_int_equal(camera_send_unit(&rig, 0, s, 0, &frame), 0);
	assert_int_equal(frame.matrix, matrix);
	assert_int_equal(frame.range, range);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);
	free(s);
}

TEST("colours are those of the stream")
{
	check_colours("", 0, MATRIX_BT601, RANGE_LIMITED); /* the kernel's rule */
	check_colours(":colormatrix=bt709", 0, MATRIX_BT709, RANGE_LIMITED);
	check_colours(":fullrange=on:colormatrix=smpte170m", 0, MATRIX_BT601, RANGE_FULL);
	check_colours(":fullrange=on:colormatrix=bt2020nc", 0, MATRIX_BT709, RANGE_FULL);
	check_colours(":fullrange=on", RANGE_LIMITED + 1, MATRIX_BT601, RANGE_LIMITED);
}

TEST("other pixels are refused")
{
	struct stream *s = stream_make(
		"-f lavfi -i testsrc2=size=64x48:rate=10 -frames:v 30 -pix_fmt yuv422p " ENCODER
			X264);
	struct captured_log log = captured_log_begin();
	struct played_rig rig;
	struct frame frame;
	char line[512] = "";
	FILE *said;

	rig_start(&rig, only_h264);
	assert_int_equal(camera_send_unit(&rig, 0, s, 0, &frame), -EAGAIN);
	assert_int_equal(rig.camera.broken, 1);
	played_finish(&rig);
	said = captured_log_end(&log);
	while (fgets(line, sizeof(line), said) && !strstr(line, "4:2:0"))
		;
	assert_non_null(strstr(line, "expected 4:2:0 of 8 bits"));
	fclose(said);
	free(s);
}

/* Parameter sets that come in a buffer of their own are no picture. */
TEST("parameter sets are no picture")
{
	struct stream *s = stream_make(PICTURE ENCODER X264);
	struct h264_count count = {0};
	struct played_rig rig;
	struct frame frame;
	size_t sets = 5;

	while ((s->data[sets] & 31) != 5 || s->data[sets - 1] != 1)
		sets++;
	sets -= 4;
	assert_false(h264_unit_read(&count, s->data, sets).picture);
	assert_true(h264_unit_read(&count, s->data, s->at[1]).picture);
	rig_start(&rig, only_h264);
	assert_int_equal(camera_send(&rig, 0, s->data, sets, &frame), -EAGAIN);
	assert_int_equal(camera_send(&rig, 1, s->data + sets, s->at[1] - sets, &frame), 0);
	check_picture(&rig, &frame, 0);
	assert_int_equal(rig.camera.broken, 0);
	played_finish(&rig);
	free(s);
}

/* A picture's access unit: a slice with this frame_num, of 7 bits. */
static bool gap_before(struct h264_count *count, unsigned header, unsigned number)
{
	/* first_mb_in_slice 0, slice_type 5 and pic_parameter_set_id 0 are the bits 1 00110 1. */
	const uint8_t unit[] = {
		0, 0, 1, (uint8_t)header, 0x9a | number >> 6, (uint8_t)(number << 2 | 2), 0x80};
	const struct h264_unit read = h264_unit_read(count, unit, sizeof(unit));

	assert_true(read.picture);
	return read.gap;
}

/* The parameter set has scaling lists of each kind: whole, cut short, by default. FFmpeg's
 * trace_headers reads log2_max_frame_num_minus4 = 3 in it. */
TEST("lost pictures are counted")
{
	static const uint8_t set[] = {
		0x00, 0x00, 0x01, 0x67, 0x64, 0x00, 0x0a, 0xad, 0xc6, 0x0a, 0x64, 0x18, 0x20,
		0x61, 0x46, 0x1c, 0x42, 0x15, 0xc4, 0x0a, 0x14, 0x20, 0xc0, 0xed, 0x76, 0x28,
		0xc7, 0x2b, 0x18, 0x74, 0x74, 0x20, 0x61, 0xa6, 0x30, 0xc1, 0x0c, 0x85, 0x3b,
		0x11, 0x46, 0x46, 0x14, 0x98, 0x61, 0x05, 0x0c, 0x30, 0xc9, 0x0e, 0x86, 0x32,
		0x0a, 0x18, 0x30, 0xb1, 0x89, 0x14, 0xa2, 0x04, 0x14, 0x85, 0x33, 0x3a, 0x31,
		0x8a, 0x71, 0x83, 0x0e, 0x61, 0x84, 0x14, 0x85, 0x4e, 0x8e, 0x52, 0x8c, 0x14,
		0x79, 0x90, 0xc4, 0xce, 0x42, 0x48, 0xcc, 0x61, 0x00, 0x9c, 0x8d, 0x12, 0xc8};
	enum { KEY_PICTURE = 0x65, REFERENCE = 0x41, UNUSED = 0x01 };
	struct h264_count count = {0};
	const struct h264_unit sets = h264_unit_read(&count, set, sizeof(set));

	assert_int_equal(count.bits, 7);
	assert_true(sets.sequence && !sets.picture);
	assert_int_equal(sets.sets_at, 0);
	assert_int_equal(sets.sets_bytes, sizeof(set));
	assert_false(gap_before(&count, REFERENCE, 125)); /* the first that is seen */
	assert_false(gap_before(&count, UNUSED, 126));
	assert_false(gap_before(&count, UNUSED, 126));
	assert_false(gap_before(&count, REFERENCE, 126));
	assert_false(gap_before(&count, REFERENCE, 127));
	assert_false(gap_before(&count, REFERENCE, 0));
	assert_true(gap_before(&count, UNUSED, 2));
	assert_false(gap_before(&count, REFERENCE, 1));
	assert_true(gap_before(&count, REFERENCE, 3));
	assert_false(gap_before(&count, KEY_PICTURE, 0));
	assert_true(gap_before(&count, REFERENCE, 127));
}

static int setup(void **state)
{
	const size_t bytes = read_output("ffmpeg -v error -nostdin " PICTURE "-f rawvideo -",
					 source, sizeof(source));

	return bytes == sizeof(source) ? played_make_file(state) : -1;
}

TEST_GROUP(setup, played_remove_file);
