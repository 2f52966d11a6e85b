/* SPDX-License-Identifier: MIT */
/* The V4L2 driver against a played device: controls, and what is given up when the bus is full. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "drivers/v4l2/v4l2.h"
#include "tests/support/captured_log.h"
#include "tests/support/played_v4l2.h"
#include "tests/support/test.h"

/* ---- controls; what is logged goes to a file ---- */

static char said[8192];

static int listen_to(int (*act)(struct played_rig *rig), struct played_rig *rig)
{
	const struct captured_log log = captured_log_begin();
	const int err = act(rig);
	FILE *stream = captured_log_end(&log);
	const size_t length = fread(said, 1, sizeof(said) - 1, stream);

	said[length] = '\0';
	fclose(stream);
	return err;
}

static int start_and_listen(struct played_rig *rig)
{
	return listen_to(played_start, rig);
}

static void is_said(const char *text)
{
	if (!strstr(said, text))
		fail_msg("\"%s\" is not in: %s", text, said);
}

enum { GAIN, AUTOMATIC, LINE, BALANCE };

static void prepare_controls(struct played_rig *rig, const char *controls)
{
	static const struct played_control usual[] = {
		{.name = "Gain", .type = V4L2_CTRL_TYPE_INTEGER, .minimum = -8, .maximum = 255},
		{.name = "White Balance, Automatic",
		 .type = V4L2_CTRL_TYPE_BOOLEAN,
		 .maximum = 1,
		 .value = 1},
		{.name = "Power Line Frequency", .type = V4L2_CTRL_TYPE_MENU, .maximum = 2},
		{.name = "White Balance Temperature",
		 .type = V4L2_CTRL_TYPE_INTEGER,
		 .minimum = 2800,
		 .maximum = 6500,
		 .value = 4000},
	};

	played_prepare(rig, played_formats);
	memcpy(played.controls, usual, sizeof(usual));
	strcpy(rig->settings.controls, controls);
}

TEST("controls are set by name")
{
	static const struct {
		const char *text;
		int which, value;
	} cases[] = {
		{"gain=17", GAIN, 17},
		{" Gain = -3 ", GAIN, -3},
		{"gain=0x10,", GAIN, 16},
		{"white_balance_automatic=no", AUTOMATIC, 0},
		{"white_balance_automatic = off", AUTOMATIC, 0},
		{"power_line_frequency=50_hz", LINE, 1},
		{"power_line_frequency=60 Hz", LINE, 2},
		{"power_line_frequency=2", LINE, 2},
		{"white_balance_automatic=0, white_balance_temperature=5000", BALANCE, 5000},
	};
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		prepare_controls(&rig, cases[i].text);
		assert_int_equal(start_and_listen(&rig), 0);
		assert_int_equal(played.controls[cases[i].which].value, cases[i].value);
		assert_int_equal(played.controls[cases[i].which].sets, 1);
		assert_null(strstr(said, "controls"));
		played_finish(&rig);
	}
}

TEST("a renamed control is found")
{
	static const char *const names[][2] = {
		{"White Balance Temperature, Auto", "white_balance_automatic"},
		{"White Balance, Automatic", "white_balance_temperature_auto"},
		{"Exposure, Auto Priority", "exposure_dynamic_framerate"},
		{"Focus, Automatic Continuous", "focus_auto"},
		{"Exposure Time, Absolute", "exposure_absolute"},
		{"Auto Exposure", "exposure_auto"},
	};
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
		char text[80];

		snprintf(text, sizeof(text), "%s=1", names[i][1]);
		prepare_controls(&rig, text);
		played.controls[AUTOMATIC].name = names[i][0];
		assert_int_equal(start_and_listen(&rig), 0);
		assert_int_equal(played.controls[AUTOMATIC].sets, 1);
		assert_null(strstr(said, "controls"));
		played_finish(&rig);
	}
}

TEST("what is refused is named")
{
	static const struct {
		const char *text, *expected;
	} cases[] = {
		{"gain=256", "out of its range"},
		{"gian=3", "perhaps \"gain\""},
		{"gain=much", "expected a whole number from -8 to 255"},
		{"white_balance_automatic=2", "expected yes or no"},
		{"power_line_frequency=70_hz", "has no entry \"70_hz\""},
		{"white_balance_temperature=5000", "automatic is on"},
	};
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		prepare_controls(&rig, cases[i].text);
		played.controls[BALANCE].refuse = EACCES;
		assert_int_equal(start_and_listen(&rig), 0); /* the camera opens all the same */
		is_said("controls");
		is_said(cases[i].expected);
		played_finish(&rig);
	}
	prepare_controls(&rig, "gain=200");
	played.controls[GAIN].most = 100;
	assert_int_equal(start_and_listen(&rig), 0);
	is_said("gain=200 was set, but the camera says 100");
	played_finish(&rig);
	prepare_controls(&rig, "gain=2");
	played.controls[GAIN].flags = V4L2_CTRL_FLAG_READ_ONLY;
	played.controls[GAIN].refuse = EACCES;
	assert_int_equal(start_and_listen(&rig), 0);
	is_said("only be read");
	played_finish(&rig);
}

