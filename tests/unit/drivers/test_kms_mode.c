/* SPDX-License-Identifier: MIT */
/* What the KMS display decides without a card: timings against published ones, the mode of a
 * connector, the place of a picture, and which kernel messages are about screens. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "drivers/kms/kms.h"
#include "tests/support/test.h"

#define P_P (DRM_MODE_FLAG_PHSYNC | DRM_MODE_FLAG_PVSYNC)
#define N_N (DRM_MODE_FLAG_NHSYNC | DRM_MODE_FLAG_NVSYNC)
#define P_N (DRM_MODE_FLAG_PHSYNC | DRM_MODE_FLAG_NVSYNC)

static void assert_timing(const drmModeModeInfo *mode, uint32_t clock, const int across[4],
			  const int down[4], uint32_t flags)
{
	assert_int_equal(mode->clock, clock);
	assert_int_equal(mode->hdisplay, across[0]);
	assert_int_equal(mode->hsync_start, across[1]);
	assert_int_equal(mode->hsync_end, across[2]);
	assert_int_equal(mode->htotal, across[3]);
	assert_int_equal(mode->vdisplay, down[0]);
	assert_int_equal(mode->vsync_start, down[1]);
	assert_int_equal(mode->vsync_end, down[2]);
	assert_int_equal(mode->vtotal, down[3]);
	assert_int_equal(mode->flags, flags);
}

/* The first three are printed in VESA's DMT and CTA-861; the others come from VESA's generator for
 * reduced blanking (the last two are also DMT's 44h and 57h). */
TEST("timings are the standards")
{
	static const struct {
		double rate_hz;
		uint32_t clock;
		int across[4], down[4];
		uint32_t flags;
	} cases[] = {
		{60, 65000, {1024, 1048, 1184, 1344}, {768, 771, 777, 806}, N_N},
		{60, 148500, {1920, 2008, 2052, 2200}, {1080, 1084, 1089, 1125}, P_P},
		{50, 74250, {1280, 1720, 1760, 1980}, {720, 725, 730, 750}, P_P},
		{60, 71000, {1280, 1328, 1360, 1440}, {800, 803, 809, 823}, P_N},
		{60, 101000, {1400, 1448, 1480, 1560}, {1050, 1053, 1057, 1080}, P_N},
		{60, 119000, {1680, 1728, 1760, 1840}, {1050, 1053, 1059, 1080}, P_N},
		{60, 154000, {1920, 1968, 2000, 2080}, {1200, 1203, 1209, 1235}, P_N},
	};
	drmModeModeInfo mode;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		kms_timing(cases[i].across[0], cases[i].down[0], cases[i].rate_hz, &mode);
		assert_timing(&mode, cases[i].clock, cases[i].across, cases[i].down,
			      cases[i].flags);
		assert_true(fabs(kms_mode_rate(&mode) - cases[i].rate_hz) < 0.3);
	}
}

/* Whatever is asked for, blanking surrounds the picture and the rate is the one that was meant. */
TEST("timings are whole")
{
	drmModeModeInfo mode;

	for (int width = 320; width <= 4096; width += 8)
		for (double rate_hz = 24; rate_hz <= 120; rate_hz += 24) {
			const int height = width * 5 / 8;

			kms_timing(width, height, rate_hz, &mode);
			assert_true(mode.hdisplay == width && mode.vdisplay == height);
			assert_true(mode.hsync_start > width && mode.hsync_end > mode.hsync_start &&
				    mode.htotal > mode.hsync_end);
			assert_true(mode.vsync_start > height &&
				    mode.vsync_end > mode.vsync_start &&
				    mode.vtotal > mode.vsync_end);
			/* the clock has steps of 250 kHz */
			assert_true(kms_mode_rate(&mode) <= rate_hz + 1e-9);
			assert_true(kms_mode_rate(&mode) >
				    rate_hz - 250e3 / (mode.htotal * mode.vtotal) - 1e-9);
		}
}

