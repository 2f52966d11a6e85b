/* SPDX-License-Identifier: MIT */
/* The V4L2 driver against a played digitizer: inputs, standards, fields, signal. */
#include <errno.h>
#include <poll.h>
#include <string.h>

#include "drivers/v4l2/v4l2.h"
#include "hal/base/clock.h"
#include "tests/support/played_v4l2.h"
#include "tests/support/test.h"

enum { FIELD_BYTES = PLAYED_YUYV_BYTES / 2 };

static const uint32_t yuyv[] = {V4L2_PIX_FMT_YUYV, 0};

static void prepare_television(struct played_rig *rig, v4l2_std_id detected)
{
	played_prepare(rig, yuyv);
	played.television = true;
	played.detected = detected;
	played.standard = V4L2_STD_NTSC_M;
}

static void digitizer_grab(struct played_rig *rig, struct frame *frame)
{
	if (camera_grab(&rig->camera, frame, &rig->fault))
		fail_msg("no frame: %s", rig->fault.text);
}

static void nothing_comes(struct played_rig *rig)
{
	struct frame frame;

	assert_int_equal(camera_grab(&rig->camera, &frame, &rig->fault), -EAGAIN);
}

/* ---- inputs and standards ---- */

TEST("inputs by number and name")
{
	static const struct {
		const char *text;
		int input; /* -1: refused */
	} cases[] = {{"", 1},	     {"-1", 1},	    {"0", 0},	  {"1", 1},  {"Composite 0", 0},
		     {"s-video", 1}, {"SVIDEO", 1}, {"HDMI", -1}, {"2", -1}, {"1x", -1}};
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		int err;

		played_prepare(&rig, yuyv);
		played.input = 1;
		strcpy(rig.options.input, cases[i].text);
		err = played_start(&rig);
		assert_int_equal(err, cases[i].input < 0 ? -EINVAL : 0);
		if (err) {
			assert_non_null(strstr(rig.fault.text, "v4l2.input"));
			assert_non_null(strstr(rig.fault.text, "S-Video"));
		} else {
			assert_int_equal(played.input, cases[i].input);
		}
		played_finish(&rig);
	}
}

TEST("standards by name")
{
	static const struct {
		const char *text;
		v4l2_std_id detected, set; /* set 0: the call is refused */
	} cases[] = {
		{"", V4L2_STD_PAL_BG, V4L2_STD_PAL_BG},
		{"", V4L2_STD_ALL,
		 V4L2_STD_NTSC_M}, /* no signal: the standard that was set stays */
		{"", 0, V4L2_STD_NTSC_M},
		{"PAL", V4L2_STD_NTSC_M,
		 V4L2_STD_PAL_BG}, /* the variants of PAL that the input knows */
		{"ntsc", V4L2_STD_PAL_BG, V4L2_STD_NTSC_M},
		{"PAL-BG", 0, V4L2_STD_PAL_BG},
		{"pal bg", 0, V4L2_STD_PAL_BG},
		{"SECAM", 0, 0},
		{"PAL-Z", 0, 0},
	};
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		int err;

		prepare_television(&rig, cases[i].detected);
		strcpy(rig.options.standard, cases[i].text);
		err = played_start(&rig);
		assert_int_equal(err, cases[i].set ? 0 : -EINVAL);
		if (err) {
			assert_non_null(strstr(rig.fault.text, "v4l2.standard"));
			assert_non_null(strstr(rig.fault.text, "NTSC-M"));
		} else {
			assert_true(played.standard == cases[i].set);
		}
		played_finish(&rig);
	}
	played_prepare(&rig, yuyv);
	strcpy(rig.options.standard, "PAL");
	assert_int_equal(played_start(&rig), -EINVAL);
	assert_non_null(strstr(rig.fault.text, "not a television"));
	played_finish(&rig);
}

/* ---- fields ---- */