/* Some webcams reset a control when they start to stream. */
TEST("what starting undoes is set again")
{
	struct played_rig rig;

	prepare_controls(&rig, "gain=99, power_line_frequency=1");
	played.resets = true;
	assert_int_equal(start_and_listen(&rig), 0);
	assert_int_equal(played.controls[GAIN].value, 99);
	assert_int_equal(played.controls[GAIN].sets, 2);
	assert_int_equal(played.controls[LINE].sets, 1);
	assert_null(strstr(said, "controls"));
	played_finish(&rig);
}

/* Tries each second, until the other program has let go. */
static int wait_for_it(struct played_rig *rig)
{
	int err = -EIO;

	for (int n = 0; n < 5; n++) {
		err = played_start(rig);
		camera_close(&rig->camera);
	}
	return err;
}

TEST("what another program uses is left as it is")
{
	struct played_rig rig;

	prepare_controls(&rig, "gain=99, power_line_frequency=1, nonsense=1");
	played.television = played.held = true;
	played.input = 1;
	strcpy(rig.options.input, "0");
	strcpy(rig.options.standard, "PAL");
	assert_int_equal(listen_to(wait_for_it, &rig), -EBUSY);
	assert_int_equal(rig.camera.situation, CAMERA_BUSY);
	assert_non_null(strstr(rig.fault.text, "another program"));
	assert_int_equal(played.changes, 0);
	assert_int_equal(played.controls[GAIN].sets, 0);
	assert_int_equal(played.controls[LINE].sets, 0);
	assert_string_equal(said, "");
	played.held = false;
	assert_int_equal(listen_to(wait_for_it, &rig), 0);
	assert_int_equal(played.changes, 2); /* once each */
	assert_int_equal(played.controls[GAIN].value, 99);
	played_finish(&rig);
}

TEST("what is refused is said once")
{
	const char *first;
	struct played_rig rig;

	prepare_controls(&rig, "gainn=99");
	played.streamon_error = EPROTO;
	assert_int_equal(listen_to(wait_for_it, &rig), -EPROTO);
	is_said("no control \"gainn\"");
	first = strstr(said, "no control");
	assert_null(strstr(first + 1, "no control"));
	played_finish(&rig);
}

TEST("controls that cannot be read are errors")
{
	static const char *const cases[] = {"gain", "gain=", "=3", "gain 3, brightness=2"};
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		prepare_controls(&rig, cases[i]);
		assert_int_equal(start_and_listen(&rig), -EINVAL);
		assert_non_null(strstr(rig.fault.text, "controls"));
		assert_non_null(strstr(rig.fault.text, "name=value"));
		played_finish(&rig);
	}
}

TEST("names are those of v4l2 ctl")
{
	static const char *const cases[][2] = {
		{"Exposure Time, Absolute", "exposure_time_absolute"},
		{"Limited RGB Range (16-235)", "limited_rgb_range_16_235"},
		{"Y'CbCr Encoding", "y_cbcr_encoding"},
		{"Gain", "gain"},
		{"", ""},
	};
	char name[V4L2_CONTROL_NAME_MAX];

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		v4l2_control_name(cases[i][0], name);
		assert_string_equal(name, cases[i][1]);
	}
}

/* ---- controls on the way ---- */

TEST("controls change while it streams")
{
	static const struct {
		const char *name, *value;
		int which, taken;
	} cases[] = {
		{"gain", "17", GAIN, 17},
		{"Gain", "-8", GAIN, -8},
		{"gain", "255", GAIN, 255},
		{"white_balance_automatic", "no", AUTOMATIC, 0},
		{"power_line_frequency", "50_hz", LINE, 1},
		{"power_line_frequency", "2", LINE, 2},
	};
	struct played_rig rig;

	prepare_controls(&rig, "");
	assert_int_equal(camera_set_control(&rig.camera, "gain", "1", NULL, &rig.fault), -EBADF);
	assert_int_equal(start_and_listen(&rig), 0);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		if (camera_set_control(&rig.camera, cases[i].name, cases[i].value, NULL,
				       &rig.fault))
			fail_msg("%s", rig.fault.text);
		assert_int_equal(played.controls[cases[i].which].value, cases[i].taken);
		assert_true(played.streaming);
	}
	played_finish(&rig);
	assert_int_equal(camera_set_control(&rig.camera, "gain", "1", NULL, &rig.fault), -EBADF);
}

