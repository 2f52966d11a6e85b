/* SPDX-License-Identifier: MIT */
/* Texts that the program shows on the screen. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "app/view/words.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

#define NAME "C920"

static const char *const roles[] = {"Fisheye", "Background", "Scene", "Fisheye and background"};

TEST("each situation has a sentence")
{
	char text[CAMERA_SITUATION_COUNT][256], start[80];

	for (int r = 0; r < 4; r++) {
		for (int s = CAMERA_FINE + 1; s < CAMERA_SITUATION_COUNT; s++) {
			int length = words_camera(text[s], sizeof(text[s]), roles[r], NAME,
						  (enum camera_situation)s, "");

			expect_equal(length, strlen(text[s]), "r=%d, s=%d", r, s);
			snprintf(start, sizeof(start), "%s camera '" NAME "' ", roles[r]);
			assert_memory_equal(text[s], start, strlen(start));
			expect_above(strlen(text[s]), strlen(start) + 10, "r=%d, s=%d", r, s);
			assert_null(strstr(text[s], "(null)"));
			for (int other = CAMERA_FINE + 1; other < s; other++)
				assert_string_not_equal(text[s], text[other]);
			/* an unknown name leaves no empty quotes */
			words_camera(text[s], sizeof(text[s]), roles[r], "",
				     (enum camera_situation)s, "");
			assert_null(strchr(text[s], '\''));
			words_camera(text[s], sizeof(text[s]), roles[r], NAME,
				     (enum camera_situation)s, "");
		}
	}
}

TEST("names a pose")
{
	char text[256];
	int length;

	length = words_pose(text, sizeof(text), 3, "left");
	assert_int_equal(length, strlen(text));
	assert_string_equal(text, "Pose 3 'left' cannot be loaded: waiting, the log says why");
	words_pose(text, sizeof(text), 12, "");
	assert_string_equal(text, "Pose 12 cannot be loaded: waiting, the log says why");
}

TEST("says what is wrong")
{
	static const struct {
		enum camera_situation situation;
		const char *word;
	} cases[] = {
		{CAMERA_NO_DEVICE, "not connected: waiting"},
		{CAMERA_NO_SIGNAL, "no video signal"},
		{CAMERA_STALLED, "sends no picture"},
		{CAMERA_DAMAGED, "only damaged pictures"},
		{CAMERA_UNSUPPORTED_FORMAT, "sends no picture that can be used"},
		{CAMERA_BUSY, "used by another program"},
		{CAMERA_NO_BANDWIDTH, "no room on its USB bus"},
		{CAMERA_NO_PERMISSION, "group video"},
		{CAMERA_BROKEN, "log"},
	};
	char text[256];

	assert_int_equal(sizeof(cases) / sizeof(*cases), CAMERA_SITUATION_COUNT - 1);
	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		words_camera(text, sizeof(text), "Scene", NAME, cases[i].situation, "");
		assert_non_null(strstr(text, cases[i].word));
	}
	words_camera(text, sizeof(text), "Fisheye", NAME, CAMERA_NO_DEVICE, "");
	assert_string_equal(text, "Fisheye camera 'C920' is not connected: waiting");
	words_camera(text, sizeof(text), "Scene", "", CAMERA_UNSUPPORTED_FORMAT,
		     "/dev/video2: the camera offers H264, expected MJPEG");
	assert_string_equal(
		text,
		"Scene camera sends no picture that can be used: /dev/video2: the camera offers H264, expected MJPEG");
}

TEST("nothing to say")
{
	char text[8] = "before";

	assert_int_equal(words_camera(text, sizeof(text), "Scene", NAME, CAMERA_FINE, ""), 0);
	assert_string_equal(text, "");
	assert_int_equal(
		words_camera(text, sizeof(text), "Scene", NAME, CAMERA_SITUATION_COUNT, ""), 0);
}

/* A long name does not push out what is wrong, and no buffer overflows. */
TEST("long names and little room")
{
	static const char *const names[] = {
		"/dev/v4l/by-path/pci-0000:00:14.0-usb-0:1.4.3.2.1:1.0-video-index0",
		"äöüäöüäöüäöüäöüäöüäöüäöüäöüäöüäöüäöüäöü",
		"日本語日本語日本語日本語日本語日本語日本語日本語",
		"\xff\xfe\n\t\x1b[2J",
	};
	char whole[256], cut[300];

	for (size_t n = 0; n < sizeof(names) / sizeof(*names); n++) {
		int length = words_camera(whole, sizeof(whole), "Fisheye and background", names[n],
					  CAMERA_NO_DEVICE, "");

		expect_below(length, 130, "n=%zu", n);
		assert_non_null(strstr(whole, "' is not connected: waiting"));
		assert_null(strchr(whole, '\n'));
		assert_null(strchr(whole, '\x1b'));
		for (size_t room = 0; room <= (size_t)length + 1; room++) {
			memset(cut, '#', sizeof(cut));
			expect_equal(words_camera(cut, room, "Fisheye and background", names[n],
						  CAMERA_NO_DEVICE, ""),
				     length, "n=%zu, room=%zu", n, room);
			expect_equal(cut[room], '#', "n=%zu, room=%zu", n, room);
			if (room == 0)
				continue;
			assert_memory_equal(cut, whole, strlen(cut));
			expect_that(strlen(cut) < room && room - strlen(cut) <= 4,
				    "n=%zu, room=%zu", n, room);
			/* a character starts where the text was cut */
			assert_int_not_equal(whole[strlen(cut)] & 0xc0, 0x80);
		}
	}
}

