/* SPDX-License-Identifier: MIT */
/* What settings ask of a camera, whichever driver it has: controls and formats. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/device/camera.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

TEST("assignments are taken one by one")
{
	const char *text = ",, gain = 17 ,White Balance=off,\tgains=1.5 2,focus=a=b , ";
	static const struct camera_control expected[] = {
		{"gain", "17"}, {"White Balance", "off"}, {"gains", "1.5 2"}, {"focus", "a=b"}};
	struct camera_control got;
	struct fault fault = {.text = ""};

	for (int i = 0; i < 4; i++) {
		expect_equal(camera_controls_next(&text, &got, &fault), 1, "i=%d", i);
		assert_string_equal(got.name, expected[i].name);
		assert_string_equal(got.value, expected[i].value);
	}
	for (int i = 0; i < 2; i++)
		assert_int_equal(camera_controls_next(&text, &got, &fault), 0);
	assert_string_equal(fault.text, "");
}

TEST("what is no assignment is quoted")
{
	static const char *const wrong[] = {"gain", "gain=", "=3", "gain = ", " = ", "="};
	struct camera_control got;
	char name[CAMERA_CONTROL_NAME_MAX + 8], value[INI_TEXT_MAX + 8];
	const char *text;
	struct fault fault;

	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
		char both[64];

		snprintf(both, sizeof(both), "%s,focus=1", wrong[i]);
		text = both;
		expect_equal(camera_controls_next(&text, &got, &fault), -EINVAL, "i=%zu", i);
		assert_non_null(strstr(fault.text, "expected name=value"));
		expect_equal(camera_controls_next(&text, &got, &fault), 1, "i=%zu", i);
		assert_string_equal(got.name, "focus");
	}
	memset(name, 'n', sizeof(name));
	for (int spare = -1; spare <= 0; spare++) { /* the longest name, and one character more */
		strcpy(name + CAMERA_CONTROL_NAME_MAX + spare, "=1");
		text = name;
		expect_equal(camera_controls_next(&text, &got, &fault), spare ? 1 : -EINVAL,
			     "spare=%d", spare);
		name[CAMERA_CONTROL_NAME_MAX + spare] = 'n';
	}
	memset(value, 'v', sizeof(value));
	memcpy(value, "n=", 2);
	for (int spare = -1; spare <= 0; spare++) {
		value[2 + INI_TEXT_MAX + spare] = '\0';
		text = value;
		expect_equal(camera_controls_next(&text, &got, &fault), spare ? 1 : -EINVAL,
			     "spare=%d", spare);
		value[2 + INI_TEXT_MAX + spare] = 'v';
	}
}

TEST("rate goes before size and size before cost")
{
	static const enum pixel_format order[] = {PIXEL_BGRX, PIXEL_BGR24, PIXEL_RGB24, PIXEL_YUYV,
						  PIXEL_UYVY, PIXEL_NV12,  PIXEL_MJPEG, PIXEL_GREY};

	for (int i = 1; i < 8; i++)
		for (int has = 0; has < 3; has++)
			expect_below(camera_format_merit(order[i], has > 0, has > 1),
				     camera_format_merit(order[i - 1], has > 0, has > 1),
				     "i=%d, has=%d", i, has);
	assert_true(camera_format_merit(PIXEL_GREY, true, false) >
		    /* This rate exists at another size only. */
		    camera_format_merit(PIXEL_BGRX, false, true));
	assert_true(camera_format_merit(PIXEL_GREY, true, true) >
		    camera_format_merit(PIXEL_BGRX, true, false));
	assert_true(camera_format_merit(PIXEL_Y10, false, false) >
		    camera_format_merit(PIXEL_H264, true, true));
	assert_true(camera_format_merit(PIXEL_H264, false, false) >
		    camera_format_merit(PIXEL_Z16, true, true));
	assert_true(camera_format_merit(PIXEL_Z16, false, false) > 0);
	assert_int_equal(camera_format_merit(PIXEL_NONE, true, true), 0);
	assert_int_equal(camera_format_merit(PIXEL_RGBF, true, true), 0);
}