/* Exposures in turn, many times. */
static int change_many_times(struct played_rig *rig)
{
	for (int n = 0; n < 100; n++) {
		double taken = n % 2 ? 30 : 7;

		if (camera_set_control(&rig->camera, "gain", n % 2 ? "30" : "7", &taken,
				       &rig->fault))
			return -EIO;
		assert_true(taken == (n % 2 ? 30 : 5));
	}
	return 0;
}

TEST("what is rounded is told and said once")
{
	const char *first;
	struct played_rig rig;

	prepare_controls(&rig, "");
	played.controls[GAIN].step = 5;
	played_must_start(&rig);
	assert_int_equal(listen_to(change_many_times, &rig), 0);
	is_said("gain=7 was set, but the camera says 5");
	first = strstr(said, "was set");
	assert_null(strstr(first + 1, "was set"));
	assert_int_equal(camera_set_control(&rig.camera, "gain", "8", NULL, &rig.fault), 0);
	played_finish(&rig);
}

/* A value that an automatic has set was not taken. */
static int change_in_vain(struct played_rig *rig)
{
	for (int n = 0; n < 10; n++) {
		double taken = 200;

		played.controls[GAIN].most = 20 + n;
		if (camera_set_control(&rig->camera, "gain", "200", &taken, &rig->fault))
			return -EIO;
		assert_true(taken == 200);
	}
	return 0;
}

TEST("what has no effect is said once")
{
	const char *first;
	struct played_rig rig;

	prepare_controls(&rig, "");
	played.controls[GAIN].flags = V4L2_CTRL_FLAG_INACTIVE;
	played_must_start(&rig);
	assert_int_equal(listen_to(change_in_vain, &rig), 0);
	is_said("gain=200 was set, but it has no effect now: is its automatic on?");
	first = strstr(said, "was set");
	assert_null(strstr(first + 1, "was set"));
	played_finish(&rig);
}

TEST("what cannot be changed is named")
{
	static char endless[2 * INI_TEXT_MAX];
	const struct {
		const char *name, *value;
		int err;
		const char *expected;
	} cases[] = {
		{"gain", "256", -ERANGE, "gain is 256, expected -8 to 255"},
		{"gain", "-9", -ERANGE, "expected -8 to 255"},
		{"power_line_frequency", "3", -ERANGE, "expected 0 to 2"},
		{"gain", "much", -EINVAL, "expected a whole number from -8 to 255"},
		{"gain", "", -EINVAL, "expected a whole number"},
		{"gian", "3", -EINVAL, "perhaps \"gain\""},
		{"", "3", -EINVAL, "no control \"\""},
		{"gain", endless, -EINVAL, "so long"},
		{endless, "3", -EINVAL, "so long"},
		{"white_balance_automatic", "2", -EINVAL, "expected yes or no"},
		{"white_balance_temperature", "5000", -EACCES, "automatic is on"},
	};
	struct played_rig rig;

	memset(endless, '1', sizeof(endless) - 1);
	prepare_controls(&rig, "");
	played.controls[BALANCE].refuse = EACCES;
	assert_int_equal(start_and_listen(&rig), 0);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		assert_int_equal(camera_set_control(&rig.camera, cases[i].name, cases[i].value,
						    NULL, &rig.fault),
				 cases[i].err);
		if (!strstr(rig.fault.text, cases[i].expected))
			fail_msg("\"%s\" is not in: %s", cases[i].expected, rig.fault.text);
		assert_true(played.streaming);
		assert_int_equal(played.controls[GAIN].sets, 0);
	}
	played_finish(&rig);
}

/* ---- what is given up; the played bus has `room` bits a second ---- */

enum {
	YUYV_5 = 64 * 48 * 16 * 5,
	MJPEG_30 = 64 * 48 * 4 * 30,
	MJPEG_15 = MJPEG_30 / 2,
	MJPEG_5 = MJPEG_30 / 6,
	SMALL_YUYV_5 = YUYV_5 / 4,
};

static void prepare_room(struct played_rig *rig, double room, const char *give_up)
{
	played_prepare(rig, played_formats);
	played.sizes_known = true;
	played.room = room;
	strcpy(rig->settings.give_up, give_up);
}