TEST("fields of formats")
{
	static const struct {
		uint32_t field;
		v4l2_std_id standard;
		enum frame_fields fields;
		bool bottom_first, one_field;
	} cases[] = {
		{V4L2_FIELD_NONE, V4L2_STD_PAL, FIELDS_NONE, false, false},
		{V4L2_FIELD_ANY, 0, FIELDS_NONE, false, false},
		{V4L2_FIELD_ANY, V4L2_STD_PAL, FIELDS_INTERLACED, false, false},
		{V4L2_FIELD_ANY, V4L2_STD_NTSC, FIELDS_INTERLACED, true, false},
		{V4L2_FIELD_INTERLACED, V4L2_STD_PAL, FIELDS_INTERLACED, false, false},
		{V4L2_FIELD_INTERLACED, V4L2_STD_NTSC, FIELDS_INTERLACED, true, false},
		{V4L2_FIELD_INTERLACED, V4L2_STD_PAL_60, FIELDS_INTERLACED, true, false},
		{V4L2_FIELD_INTERLACED, 0, FIELDS_INTERLACED, false, false},
		{V4L2_FIELD_INTERLACED_TB, V4L2_STD_NTSC, FIELDS_INTERLACED, false, false},
		{V4L2_FIELD_INTERLACED_BT, V4L2_STD_PAL, FIELDS_INTERLACED, true, false},
		{V4L2_FIELD_SEQ_TB, V4L2_STD_NTSC, FIELDS_TOP_BOTTOM, false, false},
		{V4L2_FIELD_SEQ_BT, V4L2_STD_PAL, FIELDS_BOTTOM_TOP, true, false},
		{V4L2_FIELD_ALTERNATE, V4L2_STD_PAL, FIELDS_PAIR, false, true},
		{V4L2_FIELD_ALTERNATE, V4L2_STD_NTSC, FIELDS_PAIR, true, true},
		{V4L2_FIELD_TOP, V4L2_STD_PAL, FIELDS_TOP, false, true},
		{V4L2_FIELD_BOTTOM, V4L2_STD_PAL, FIELDS_BOTTOM, true, true},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const struct v4l2_lines lines = v4l2_lines_of(cases[i].field, cases[i].standard);

		assert_int_equal(lines.fields, cases[i].fields);
		assert_int_equal(lines.bottom_first, cases[i].bottom_first);
		assert_int_equal(lines.one_field, cases[i].one_field);
		assert_true(strlen(v4l2_lines_text(&lines)) > 5);
	}
}

TEST("fields are asked for")
{
	static const struct {
		enum v4l2_field_wish wish;
		v4l2_std_id detected;
		enum frame_fields fields;
		unsigned rows; /* rows of a buffer */
	} cases[] = {
		{V4L2_WISH_DRIVER, V4L2_STD_PAL_BG, FIELDS_INTERLACED, 48},
		{V4L2_WISH_NONE, V4L2_STD_PAL_BG, FIELDS_NONE, 48},
		{V4L2_WISH_INTERLACED, V4L2_STD_PAL_BG, FIELDS_INTERLACED, 48},
		{V4L2_WISH_SEQUENTIAL, V4L2_STD_PAL_BG, FIELDS_TOP_BOTTOM, 48},
		{V4L2_WISH_SEQUENTIAL, V4L2_STD_NTSC_M, FIELDS_BOTTOM_TOP, 48},
		{V4L2_WISH_ALTERNATE, V4L2_STD_PAL_BG, FIELDS_PAIR, 24},
		{V4L2_WISH_TOP, V4L2_STD_PAL_BG, FIELDS_TOP, 24},
		{V4L2_WISH_BOTTOM, V4L2_STD_PAL_BG, FIELDS_BOTTOM, 24},
	};
	struct frame frame;
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]) * 2; i++) {
		const size_t c = i / 2;

		prepare_television(&rig, cases[c].detected);
		rig.options.field = cases[c].wish;
		/* Height of the whole picture, or as the device has it. */
		rig.settings.height = i % 2 ? 48 : 0;
		played_must_start(&rig);
		assert_int_equal(rig.camera.height, 48);
		assert_int_equal(played.height, cases[c].rows);
		if (cases[c].fields != FIELDS_PAIR) {
			played_deliver(0, 0, 64 * 2 * cases[c].rows, 0);
			digitizer_grab(&rig, &frame);
			assert_int_equal(frame.fields, cases[c].fields);
			assert_int_equal(frame.height, 48);
			camera_release(&rig.camera, &frame);
			played_deliver(0, 1, 64 * 2 * cases[c].rows - 1, 0); /* short */
			nothing_comes(&rig);
		}
		played_finish(&rig);
	}
}