TEST("figures")
{
	struct words_figures f = {.lights_used = 212,
				  .lights = 406,
				  .threshold = 32,
				  .error = 0.0137,
				  .frames_a_second = 29.94,
				  .latency_ms = 38.2,
				  .drops = 12,
				  .clipped = 0.003};
	char text[512];
	int length = words_information(text, sizeof(text), &f);

	assert_int_equal(length, strlen(text));
	assert_string_equal(
		text,
		"lights 212 of 406 · threshold 32 · error ≤ 1.4 % of white · 29.9 frames/s · latency 38 ms · 12 dropped · sky clipped 0.3 %");
	f.threshold = 12.5;
	f.clipped = 0;
	f.error = 0;
	words_information(text, sizeof(text), &f);
	assert_non_null(strstr(text, "threshold 12.5 ·"));
	f.threshold = 0.25;
	f.percent = true;
	words_information(text, sizeof(text), &f);
	assert_non_null(strstr(text, "threshold 0.25 % ·"));
	assert_non_null(strstr(text, "error ≤ 0.0 % of white"));
	assert_non_null(strstr(text, "clipped 0.0 %"));
	f.clipped = 0.0001; /* a small share is not shown as none */
	words_information(text, sizeof(text), &f);
	assert_non_null(strstr(text, "clipped < 0.1 %"));
	f.recovered = true;
	words_information(text, sizeof(text), &f);
	assert_string_equal(strstr(text, "clipped"), "clipped < 0.1 %, recovered");
	f.at_bound = true;
	words_information(text, sizeof(text), &f);
	assert_string_equal(strstr(text, "clipped"), "clipped < 0.1 %, recovered in part");
	f.people = true;
	f.learned = 0.987;
	f.in_front = 2;
	words_information(text, sizeof(text), &f);
	assert_non_null(strstr(text, " · place learned 98 %, 2 in front"));
	assert_null(strstr(text, " in front by"));
	f.depth = true;
	words_information(text, sizeof(text), &f);
	assert_non_null(strstr(text, "2 in front by feet"));
	f.by_depth = true;
	words_information(text, sizeof(text), &f);
	assert_non_null(strstr(text, "2 in front by depth"));
	f.unsure = true;
	f.moved_px[0] = -1.6;
	words_information(text, sizeof(text), &f);
	assert_string_equal(
		strstr(text, "depth"),
		"depth · place not recognized, only who moves is in front · camera moved 2 px left");
	f.people = false;
	f.lamp = true;
	f.lamp_deg[0] = 134.4;
	f.lamp_deg[1] = 21.6;
	words_information(text, sizeof(text), &f);
	assert_string_equal(
		strstr(text, " · lamp"),
		" · lamp at azimuth 134°, height 22°: shadow too soft, the dome is coarse there");
	expect_below(strlen(text), 256, "what the overlay takes");
	f.lamp = false;
	f.missing_lamp = "desk";
	f.unnamed_azimuth_deg = 134.4;
	f.unnamed_height_deg = 21.6;
	f.unnamed_off = 0.081;
	words_information(text, sizeof(text), &f);
	assert_string_equal(
		strstr(text, " · no light"),
		" · no light at lamp desk · light at 134°, 22° high, no [lamp]: off 8 % if 1.5 m away");
	expect_below(strlen(text), 256, "what the overlay takes");
}

/* "at most" stays true when the number is rounded. */
TEST("a bound is rounded up")
{
	char text[256], expected[64];

	for (int i = 0; i < 3000; i++) {
		const struct words_figures f = {.error = i / 10000.0};
		int tenths = (i + 9) / 10;

		words_information(text, sizeof(text), &f);
		if (i < 1000)
			snprintf(expected, sizeof(expected), "error ≤ %d.%d %% of white",
				 tenths / 10, tenths % 10);
		else
			snprintf(expected, sizeof(expected), "error ≤ %d %% of white",
				 (i + 99) / 100);
		assert_non_null(strstr(text, expected));
	}
}

TEST("figures out of all bounds")
{
	const struct words_figures wild[] = {
		{.error = INFINITY, .latency_ms = 1e300, .frames_a_second = -1e300},
		{.error = NAN, .threshold = NAN, .clipped = NAN, .drops = UINT64_MAX},
		{.lights = INT32_MAX, .lights_used = INT32_MIN, .error = 1e300},
	};
	char text[64];

	for (size_t i = 0; i < sizeof(wild) / sizeof(*wild); i++) {
		memset(text, '#', sizeof(text));
		expect_above(words_information(text, 60, &wild[i]), 0, "i=%zu", i);
		expect_below(strlen(text), 60, "i=%zu", i);
		expect_equal(text[60], '#', "i=%zu", i);
	}
}

TEST("the camera was moved")
{
	char text[512];

	words_moved(text, sizeof(text), (const double[2]){10.2, 0.3});
	assert_string_equal(
		text,
		"The background's camera was moved: its picture lies 10 px right of where it was. Nobody is before the object until it is calibrated again (inlay-calibrate camera)");
	words_moved(text, sizeof(text), (const double[2]){-3, -2});
	assert_non_null(strstr(text, "lies 3 px left and 2 px up of where"));
	words_moved(text, sizeof(text), (const double[2]){0, 7});
	assert_non_null(strstr(text, "lies 7 px down of where"));
}