TEST("what goes goes in order")
{
	static const struct {
		int format, rate; /* wanted */
		double room;
		const char *give_up;
		int taken_format, width, taken_rate; /* 0: no room for any */
	} cases[] = {
		{PIXEL_YUYV, 5, YUYV_5, "format size rate", PIXEL_YUYV, 64, 5},
		{PIXEL_YUYV, 5, YUYV_5 - 1, "format", PIXEL_MJPEG, 64, 5},
		{PIXEL_YUYV, 5, YUYV_5 - 1, "size,rate", PIXEL_YUYV, 32, 5},
		{PIXEL_MJPEG, 30, MJPEG_30 - 1, "format rate", PIXEL_MJPEG, 64, 15},
		{PIXEL_MJPEG, 30, MJPEG_15 - 1, "format rate", PIXEL_MJPEG, 64, 5},
		{PIXEL_MJPEG, 30, MJPEG_5 - 1, "rate size", PIXEL_MJPEG, 32, 5},
		{PIXEL_MJPEG, 30, MJPEG_5 - 1, "format rate", 0, 0, 0},
		{PIXEL_YUYV, 5, YUYV_5 - 1, "rate", 0, 0, 0},
		{PIXEL_YUYV, 5, YUYV_5 - 1, "", 0, 0, 0},
		{PIXEL_YUYV, 5, SMALL_YUYV_5 - 1, "size format", PIXEL_MJPEG, 32, 5},
	};
	struct played_rig rig;

	for (size_t i = 0; i < 2 * sizeof(cases) / sizeof(cases[0]); i++) {
		const size_t c = i / 2;
		int err;

		prepare_room(&rig, cases[c].room, cases[c].give_up);
		played.room_at_format = i % 2;
		played.rate = (unsigned)cases[c].rate;
		rig.settings.format = cases[c].format;
		rig.settings.rate_hz = cases[c].rate;
		rig.settings.width = 64;
		rig.settings.height = 48;
		if (played.room_at_format && cases[c].rate != 5)
			continue; /* the rate is set after the format */
		err = start_and_listen(&rig);
		if (cases[c].width == 0) {
			assert_int_equal(err, -ENOSPC);
			assert_int_equal(rig.camera.situation, CAMERA_NO_BANDWIDTH);
			assert_non_null(strstr(rig.fault.text, "share its bandwidth"));
			assert_non_null(strstr(rig.fault.text, "give_up"));
			played_finish(&rig);
			continue;
		}
		if (err)
			fail_msg("case %zu: %s", c, rig.fault.text);
		assert_int_equal(rig.camera.format, cases[c].taken_format);
		assert_int_equal(rig.camera.width, cases[c].width);
		assert_true(rig.camera.rate_hz == cases[c].taken_rate);
		if (c > 0) {
			is_said("share its bandwidth");
			is_said("Taken instead");
			is_said(cases[c].give_up);
		}
		played_finish(&rig);
	}
}

TEST("unknown words are errors")
{
	static const char *const cases[] = {"colour", "format, frames", "rate rate"};
	struct played_rig rig;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		prepare_room(&rig, 0, cases[i]);
		assert_int_equal(played_start(&rig), -EINVAL);
		assert_non_null(strstr(rig.fault.text, "give_up"));
		played_finish(&rig);
	}
}

TEST("usb ports")
{
	char port[V4L2_PORT_MAX];

	assert_true(v4l2_usb_port("1-2:1.0", port));
	assert_string_equal(port, "1-2");
	assert_true(v4l2_usb_port("3-1.4.2:1.1", port));
	assert_string_equal(port, "3-1.4.2");
	assert_false(v4l2_usb_port("vivid.0", port));
	assert_false(v4l2_usb_port("0000:00:02.0", port));
	assert_false(v4l2_usb_port("1-2", port));
	assert_false(v4l2_usb_port("", port));
}

/* The kernel cuts names at 31 bytes: a character that it cut through is left out. */
TEST("names are whole characters")
{
	static const struct {
		const char *card, *name;
	} cases[] = {
		{"UVC Camera (046d:0825)", "UVC Camera (046d:0825)"},
		{"\u30ab\u30e1\u30e9\u30ab\u30e1\u30e9\u30ab\u30e1\u30e9\u30ab\xe3",
		 "\u30ab\u30e1\u30e9\u30ab\u30e1\u30e9\u30ab\u30e1\u30e9\u30ab"},
		{"1234567890123456789012345678\xf0\x9f\x98", "1234567890123456789012345678"},
		{"123456789012345678901234567\xf0\x9f\x98\x80",
		 "123456789012345678901234567\xf0\x9f\x98\x80"},
		{"Cam\xe9ra", "Cam?ra"}, /* Latin-1 */
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		uint8_t card[32] = "";
		char name[128];

		memcpy(card, cases[i].card, strlen(cases[i].card));
		device_name(card, name, sizeof(name));
		assert_string_equal(name, cases[i].name);
	}
}

TEST("parts of a pipeline are no cameras")
{
	struct v4l2_capability node = {.card = "Webcam",
				       .capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING};

	assert_false(device_is_part(&node));
	node.capabilities |= V4L2_CAP_IO_MC;
	assert_true(device_is_part(&node));
	node = (struct v4l2_capability){
		.card = "bcm2835-isp", .capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING};
	assert_true(device_is_part(&node));
}

TEST_GROUP(played_make_file, played_remove_file);