TEST("a buffer may say more")
{
	struct frame frame;
	struct played_rig rig;

	prepare_television(&rig, V4L2_STD_PAL_BG);
	played_must_start(&rig);
	played_deliver(0, 0, PLAYED_YUYV_BYTES, 0)->field = V4L2_FIELD_INTERLACED_BT;
	digitizer_grab(&rig, &frame);
	assert_int_equal(frame.fields, FIELDS_INTERLACED);
	assert_true(frame.bottom_first);
	camera_release(&rig.camera, &frame);
	played_deliver(0, 1, PLAYED_YUYV_BYTES, 0)->field = V4L2_FIELD_ANY; /* as the format says */
	digitizer_grab(&rig, &frame);
	assert_int_equal(frame.fields, FIELDS_INTERLACED);
	assert_false(frame.bottom_first);
	camera_release(&rig.camera, &frame);
	/* Progressive, from a film. */
	played_deliver(0, 2, PLAYED_YUYV_BYTES, 0)->field = V4L2_FIELD_NONE;
	digitizer_grab(&rig, &frame);
	assert_int_equal(frame.fields, FIELDS_NONE);
	camera_release(&rig.camera, &frame);
	played_finish(&rig);
}

TEST("heights without halves are refused")
{
	struct played_rig rig;

	prepare_television(&rig, V4L2_STD_PAL_BG);
	played.height = 47;
	assert_int_equal(played_start(&rig), -EINVAL);
	assert_non_null(strstr(rig.fault.text, "47"));
	played_finish(&rig);
}