TEST("modes are read")
{
	static const char *const sizes[] = {"1280x800", "1280x800@60"};
	static const char *const lines[] = {
		"71 1280 1328 1360 1440 800 803 809 823 +hsync -vsync",
		"Modeline \"1280x800R\" 71.00  1280 1328 1360 1440  800 803 809 823 +hsync -vsync",
		"\"x\" 71.0 1280 1328 1360 1440 800 803 809 823 -VSYNC +HSync  ",
	};
	static const char *const wrong[] = {
		"",
		"auto",
		"1280",
		"1280x",
		"1280x800@",
		"1280x800@0",
		"1280x800@nan",
		"1280x800@60x",
		"0x0",
		"-1280x800",
		"99999x99999",
		"1280 x 800",
		"71 1280 1328 1360 1440 800 803 809",
		"71 1280 1328 1360 1300 800 803 809 823",
		"71 1280 1200 1360 1440 800 803 809 823",
		"0 1280 1328 1360 1440 800 803 809 823",
		"nan 1280 1328 1360 1440 800 803 809 823",
		"71 1280 1328 1360 1440 800 803 809 823 interlace",
		"Modeline \"open 71 1280 1328 1360 1440 800 803 809 823",
	};
	static const int across[] = {1280, 1328, 1360, 1440}, down[] = {800, 803, 809, 823};
	drmModeModeInfo mode;
	bool exact;

	for (int i = 0; i < 2; i++) {
		assert_int_equal(kms_timing_parse(sizes[i], &mode, &exact), 0);
		assert_false(exact);
		assert_timing(&mode, 71000, across, down, P_N);
	}
	for (int i = 0; i < 3; i++) {
		assert_int_equal(kms_timing_parse(lines[i], &mode, &exact), 0);
		assert_true(exact);
		assert_timing(&mode, 71000, across, down, P_N);
	}
	for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
		assert_int_equal(kms_timing_parse(wrong[i], &mode, &exact), -EINVAL);
}

TEST("connectors are ranked")
{
	const struct kms_options plain = {.buffers = 2}, forced = {.force = true},
				 told = {.mode = "640x480"};

	assert_int_equal(kms_mode_rank(DRM_MODE_CONNECTED, 5, &plain), KMS_RANK_BEST);
	assert_int_equal(kms_mode_rank(DRM_MODE_CONNECTED, 0, &plain), KMS_RANK_BEST);
	/* an analogue connector often does not know whether it has a screen */
	assert_int_equal(kms_mode_rank(DRM_MODE_UNKNOWNCONNECTION, 5, &plain), 2);
	assert_int_equal(kms_mode_rank(DRM_MODE_UNKNOWNCONNECTION, 0, &plain), 0);
	assert_int_equal(kms_mode_rank(DRM_MODE_UNKNOWNCONNECTION, 0, &told), 2);
	assert_int_equal(kms_mode_rank(DRM_MODE_UNKNOWNCONNECTION, 0, &forced), 1);
	assert_int_equal(kms_mode_rank(DRM_MODE_DISCONNECTED, 0, &plain), 0);
	assert_int_equal(kms_mode_rank(DRM_MODE_DISCONNECTED, 0, &told), 0);
	assert_int_equal(kms_mode_rank(DRM_MODE_DISCONNECTED, 0, &forced), 1);
}

/* A screen of two modes, of which the preferred one differs a little from the standard. */
static const drmModeModeInfo own[] = {
	{.clock = 148352,
	 .hdisplay = 1920,
	 .vdisplay = 1080,
	 .htotal = 2200,
	 .vtotal = 1125,
	 .type = DRM_MODE_TYPE_PREFERRED},
	{.clock = 25175, .hdisplay = 640, .vdisplay = 480, .htotal = 800, .vtotal = 525},
};

TEST("modes are picked")
{
	static const struct {
		const char *mode;
		bool force;
		int wanted_width, wanted_height;
		unsigned connection;
		int count, err, width;
		bool computed;
	} cases[] = {
		{"", false, 0, 0, DRM_MODE_CONNECTED, 2, 0, 1920, false},
		{"", false, 640, 480, DRM_MODE_CONNECTED, 2, 0, 640, false},
		{"", false, 800, 600, DRM_MODE_CONNECTED, 2, -EINVAL, 0, false},
		{"", false, 0, 0, DRM_MODE_DISCONNECTED, 2, -ENOLINK, 0, false},
		{"", false, 0, 0, DRM_MODE_CONNECTED, 0, -EINVAL, 0, false},
		/* the screen's own timing for that size and rate, if it has one, else the
		 * standard */
		{"1920x1080@60", false, 0, 0, DRM_MODE_CONNECTED, 2, 0, 1920, false},
		{"1920x1080@50", false, 0, 0, DRM_MODE_CONNECTED, 2, 0, 1920, true},
		{"800x600", false, 0, 0, DRM_MODE_CONNECTED, 2, 0, 800, true},
		{"800x600", false, 0, 0, DRM_MODE_CONNECTED, 0, 0, 800, true},
		{"800x600", false, 0, 0, DRM_MODE_UNKNOWNCONNECTION, 0, 0, 800, true},
		{"800x600", false, 0, 0, DRM_MODE_DISCONNECTED, 0, -ENOLINK, 0, false},
		{"800by600", false, 0, 0, DRM_MODE_CONNECTED, 2, -EINVAL, 0, false},
		{"", true, 0, 0, DRM_MODE_DISCONNECTED, 0, 0, 1024, true},
		{"", true, 1280, 720, DRM_MODE_DISCONNECTED, 0, 0, 1280, true},
		{"640x480", true, 0, 0, DRM_MODE_DISCONNECTED, 0, 0, 640, true},
		{"", true, 0, 0, DRM_MODE_CONNECTED, 2, 0, 1920, false},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const struct display_settings settings = {.width = cases[i].wanted_width,
							  .height = cases[i].wanted_height};
		struct kms_options options = {.force = cases[i].force};
		drmModeModeInfo mode = {0};
		bool computed;

		strcpy(options.mode, cases[i].mode);
		assert_int_equal(kms_mode_pick(&settings, &options, cases[i].connection, own,
					       cases[i].count, &mode, &computed),
				 cases[i].err);
		if (cases[i].err)
			continue;
		assert_int_equal(mode.hdisplay, cases[i].width);
		assert_int_equal(computed, cases[i].computed);
	}
}

