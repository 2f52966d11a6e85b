/* SPDX-License-Identifier: MIT */
/* Live pictures for calibration: through a kiosk's configuration, from the simulated camera. */
#include <errno.h>
#include <string.h>

#include <stdio.h>
#include <unistd.h>

#include "bake/calibrate/observe/live.h"
#include "hal/base/clock.h"
#include "tests/support/expect.h"
#include "tests/support/own_folder.h"
#include "tests/support/test.h"

static void write_config(const char *text)
{
	FILE *file = fopen(own_folder_path("kiosk.conf"), "w");

	assert_non_null(file);
	assert_true(fputs(text, file) >= 0);
	assert_int_equal(fclose(file), 0);
}

/* 8x6, each pixel with its own colour. */
static void write_picture(void)
{
	struct fault fault = {{0}};
	struct image picture;

	assert_int_equal(image_create_u8(&picture, 8, 6), 0);
	for (int i = 0; i < 8 * 6; i++) {
		picture.u8[3 * i] = (uint8_t)(10 * (i % 8));
		picture.u8[3 * i + 1] = (uint8_t)(20 * (i / 8));
		picture.u8[3 * i + 2] = 200;
	}
	assert_int_equal(image_write(own_folder_path("p.png"), &picture, &fault), 0);
	image_free(&picture);
}

static void clean(void)
{
	unlink(own_folder_path("kiosk.conf"));
	unlink(own_folder_path("p.png"));
}

static struct live *opened(enum live_view view)
{
	struct fault fault = {{0}};
	struct live *live;

	if (live_open(&live, own_folder_path("kiosk.conf"), view, &fault))
		fail_msg("%s", fault.text);
	return live;
}

static int next(struct live *live, struct image *picture, int64_t *captured_ns)
{
	struct fault fault = {{0}};
	const int err = live_next(live, 2000, picture, captured_ns, &fault);

	if (err)
		print_message("# %s\n", fault.text);
	return err;
}

/* A rectangle of the picture, turned upright. */
TEST("upright")
{
	struct image picture = {0};
	int64_t ns[2];
	struct live *live;

	write_picture();
	write_config("[camera one]\ndriver=sim\nsim.source=files\nsim.file=p.png\n"
		     "sim.clock=frames\nrate=10\n"
		     "[background]\ncamera=one\nx=2\ny=1\nwidth=4\nheight=3\nhflip=yes\n"
		     "[fisheye]\ncamera=one\nhflip=yes\nvflip=yes\n");
	live = opened(LIVE_BACKGROUND);
	assert_int_equal(live_width(live), 4);
	assert_int_equal(live_height(live), 3);
	assert_int_equal(next(live, &picture, &ns[0]), 0);
	for (int y = 0; y < 3; y++)
		for (int x = 0; x < 4; x++) {
			expect_equal(picture.u8[3 * (4 * y + x)], 10 * (2 + 3 - x), "y=%d, x=%d", y,
				     x);
			expect_equal(picture.u8[3 * (4 * y + x) + 1], 20 * (1 + y), "y=%d, x=%d", y,
				     x);
			expect_equal(picture.u8[3 * (4 * y + x) + 2], 200, "y=%d, x=%d", y, x);
		}
	assert_int_equal(live_flush(live, NULL), 0);
	assert_int_equal(next(live, &picture, &ns[1]), 0);
	assert_int_equal(ns[1] - ns[0], NS_PER_S / 10);
	live_close(live);
	image_free(&picture);
	live = opened(LIVE_FISHEYE);
	assert_int_equal(live_width(live), 8);
	assert_int_equal(next(live, &picture, &ns[0]), 0);
	assert_int_equal(picture.u8[0], 70);
	assert_int_equal(picture.u8[1], 100);
	live_close(live);
	image_free(&picture);
	clean();
}

static void write_text(const char *name, const char *text)
{
	FILE *file = fopen(own_folder_path(name), "w");

	assert_non_null(file);
	assert_true(fputs(text, file) >= 0);
	assert_int_equal(fclose(file), 0);
}

/* The lens and the black level are those of the files that the configuration names. */
TEST("lens")
{
	struct fisheye_settings lens;
	struct transfer_curve curve;
	struct fault fault = {{0}};
	struct live *live;
	char config[1024];

	write_picture();
	write_text("eye.ini", "[fisheye]\nfield = 80\n");
	write_text("light.ini", "[light]\nblack_level = 12\n");
	snprintf(config, sizeof(config),
		 "[camera one]\ndriver=sim\nsim.source=files\nsim.file=p.png\n"
		 "sim.clock=frames\nrate=10\n"
		 "[fisheye]\ncamera=one\nfield=70\nlens=%s/eye.ini\nlight=%s/light.ini\n",
		 own_folder(), own_folder());
	write_config(config);
	live = opened(LIVE_FISHEYE);
	expect_success(live_lens(live, &lens, &curve, &fault), &fault);
	assert_true(lens.field_deg == 80);
	assert_true(curve.black == 12);
	live_close(live);
	unlink(own_folder_path("light.ini"));
	live = opened(LIVE_FISHEYE);
	assert_int_equal(live_lens(live, &lens, &curve, &fault), -ENOENT);
	assert_non_null(strstr(fault.text, "light.ini"));
	live_close(live);
	unlink(own_folder_path("eye.ini"));
	clean();
}