/* A squeezed picture of one field has the height that was asked for. */
TEST("a field of the wanted height is a picture")
{
	struct v4l2_format format = {.type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
	struct v4l2_picture picture;

	format.fmt.pix = (struct v4l2_pix_format){.width = 64,
						  .height = 24,
						  .pixelformat = V4L2_PIX_FMT_YUYV,
						  .bytesperline = 128,
						  .field = V4L2_FIELD_BOTTOM};
	assert_int_equal(v4l2_picture_of(&format, V4L2_STD_PAL, 24, &picture, NULL), 0);
	assert_int_equal(picture.height, 24);
	assert_int_equal(picture.lines.fields, FIELDS_NONE);
	assert_int_equal(v4l2_picture_of(&format, V4L2_STD_PAL, 48, &picture, NULL), 0);
	assert_int_equal(picture.height, 48);
	assert_int_equal(picture.rows, 24);
	assert_int_equal(picture.lines.fields, FIELDS_BOTTOM);
}

/* ---- pairs ---- */

static void start_pairs(struct played_rig *rig, v4l2_std_id standard)
{
	prepare_television(rig, standard);
	rig->options.field = V4L2_WISH_ALTERNATE;
	played_must_start(rig);
	assert_int_equal(played_queued(), 8); /* four pictures */
}

static void field_comes(int buffer, uint32_t sequence, bool bottom, uint32_t flags)
{
	played_deliver(buffer, sequence, FIELD_BYTES, flags)->field = bottom ? V4L2_FIELD_BOTTOM
									     : V4L2_FIELD_TOP;
}

TEST("two fields are a picture")
{
	struct frame frame;
	struct played_rig rig;

	for (int bottom_first = 0; bottom_first < 2; bottom_first++) {
		start_pairs(&rig, bottom_first ? V4L2_STD_NTSC_M : V4L2_STD_PAL_BG);
		field_comes(2, 7, bottom_first, 0);
		nothing_comes(&rig);
		assert_int_equal(played_queued(), 7);
		field_comes(5, 7, !bottom_first, 0);
		digitizer_grab(&rig, &frame);
		assert_int_equal(frame.fields, FIELDS_PAIR);
		assert_int_equal(frame.bottom_first, bottom_first);
		assert_int_equal(frame.height, 48);
		assert_int_equal(frame.planes[0].data[0], (bottom_first ? 5 : 2) * 2 + 1);
		assert_int_equal(frame.bottom_planes[0].data[0], (bottom_first ? 2 : 5) * 2 + 1);
		assert_int_equal(frame.bottom_planes[0].bytes, FIELD_BYTES);
		assert_int_equal(played_queued(), 6);
		camera_release(&rig.camera, &frame);
		assert_int_equal(played_queued(), 8);
		assert_int_equal(rig.camera.broken, 0);
		assert_int_equal(rig.camera.lost, 0);
		played_finish(&rig);
	}
}

TEST("the newest pair wins")
{
	struct frame frame;
	struct played_rig rig;

	start_pairs(&rig, V4L2_STD_PAL_BG);
	for (int i = 0; i < 7; i++) /* three pairs and a half */
		field_comes(i, (uint32_t)i / 2, i % 2, 0);
	digitizer_grab(&rig, &frame);
	assert_int_equal(frame.sequence, 2);
	assert_int_equal(rig.camera.lost, 2);
	assert_int_equal(played_queued(), 5); /* a pair is held, a field waits */
	camera_release(&rig.camera, &frame);
	field_comes(7, 3, true, 0);
	digitizer_grab(&rig, &frame);
	assert_int_equal(frame.sequence, 3);
	assert_int_equal(frame.planes[0].data[0], 6 * 2 + 1);
	assert_int_equal(rig.camera.lost, 2);
	camera_release(&rig.camera, &frame);
	assert_int_equal(played_queued(), 8);
	played_finish(&rig);
}

TEST("an orphan is broken")
{
	struct frame frame;
	struct played_rig rig;

	start_pairs(&rig, V4L2_STD_PAL_BG);
	field_comes(0, 0, false, 0); /* its other field is lost */
	field_comes(1, 1, false, 0);
	nothing_comes(&rig);
	assert_int_equal(rig.camera.broken, 1);
	assert_int_equal(played_queued(), 7);
	field_comes(2, 1, true, 0);
	digitizer_grab(&rig, &frame);
	assert_int_equal(frame.sequence, 1);
	camera_release(&rig.camera, &frame);
	field_comes(0, 2, false, 0); /* the bottom field of 2 and the top field of 3 are lost */
	field_comes(1, 3, true, 0);
	nothing_comes(&rig);
	assert_int_equal(rig.camera.broken, 2);
	field_comes(2, 4, false, 0);
	field_comes(3, 4, true, 0);
	digitizer_grab(&rig, &frame);
	assert_int_equal(frame.sequence, 4);
	assert_int_equal(rig.camera.broken, 3);
	assert_int_equal(rig.camera.lost, 0);
	camera_release(&rig.camera, &frame);
	assert_int_equal(played_queued(), 8);
	played_finish(&rig);
}

TEST("a picture with an unfit field is broken once")
{
	struct frame frame;
	struct played_rig rig;

	for (int unfit = 0; unfit < 2; unfit++) {
		start_pairs(&rig, V4L2_STD_PAL_BG);
		field_comes(0, 0, false, unfit == 0 ? V4L2_BUF_FLAG_ERROR : 0);
		field_comes(1, 0, true, unfit == 1 ? V4L2_BUF_FLAG_ERROR : 0);
		nothing_comes(&rig);
		assert_int_equal(rig.camera.broken, 1);
		assert_int_equal(played_queued(), 8);
		field_comes(2, 1, false, 0);
		field_comes(3, 1, true, 0);
		digitizer_grab(&rig, &frame);
		assert_int_equal(rig.camera.broken, 1);
		camera_release(&rig.camera, &frame);
		played_finish(&rig);
	}
	start_pairs(&rig, V4L2_STD_PAL_BG); /* a buffer that does not say which field it holds */
	played_deliver(0, 0, FIELD_BYTES, 0)->field = V4L2_FIELD_NONE;
	nothing_comes(&rig);
	assert_int_equal(rig.camera.broken, 1);
	assert_int_equal(played_queued(), 8);
	played_finish(&rig);
}

TEST("sequence numbers of pairs wrap")
{
	struct frame frame;
	struct played_rig rig;

	start_pairs(&rig, V4L2_STD_PAL_BG);
	for (uint32_t i = 0; i < 6; i++) {
		const uint32_t sequence = UINT32_MAX - 1 + i / 2;

		field_comes((int)i, sequence, i % 2, 0);
		if (i % 2 == 0)
			continue;
		digitizer_grab(&rig, &frame);
		assert_int_equal(frame.sequence, sequence);
		camera_release(&rig.camera, &frame);
	}
	assert_int_equal(rig.camera.lost, 0);
	assert_int_equal(rig.camera.broken, 0);
	played_finish(&rig);
}

/* Some drivers number fields; V4L2 says that both fields of a frame have the same number. */
TEST("a driver that counts fields is understood")
{
	struct frame frame;
	struct played_rig rig;
	uint32_t pictures = 0;

	start_pairs(&rig, V4L2_STD_NTSC_M);
	for (uint32_t i = 0; i < 20; i++) {
		field_comes((int)i % 8, i, i % 2 == 1, 0); /* bottom fields have odd numbers */
		if (camera_grab(&rig.camera, &frame, &rig.fault))
			continue;
		assert_true(frame.bottom_first);
		camera_release(&rig.camera, &frame);
		pictures++;
	}
	assert_in_range(pictures, 6, 8);
	assert_in_range(rig.camera.broken, 1, 5); /* until the driver has understood it */
	played_finish(&rig);
}

/* ---- signal and changes ---- */

TEST("no signal is a situation")
{
	static const struct {
		uint32_t status;
		int err;
	} cases[] = {{V4L2_IN_ST_NO_SIGNAL, -ENOLINK},
		     {V4L2_IN_ST_NO_SYNC, -ENOLCK},
		     {V4L2_IN_ST_NO_H_LOCK, -ENOLCK}};
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		prepare_television(&rig, 0);
		played.status = cases[i].status;
		assert_int_equal(played_start(&rig), cases[i].err);
		assert_int_equal(rig.camera.situation, CAMERA_NO_SIGNAL);
		assert_non_null(strstr(rig.fault.text, "Composite 0"));
		played_finish(&rig);
	}
	played_prepare(&rig, yuyv);
	played.dv_timings = true;
	played.signal_error = ENOLCK;
	assert_int_equal(played_start(&rig), -ENOLCK);
	assert_int_equal(rig.camera.situation, CAMERA_NO_SIGNAL);
	played_finish(&rig);
}