TEST("same modes")
{
	drmModeModeInfo other = own[0];

	strcpy(other.name, "another name");
	other.type = 0;
	assert_true(kms_mode_same(&own[0], &other));
	other.clock++;
	assert_false(kms_mode_same(&own[0], &other));
	assert_false(kms_mode_same(&own[0], &own[1]));
}

TEST("pictures are fitted")
{
	static const struct {
		int width, height;
		double squash;
		int screen_width, screen_height;
		struct kms_box box;
	} cases[] = {
		{640, 480, 1, 1920, 1080, {240, 0, 1440, 1080}},
		{640, 360, 1, 1920, 1080, {0, 0, 1920, 1080}},
		{640, 480, 1, 768, 1024, {0, 224, 768, 576}},
		{1024, 768, 1, 1024, 768, {0, 0, 1024, 768}},
		/* the digitizer's 720 x 486 is a picture of 4:3 */
		{720, 486, 540.0 / 486, 1024, 768, {0, 0, 1024, 768}},
		{720, 576, 0.75, 1920, 1080, {60, 0, 1800, 1080}},
		{3, 2, 1, 64, 64, {0, 10, 64, 43}},
		{4000, 1, 1, 640, 480, {0, 239, 640, 1}},
		{1, 4000, 1, 640, 480, {319, 0, 1, 480}},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const struct kms_box box = kms_fit_box(cases[i].width, cases[i].height,
						       cases[i].squash, cases[i].screen_width,
						       cases[i].screen_height);

		assert_memory_equal(&box, &cases[i].box, sizeof(box));
	}
}

/* On any screen a picture touches two opposite edges, leaves equal borders and keeps its shape. */
TEST("fits keep the shape")
{
	for (int i = 0; i < 20000; i++) {
		const int width = 16 + i * 7 % 1900, height = 16 + i * 13 % 1200;
		const int across = 320 + i * 17 % 3600, down = 240 + i * 29 % 2000;
		const double squash = 0.5 + i % 100 * 0.015;
		const struct kms_box box = kms_fit_box(width, height, squash, across, down);
		const double factor = fmin(across / (double)width, down / (height * squash));

		assert_true(box.width == across || box.height == down);
		assert_true(box.x >= 0 && box.y >= 0);
		assert_in_range(across - box.width - 2 * box.x, 0, 1);
		assert_in_range(down - box.height - 2 * box.y, 0, 1);
		assert_true(fabs(box.width - fmax(width * factor, 1)) <= 0.5 + 1e-9);
		assert_true(fabs(box.height - fmax(height * squash * factor, 1)) <= 0.5 + 1e-9);
	}
}

#define MESSAGE(text) text, sizeof(text) - 1

TEST("messages about screens")
{
	assert_true(kms_watch_concerns(
		MESSAGE("change@/devices/x/drm/card0\0ACTION=change\0SUBSYSTEM=drm\0HOTPLUG=1\0")));
	assert_true(kms_watch_concerns(MESSAGE("SUBSYSTEM=drm")));
	assert_false(kms_watch_concerns(MESSAGE("SUBSYSTEM=drm_dp_aux_dev\0")));
	assert_false(kms_watch_concerns(MESSAGE("add@/x\0SUBSYSTEM=usb\0DEVNAME=SUBSYSTEM=drm\0")));
	assert_false(kms_watch_concerns(MESSAGE("SUBSYSTEM=dr")));
	assert_false(kms_watch_concerns(MESSAGE("\0\0\0")));
	assert_false(kms_watch_concerns(MESSAGE("")));
}