/* Linear light is shown with the curve of the view. */
TEST("light")
{
	struct image light, picture = {0};
	struct fault fault = {{0}};
	struct live *live;
	int64_t ns;

	assert_int_equal(image_create_f32(&light, 2, 1), 0);
	for (int i = 0; i < 3; i++) {
		light.f32[i] = 0.5F;
		light.f32[3 + i] = 7;
	}
	assert_int_equal(image_write(own_folder_path("l.pfm"), &light, &fault), 0);
	image_free(&light);
	write_config("[camera one]\ndriver=sim\nformat=RGBF\nsim.source=files\nsim.file=l.pfm\n"
		     "sim.clock=frames\n[background]\ncamera=one\ntransfer=linear\n");
	live = opened(LIVE_BACKGROUND);
	assert_int_equal(next(live, &picture, &ns), 0);
	assert_in_range(picture.u8[0], 127, 128);
	assert_int_equal(picture.u8[3], 255);
	live_close(live);
	image_free(&picture);
	unlink(own_folder_path("l.pfm"));
	clean();
}

/* With a clock, a picture taken before a flush does not arrive after it. */
TEST("flush")
{
	const struct timespec wait = {0, 100 * NS_PER_MS};
	struct image picture = {0};
	struct live *live;
	int64_t ns, now_ns;

	write_config("[camera one]\ndriver=sim\nwidth=64\nheight=48\nrate=50\n"
		     "[background]\ncamera=one\n");
	live = opened(LIVE_BACKGROUND);
	assert_int_equal(next(live, &picture, &ns), 0);
	for (int i = 0; i < 5; i++) {
		nanosleep(&wait, NULL);
		now_ns = clock_now_ns();
		assert_int_equal(live_flush(live, NULL), 0);
		assert_int_equal(next(live, &picture, &ns), 0);
		expect_above(ns, now_ns, "i=%d", i);
	}
	live_close(live);
	image_free(&picture);
	clean();
}

TEST("trouble")
{
	static const struct {
		const char *text;
		int err;
		const char *says;
	} cases[] = {
		{"[camera one]\ndriver=sim\n", -EINVAL, "there is no [camera background]"},
		{"[background]\ncamera=two\n[camera one]\ndriver=sim\n", -EINVAL,
		 "there is no [camera two]"},
		{"[background]\ncamera=one\n[camera one]\ndriver=magic\n", -EINVAL,
		 "there is no driver \"magic\""},
		{"[background]\ncamera=one\n[camera one]\nrate=fast\n", -EINVAL, "kiosk.conf:4"},
		{"[background]\ncamera=one\nx=64\n[camera one]\ndriver=sim\nwidth=64\nheight=48\n",
		 -EINVAL, "lies outside the camera's picture"},
		{"[background]\ncamera=one\n[camera one]\ndriver=sim\nsim.source=files\n"
		 "sim.file=none.png\n",
		 -ENOENT, "camera one: no device"},
	};
	struct image picture = {0};
	struct fault fault = {{0}};
	struct live *live;
	int64_t ns;

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		write_config(cases[i].text);
		expect_equal(
			live_open(&live, own_folder_path("kiosk.conf"), LIVE_BACKGROUND, &fault),
			cases[i].err, "i=%zu", i);
		assert_null(live);
		if (!strstr(fault.text, cases[i].says))
			fail_msg("\"%s\" does not say \"%s\"", fault.text, cases[i].says);
	}
	clean();
	assert_int_equal(live_open(&live, own_folder_path("none.conf"), LIVE_BACKGROUND, &fault),
			 -ENOENT);
	live_close(NULL);
	/* a camera that falls silent, and one that goes away */
	write_config("[camera one]\ndriver=sim\nwidth=64\nheight=48\nsim.stall_after=1\n"
		     "[background]\ncamera=one\n");
	live = opened(LIVE_BACKGROUND);
	assert_int_equal(live_next(live, 2000, &picture, &ns, &fault), 0);
	assert_int_equal(live_next(live, 100, &picture, &ns, &fault), -ETIMEDOUT);
	assert_non_null(strstr(fault.text, "within 100 ms"));
	live_close(live);
	write_config("[camera one]\ndriver=sim\nwidth=64\nheight=48\nsim.vanish_after=1\n"
		     "[background]\ncamera=one\n");
	live = opened(LIVE_BACKGROUND);
	assert_int_equal(live_next(live, 2000, &picture, &ns, &fault), 0);
	assert_int_equal(live_next(live, 2000, &picture, &ns, &fault), -ENODEV);
	assert_non_null(strstr(fault.text, "camera one: no device"));
	live_close(live);
	image_free(&picture);
	clean();
}

TEST_GROUP(own_folder_make, own_folder_remove);