/* A device that sends events is trusted; any other is asked each second. */
TEST("a signal that is lost is noticed")
{
	const int64_t limit_ns = clock_now_ns() + 60 * NS_PER_S;
	struct frame frame;
	struct played_rig rig;
	int err;

	prepare_television(&rig, V4L2_STD_PAL_BG);
	played_must_start(&rig);
	played.status = V4L2_IN_ST_NO_SIGNAL;
	while ((err = camera_grab(&rig.camera, &frame, &rig.fault)) == -EAGAIN &&
	       clock_now_ns() < limit_ns)
		poll(NULL, 0, 20);
	assert_int_equal(err, -ENOLINK);
	assert_int_equal(rig.camera.situation, CAMERA_NO_SIGNAL);
	assert_non_null(strstr(rig.fault.text, "no signal"));
	played_finish(&rig);
}

TEST("a changed source is stale")
{
	struct frame frame;
	struct played_rig rig;

	prepare_television(&rig, V4L2_STD_PAL_BG);
	played.tells = true;
	played_must_start(&rig);
	assert_true(camera_descriptor(&rig.camera) >= 0);
	nothing_comes(&rig);
	played.events = 3;
	played_deliver(0, 0, PLAYED_YUYV_BYTES, 0);
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -ESTALE);
	assert_int_equal(played.events, 0);
	assert_int_equal(rig.camera.situation, CAMERA_FINE);
	played_finish(&rig);
}

TEST_GROUP(played_make_file, played_remove_file);
