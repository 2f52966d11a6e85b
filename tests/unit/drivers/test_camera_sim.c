/* SPDX-License-Identifier: MIT */
/* The simulated camera through the camera contract: clocks, faults, sensor, panorama, files. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/sim/sim.h"
#include "hal/base/clock.h"
#include "hal/frame/frame_decode.h"
#include "hal/image/image.h"
#include "hal/optics/fisheye.h"
#include "hal/optics/panorama.h"
#include "hal/optics/tsai.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

static char folder[] = "/tmp/inlay-sim.XXXXXX";

static const char *in_folder(const char *name)
{
	static char path[4][256];
	static int turn;

	turn = (turn + 1) % 4;
	snprintf(path[turn], sizeof(path[turn]), "%s/%s", folder, name);
	return path[turn];
}

static void *place(void *root, const char *instance)
{
	(void)instance;
	return root;
}

struct sim_rig {
	struct camera camera;
	struct camera_settings settings;
	void *options;
	struct fault fault;
};

/* Options as "key=value", NULL at the end. */
static void test_sim_prepare(struct sim_rig *rig, ...)
{
	const struct ini_table tables[] = {
		{.section = "sim", .keys = camera_sim.keys, .place = place}, INI_TABLES_END};
	const char *option;
	va_list arguments;

	memset(rig, 0, sizeof(*rig));
	rig->settings = (struct camera_settings){.width = 64, .height = 48, .buffers = 4};
	rig->options = calloc(1, camera_sim.options_size);
	ini_defaults(camera_sim.keys, rig->options);
	va_start(arguments, rig);
	while ((option = va_arg(arguments, const char *))) {
		struct ini_report report = {0};
		char text[600];

		snprintf(text, sizeof(text), "sim.%s", option);
		if (ini_set(text, tables, rig->options, &report))
			fail_msg("%s", report.first.text);
	}
	va_end(arguments);
}

static int test_sim_start(struct sim_rig *rig)
{
	return camera_open(&rig->camera, &camera_sim, &rig->settings, rig->options, &rig->fault);
}

static void must_start(struct sim_rig *rig)
{
	if (test_sim_start(rig))
		fail_msg("%s", rig->fault.text);
}

static void finish(struct sim_rig *rig)
{
	camera_close(&rig->camera);
	camera_close(&rig->camera);
	free(rig->options);
}

static void test_sim_grab(struct sim_rig *rig, struct frame *frame)
{
	struct pollfd p = {.fd = camera_descriptor(&rig->camera), .events = POLLIN};

	assert_int_equal(poll(&p, 1, 60000), 1);
	if (camera_grab(&rig->camera, frame, &rig->fault))
		fail_msg("%s", rig->fault.text);
}

static uint64_t checksum(const struct frame *frame)
{
	uint64_t h = 1469598103934665603u;

	for (size_t i = 0; i < frame->planes[0].bytes; i++)
		h = (h ^ frame->planes[0].data[i]) * 1099511628211u;
	return h;
}

TEST("defaults are sound")
{
	struct frame frame;
	struct sim_rig rig;

	test_sim_prepare(&rig, NULL);
	rig.settings.width = rig.settings.height = 0;
	must_start(&rig);
	assert_int_equal(rig.camera.width, 640);
	assert_int_equal(rig.camera.height, 480);
	assert_int_equal(rig.camera.format, PIXEL_BGRX);
	assert_true(rig.camera.rate_hz == 25);
	test_sim_grab(&rig, &frame);
	assert_int_equal(frame.width, 640);
	assert_int_equal(frame.planes[0].bytes, 640 * 480 * 4);
	assert_int_equal(rig.camera.frames, 1);
	camera_release(&rig.camera, &frame);
	camera_release(&rig.camera, &frame);
	finish(&rig);
}

TEST("same frames every time")
{
	uint64_t sums[2][4], others = 0;
	int64_t last_ns = 0;

	for (int run = 0; run < 2; run++) {
		struct frame frame;
		struct sim_rig rig;

		test_sim_prepare(&rig, "clock=frames", "read_noise=4", "shot_noise=4", NULL);
		rig.settings.rate_hz = 50;
		must_start(&rig);
		for (int i = 0; i < 4; i++) {
			test_sim_grab(&rig, &frame);
			sums[run][i] = checksum(&frame);
			assert_int_equal(frame.sequence, i);
			if (i > 0)
				assert_int_equal(frame.timestamp_ns - last_ns, NS_PER_S / 50);
			last_ns = frame.timestamp_ns;
			camera_release(&rig.camera, &frame);
		}
		finish(&rig);
	}
	for (int i = 0; i < 4; i++) {
		assert_true(sums[0][i] == sums[1][i]);
		others += sums[0][i] != sums[0][(i + 1) % 4];
	}
	assert_int_equal(others, 4);
}

TEST("the real clock keeps time")
{
	const struct timespec nap = {0, 130 * 1000 * 1000};
	struct frame frame;
	struct sim_rig rig;
	uint32_t first;
	int64_t first_ns;

	test_sim_prepare(&rig, NULL);
	rig.settings.rate_hz = 50;
	must_start(&rig);
	test_sim_grab(&rig, &frame);
	first = frame.sequence;
	first_ns = frame.timestamp_ns;
	camera_release(&rig.camera, &frame);
	nanosleep(&nap, NULL);
	test_sim_grab(&rig, &frame);
	/* at least 6 periods have passed: the newest frame counts, the others are lost */
	assert_true(frame.sequence - first >= 6);
	assert_int_equal(rig.camera.lost, frame.sequence - 1);
	assert_int_equal(frame.timestamp_ns - first_ns, (frame.sequence - first) * (NS_PER_S / 50));
	assert_true(clock_now_ns() >= frame.timestamp_ns);
	camera_release(&rig.camera, &frame);
	assert_int_equal(rig.camera.frames, 2);
	finish(&rig);
}

TEST("a camera stalls and vanishes")
{
	static const char *const clocks[] = {"clock=real", "clock=frames"};

	for (int i = 0; i < 2; i++) {
		struct frame frame;
		struct pollfd p = {.events = POLLIN};
		struct sim_rig rig;

		test_sim_prepare(&rig, clocks[i], "stall_after=2", NULL);
		rig.settings.rate_hz = 200;
		must_start(&rig);
		for (int k = 0; k < 2; k++) {
			test_sim_grab(&rig, &frame);
			camera_release(&rig.camera, &frame);
		}
		assert_int_equal(camera_grab(&rig.camera, &frame, NULL), -EAGAIN);
		p.fd = camera_descriptor(&rig.camera);
		assert_int_equal(poll(&p, 1, 50), 0);
		finish(&rig);

		test_sim_prepare(&rig, clocks[i], "vanish_after=2", NULL);
		rig.settings.rate_hz = 200;
		for (int again = 0; again < 2; again++) {
			must_start(&rig);
			for (int k = 0; k < 2; k++) {
				test_sim_grab(&rig, &frame);
				camera_release(&rig.camera, &frame);
			}
			assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -ENODEV);
			assert_int_equal(rig.camera.situation, CAMERA_NO_DEVICE);
			camera_close(&rig.camera);
		}
		finish(&rig);
	}
}

TEST("corrupt frames are skipped")
{
	struct frame frame;
	struct sim_rig rig;

	test_sim_prepare(&rig, "clock=frames", "corrupt_every=3", NULL);
	must_start(&rig);
	for (uint32_t i = 0; i < 6; i++) {
		test_sim_grab(&rig, &frame);
		assert_int_equal(frame.sequence, i + i / 2);
		camera_release(&rig.camera, &frame);
	}
	assert_int_equal(rig.camera.broken, 2);
	assert_int_equal(rig.camera.frames, 6);
	finish(&rig);
}

/* A grey panorama of one radiance: only the sensor decides what comes out. */
static const char *flat_panorama(float radiance)
{
	const char *path = in_folder("flat.pfm");
	struct image image;

	assert_int_equal(image_create_f32(&image, 64, 32), 0);
	for (int i = 0; i < 64 * 32 * 3; i++)
		image.f32[i] = radiance;
	assert_int_equal(image_write(path, &image, NULL), 0);
	image_free(&image);
	return path;
}

static void option(char text[300], const char *key, const char *value)
{
	snprintf(text, 300, "%s=%s", key, value);
}

static uint8_t middle_code(const struct frame *frame)
{
	return frame->planes[0].data[(size_t)24 * frame->planes[0].stride + 32 * 4];
}

TEST("the sensor encodes")
{
	static const struct {
		const char *transfer, *exposure, *black;
		int code;
	} cases[] = {
		{"transfer=linear", "exposure=1", "black_level=0", 64},	 /* 0.25 * 255 */
		{"transfer=linear", "exposure=2", "black_level=0", 128}, /* 0.5 */
		{"transfer=linear", "exposure=8", "black_level=0", 255}, /* clipped */
		{"transfer=linear", "exposure=0", "black_level=16", 16},
		{"transfer=linear", "exposure=2", "black_level=16", 136}, /* 16 + 239 / 2 */
		{"transfer=srgb", "exposure=1", "black_level=0", 137},	  /* 0.5371 * 255 */
		{"transfer=bt709", "exposure=1", "black_level=0", 125},	  /* 0.4900 * 255 */
	};
	char file[300];

	option(file, "file", flat_panorama(0.25f));
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct frame frame;
		struct sim_rig rig;

		test_sim_prepare(&rig, "clock=frames", "source=panorama", file, cases[i].transfer,
				 cases[i].exposure, cases[i].black, NULL);
		must_start(&rig);
		test_sim_grab(&rig, &frame);
		assert_int_equal(middle_code(&frame), cases[i].code);
		finish(&rig);
	}
}

/* Each key changes the studio's picture; automatic exposure brings a flat one to its level at
 * once. */
TEST("the look has keys")
{
	static const char *const keys[] = {"edge_spread=1", "auto_exposure=0.3", "auto_white=yes",
					   "flicker=0.5"};
	char file[300];
	struct frame frame;
	struct sim_rig rig;
	uint64_t plain;

	option(file, "file", flat_panorama(0.25f));
	test_sim_prepare(&rig, "clock=frames", "source=panorama", "transfer=linear", file,
			 "view=perspective", "exposure=3", "auto_exposure=0.6", "edge_spread=2",
			 NULL);
	must_start(&rig);
	for (int n = 0; n < 3; n++) {
		test_sim_grab(&rig, &frame);
		assert_int_equal(middle_code(&frame), 153);
		camera_release(&rig.camera, &frame);
	}
	finish(&rig);
	test_sim_prepare(&rig, "clock=frames", "exposure=0.16", NULL);
	must_start(&rig);
	test_sim_grab(&rig, &frame);
	plain = checksum(&frame);
	finish(&rig);
	for (size_t i = 0; i < sizeof(keys) / sizeof(keys[0]); i++) {
		test_sim_prepare(&rig, "clock=frames", "exposure=0.16", keys[i], NULL);
		must_start(&rig);
		test_sim_grab(&rig, &frame);
		assert_true(checksum(&frame) != plain);
		finish(&rig);
	}
}

/* Linear light of 0.25: code 64 at an exposure of 1, 128 at 2, 0 at 0. */
TEST("the exposure changes after its delay")
{
	static const int delays[] = {0, 1, 5, 30};
	char file[300], delay[64];

	option(file, "file", flat_panorama(0.25f));
	for (size_t i = 0; i < sizeof(delays) / sizeof(delays[0]); i++) {
		struct frame frame;
		struct sim_rig rig;

		snprintf(delay, sizeof(delay), "control_delay=%d", delays[i]);
		test_sim_prepare(&rig, "clock=frames", "source=panorama", "transfer=linear", file,
				 delay, NULL);
		must_start(&rig);
		/* 2 is asked for before frame 3, twice; 0 before frame 4 */
		for (int n = 0; n < 40; n++) {
			const int code = n < 3 + delays[i] ? 64 : n == 3 + delays[i] ? 128 : 0;

			if (n == 3) {
				assert_int_equal(camera_set_control(&rig.camera, "exposure", "7",
								    NULL, &rig.fault),
						 0);
				assert_int_equal(camera_set_control(&rig.camera, "exposure", "2",
								    NULL, &rig.fault),
						 0);
			}
			if (n == 4)
				assert_int_equal(camera_set_control(&rig.camera, "exposure", "0",
								    NULL, &rig.fault),
						 0);
			test_sim_grab(&rig, &frame);
			assert_int_equal(frame.sequence, n);
			assert_int_equal(middle_code(&frame), code);
			camera_release(&rig.camera, &frame);
		}
		finish(&rig);
	}
}

/* Many more changes of exposure than frames. */
TEST("the last of many exposures counts")
{
	struct frame frame;
	struct sim_rig rig;
	char file[300];

	option(file, "file", flat_panorama(0.25f));
	test_sim_prepare(&rig, "clock=frames", "source=panorama", "transfer=linear", file,
			 "control_delay=30", NULL);
	must_start(&rig);
	for (int n = 0; n < 100; n++) {
		for (int i = 0; i < 50; i++)
			assert_int_equal(camera_set_control(&rig.camera, "exposure",
							    i % 2 ? "2" : "1", NULL, &rig.fault),
					 0);
		test_sim_grab(&rig, &frame);
		assert_int_equal(middle_code(&frame), n < 30 ? 64 : 128);
		camera_release(&rig.camera, &frame);
	}
	finish(&rig);
}

TEST("wrong controls are named")
{
	static const struct {
		const char *name, *value;
		int err;
		const char *says;
	} cases[] = {
		{"gain", "1", -EINVAL, "expected exposure"},
		{"exposure", "bright", -EINVAL, "expected a number"},
		{"exposure", "", -EINVAL, "expected a number"},
		{"exposure", "nan", -EINVAL, "expected a number"},
		{"exposure", "1 2", -EINVAL, "expected a number"},
		{"exposure", "-1", -ERANGE, "expected 0 to 1e+06"},
		{"exposure", "inf", -EINVAL, "expected a number"},
		{"exposure", "0x10", -EINVAL, "expected a number"},
		{"exposure", "1e7", -ERANGE, "expected 0 to 1e+06"},
	};
	struct frame frame;
	struct sim_rig rig;

	test_sim_prepare(&rig, "clock=frames", NULL);
	assert_int_equal(camera_set_control(&rig.camera, "exposure", "1", NULL, &rig.fault),
			 -EBADF);
	must_start(&rig);
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		assert_int_equal(camera_set_control(&rig.camera, cases[i].name, cases[i].value,
						    NULL, &rig.fault),
				 cases[i].err);
		assert_non_null(strstr(rig.fault.text, cases[i].says));
	}
	test_sim_grab(&rig, &frame);
	camera_release(&rig.camera, &frame);
	finish(&rig);
}

TEST("a driver without controls says so")
{
	struct camera_ops without = camera_sim;
	struct sim_rig rig;

	without.control = NULL;
	test_sim_prepare(&rig, "clock=frames", NULL);
	must_start(&rig);
	rig.camera.ops = &without;
	assert_int_equal(camera_set_control(&rig.camera, "exposure", "1", NULL, &rig.fault),
			 -ENOTSUP);
	assert_non_null(strstr(rig.fault.text, "sim: "));
	rig.camera.ops = &camera_sim;
	finish(&rig);
}

TEST("noise is as strong as said")
{
	double sum = 0, squares = 0;
	struct frame frame;
	struct sim_rig rig;
	char file[300];
	const int count = 200 * 200 * 3;

	option(file, "file", flat_panorama(0.25f));
	test_sim_prepare(&rig, "clock=frames", "source=panorama", "view=perspective",
			 "transfer=linear", "read_noise=6", "shot_noise=16", file, NULL);
	rig.settings.width = rig.settings.height = 200;
	must_start(&rig);
	test_sim_grab(&rig, &frame);
	for (int i = 0; i < 200 * 200; i++)
		for (int c = 0; c < 3; c++) {
			const double v = frame.planes[0].data[4 * i + c];

			sum += v;
			squares += v * v;
		}
	sum /= count;
	squares = sqrt(squares / count - sum * sum);
	/* sqrt(6^2 + 16^2 * 0.25) = 10 levels. */
	assert_true(fabs(sum - 63.75) < 0.15);
	assert_true(fabs(squares - 10) < 0.15);
	finish(&rig);
}

/* A panorama with a different colour in every direction. */
static const char *coloured_panorama(struct image *image)
{
	const char *path = in_folder("colours.pfm");

	assert_int_equal(image_create_f32(image, 256, 128), 0);
	for (int y = 0; y < 128; y++)
		for (int x = 0; x < 256; x++) {
			float *p = image->f32 + 3 * (y * 256 + x);

			p[0] = 1 + sinf((float)(2 * M_PI * x / 256));
			p[1] = 1 + cosf((float)(2 * M_PI * x / 256));
			p[2] = (float)y / 64;
		}
	assert_int_equal(image_write(path, image, NULL), 0);
	return path;
}

TEST("panoramas show what is there")
{
	struct panorama panorama = {.scale = 1};
	struct fisheye_settings settings = {.field_deg = 90};
	double worst = 0;
	struct fisheye lens;
	struct image image;
	struct frame frame;
	struct sim_rig rig;
	char file[300];

	option(file, "file", coloured_panorama(&image));
	panorama.image = &image;
	assert_int_equal(fisheye_prepare(&lens, &settings, 128, 128, NULL), 0);
	test_sim_prepare(&rig, "clock=frames", "source=panorama", "turn_rate=90", file, NULL);
	rig.settings.width = rig.settings.height = 128;
	rig.settings.rate_hz = 1;
	rig.settings.format = PIXEL_RGBF;
	must_start(&rig);
	for (int turn = 0; turn < 5; turn++) {
		const float *rgb;

		test_sim_grab(&rig, &frame);
		assert_int_equal(frame.format, PIXEL_RGBF);
		panorama.turn_rad = turn * M_PI / 2;
		rgb = (const float *)(const void *)frame.planes[0].data;
		for (int y = 0; y < 128; y++)
			for (int x = 0; x < 128; x++) {
				const double px[2] = {x + 0.5, y + 0.5};
				double dir[3], want[3];

				/* at the zenith all azimuths meet in one pixel */
				if (hypot(px[0] - 64, px[1] - 64) < 6 ||
				    hypot(px[0] - 64, px[1] - 64) > 62 ||
				    !fisheye_ray(&lens, px, dir))
					continue;
				panorama_radiance(&panorama, dir, want);
				for (int c = 0; c < 3; c++)
					worst = fmax(worst,
						     fabs(rgb[3 * (y * 128 + x) + c] - want[c]));
			}
		camera_release(&rig.camera, &frame);
	}
	print_message("# panorama through the camera: largest error %.4f of 2\n", worst);
	assert_true(worst < 0.01);
	image_free(&image);
	finish(&rig);
}

TEST("yuyv holds the same picture")
{
	for (int matrix = 0; matrix < MATRIX_COUNT; matrix++)
		for (int range = 0; range < RANGE_COUNT; range++) {
			struct frame_decoder *decoder;
			struct canvas canvas, plain;
			struct frame frame;
			struct sim_rig rig;
			double sum = 0;

			assert_int_equal(
				frame_decoder_create(&decoder, DEINTERLACE_WEAVE, PICTURE_UPRIGHT),
				0);
			assert_int_equal(canvas_create(&canvas, 64, 48), 0);
			assert_int_equal(canvas_create(&plain, 64, 48), 0);
			for (int format = 0; format < 2; format++) {
				test_sim_prepare(&rig, "clock=frames", "view=perspective", NULL);
				rig.settings.format = format ? PIXEL_YUYV : PIXEL_BGRX;
				rig.settings.matrix = matrix + 1;
				rig.settings.range = range + 1;
				must_start(&rig);
				test_sim_grab(&rig, &frame);
				assert_int_equal(frame.matrix, matrix);
				assert_int_equal(frame.range, format ? range : RANGE_FULL);
				assert_int_equal(frame_decode(decoder, &frame,
							      format ? &canvas : &plain, NULL),
						 0);
				finish(&rig);
			}
			for (int y = 0; y < 48; y++)
				for (int x = 0; x < 64 * 4; x++)
					sum += abs(canvas.pixels[(size_t)y * canvas.stride + x] -
						   plain.pixels[(size_t)y * plain.stride + x]);
			/* only edges of colour within a pair differ */
			assert_true(sum / (64 * 48 * 3) < 2);
			canvas_free(&canvas);
			canvas_free(&plain);
			frame_decoder_destroy(decoder);
		}
}

static void write_picture(const char *name, int width, int height, int value)
{
	struct image image;

	assert_int_equal(image_create_u8(&image, width, height), 0);
	for (int i = 0; i < width * height; i++) {
		image.u8[3 * i] = (uint8_t)value;
		image.u8[3 * i + 1] = (uint8_t)(value + 1);
		image.u8[3 * i + 2] = (uint8_t)(value + 2);
	}
	assert_int_equal(image_write(in_folder(name), &image, NULL), 0);
	image_free(&image);
}

TEST("pictures play in order")
{
	static const int looped[] = {10, 20, 30, 10, 20};
	struct frame frame;
	struct sim_rig rig;
	char file[300];

	write_picture("p001.png", 20, 10, 10);
	write_picture("p002.png", 20, 10, 20);
	write_picture("p003.png", 20, 10, 30);
	option(file, "file", in_folder("p%03d.png"));
	test_sim_prepare(&rig, "clock=frames", "source=files", file, NULL);
	must_start(&rig);
	assert_int_equal(rig.camera.width, 20);
	for (int i = 0; i < 5; i++) {
		test_sim_grab(&rig, &frame);
		assert_int_equal(frame.planes[0].data[2], looped[i]);
		assert_int_equal(frame.planes[0].data[0], looped[i] + 2);
		camera_release(&rig.camera, &frame);
	}
	finish(&rig);

	test_sim_prepare(&rig, "clock=frames", "source=files", "loop=no", file, NULL);
	must_start(&rig);
	for (int i = 0; i < 3; i++) {
		test_sim_grab(&rig, &frame);
		camera_release(&rig.camera, &frame);
	}
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -ENODEV);
	assert_int_equal(rig.camera.situation, CAMERA_NO_SIGNAL);
	finish(&rig);

	/* a picture of another size ends the camera with a reason */
	write_picture("p004.png", 22, 10, 30);
	test_sim_prepare(&rig, "clock=frames", "source=files", file, NULL);
	must_start(&rig);
	for (int i = 0; i < 3; i++) {
		test_sim_grab(&rig, &frame);
		camera_release(&rig.camera, &frame);
	}
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -EINVAL);
	assert_non_null(strstr(rig.fault.text, "p004.png"));
	finish(&rig);
}

TEST("a picture stays")
{
	struct frame frame;
	struct sim_rig rig;
	char file[300];

	write_picture("one.png", 8, 8, 99);
	option(file, "file", in_folder("one.png"));
	test_sim_prepare(&rig, "clock=frames", "source=files", file, NULL);
	must_start(&rig);
	for (int i = 0; i < 3; i++) {
		test_sim_grab(&rig, &frame);
		assert_int_equal(frame.planes[0].data[2], 99);
		camera_release(&rig.camera, &frame);
	}
	finish(&rig);
}

/* Video of n pictures, luma 50, 51 ...; chroma neutral. */
static void write_video(FILE *f, const char *chroma, size_t chroma_bytes, int pictures)
{
	uint8_t *planes = malloc(16 * 8 + chroma_bytes);

	assert_non_null(f);
	assert_non_null(planes);
	fprintf(f, "YUV4MPEG2 W16 H8 F30000:1001 Ip A1:1 C%s\n", chroma);
	for (int i = 0; i < pictures; i++) {
		memset(planes, 50 + i, 16 * 8);
		memset(planes + 16 * 8, 128, chroma_bytes);
		fprintf(f, "FRAME\n");
		fwrite(planes, 1, 16 * 8 + chroma_bytes, f);
	}
	free(planes);
}

static int luma_code(int y)
{
	return (int)lrint((y - 16) * 255.0 / 219);
}

TEST("video plays")
{
	static const struct {
		const char *name;
		size_t chroma_bytes;
	} kinds[] = {{"420jpeg", 64}, {"422", 128}, {"444", 256}, {"mono", 0}};

	for (size_t k = 0; k < 4; k++) {
		FILE *f = fopen(in_folder("clip.y4m"), "w");
		struct frame frame;
		struct sim_rig rig;
		char file[300];

		write_video(f, kinds[k].name, kinds[k].chroma_bytes, 3);
		fclose(f);
		option(file, "file", in_folder("clip.y4m"));
		test_sim_prepare(&rig, "clock=frames", "source=files", file, NULL);
		must_start(&rig);
		assert_int_equal(rig.camera.width, 16);
		assert_int_equal(rig.camera.height, 8);
		assert_true(fabs(rig.camera.rate_hz - 29.97) < 0.01);
		for (int i = 0; i < 7; i++) {
			test_sim_grab(&rig, &frame);
			for (int c = 0; c < 3; c++)
				assert_int_equal(frame.planes[0].data[c], luma_code(50 + i % 3));
			camera_release(&rig.camera, &frame);
		}
		finish(&rig);
	}
}

TEST("a pipe plays as it comes")
{
	struct frame frame;
	struct sim_rig rig;
	char file[300];
	int hold;
	FILE *f;

	assert_int_equal(mkfifo(in_folder("pipe"), 0600), 0);
	option(file, "file", in_folder("pipe"));
	/* both ends are open, so that neither side waits for the other */
	hold = open(in_folder("pipe"), O_RDWR);
	assert_true(hold >= 0);
	f = fdopen(hold, "w");
	write_video(f, "420", 64, 2);
	fprintf(f, "FRAME\nnot yet");
	fflush(f);
	test_sim_prepare(&rig, "source=files", file, NULL);
	must_start(&rig);
	for (int i = 0; i < 2; i++) {
		test_sim_grab(&rig, &frame);
		assert_int_equal(frame.planes[0].data[0], luma_code(50 + i));
		camera_release(&rig.camera, &frame);
	}
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -EAGAIN);
	fclose(f); /* the writer goes in the middle of a picture */
	assert_int_equal(camera_grab(&rig.camera, &frame, &rig.fault), -EBADMSG);
	assert_non_null(strstr(rig.fault.text, "cut short"));
	finish(&rig);
}

static void write_text(const char *name, const char *text)
{
	FILE *f = fopen(in_folder(name), "w");

	assert_non_null(f);
	fputs(text, f);
	fclose(f);
}

TEST("bad files are named")
{
	static const struct {
		const char *source, *name, *text;
		int err;
	} cases[] = {
		{"source=files", "missing.png", NULL, -ENOENT},
		{"source=files", "missing.y4m", NULL, -ENOENT},
		{"source=files", "missing%03d.png", NULL, -ENOENT},
		{"source=files", "garbage.y4m", "RIFF and so on\n", -EBADMSG},
		{"source=files", "empty.y4m", "", -EBADMSG},
		{"source=files", "tall.y4m", "YUV4MPEG2 W16 H99999999\n", -EBADMSG},
		{"source=files", "deep.y4m", "YUV4MPEG2 W16 H16 C420p10\n", -ENOTSUP},
		{"source=files", "empty.png", "", -ENOTSUP},
		{"source=panorama", "missing.hdr", NULL, -ENOENT},
	};

	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct sim_rig rig;
		char file[300];
		int err;

		if (cases[i].text)
			write_text(cases[i].name, cases[i].text);
		option(file, "file", in_folder(cases[i].name));
		test_sim_prepare(&rig, cases[i].source, file, NULL);
		err = test_sim_start(&rig);
		assert_true(err < 0);
		if (strcmp(cases[i].name, "empty.png") != 0)
			assert_int_equal(err, cases[i].err);
		assert_true(rig.camera.situation != CAMERA_FINE);
		assert_non_null(strstr(rig.fault.text, cases[i].name));
		assert_null(rig.camera.state);
		finish(&rig);
	}
}

TEST("a square panorama is refused")
{
	struct image image;
	struct sim_rig rig;
	char file[300];

	assert_int_equal(image_create_f32(&image, 8, 8), 0);
	assert_int_equal(image_write(in_folder("square.pfm"), &image, NULL), 0);
	image_free(&image);
	option(file, "file", in_folder("square.pfm"));
	test_sim_prepare(&rig, "source=panorama", file, NULL);
	assert_int_equal(test_sim_start(&rig), -EINVAL);
	assert_non_null(strstr(rig.fault.text, "square.pfm"));
	finish(&rig);
}

static const char camera_text[] = "[camera]\nwidth = 64\nheight = 48\n"
				  "rotation = 1 0 0 0 0 -1 0 1 0\ntranslation = 0 1 2\n"
				  "focal = 4\nkappa1 = 0\ncentre = 32 24\npixel = 0.1 0.1\n"
				  "aspect = 1\n";

TEST("a camera file sets the view")
{
	const uint8_t *middle;
	struct frame frame;
	struct sim_rig rig;
	char file[300];

	write_text("camera.ini", camera_text);
	option(file, "camera", in_folder("camera.ini"));
	test_sim_prepare(&rig, "clock=frames", "view=perspective", file, NULL);
	rig.settings.width = rig.settings.height = 0;
	must_start(&rig);
	assert_int_equal(rig.camera.width, 64);
	assert_int_equal(rig.camera.height, 48);
	test_sim_grab(&rig, &frame);
	middle = frame.planes[0].data + (size_t)24 * frame.planes[0].stride + 32 * 4;
	/* from (0, -2, 1), level, towards +Y: the sage wall in the middle, green most of all */
	assert_true(middle[0] < middle[1] && middle[2] < middle[1]);
	camera_release(&rig.camera, &frame);
	camera_close(&rig.camera);
	rig.settings.width = 320;
	assert_int_equal(test_sim_start(&rig), -EINVAL);
	assert_non_null(strstr(rig.fault.text, "camera.ini"));
	finish(&rig);

	write_text("camera.ini", "[lens]\n");
	test_sim_prepare(&rig, "view=perspective", file, NULL);
	assert_int_equal(test_sim_start(&rig), -EINVAL);
	assert_non_null(strstr(rig.fault.text, "camera.ini"));
	finish(&rig);
}

TEST("other formats are refused")
{
	struct sim_rig rig;

	test_sim_prepare(&rig, NULL);
	rig.settings.format = PIXEL_MJPEG;
	assert_int_equal(test_sim_start(&rig), -EINVAL);
	assert_int_equal(rig.camera.situation, CAMERA_UNSUPPORTED_FORMAT);
	finish(&rig);
	test_sim_prepare(&rig, NULL);
	rig.settings.format = PIXEL_YUYV;
	rig.settings.width = 63;
	assert_int_equal(test_sim_start(&rig), -EINVAL);
	finish(&rig);
	test_sim_prepare(&rig, "view=fisheye", NULL);
	rig.settings.format = PIXEL_Z16;
	assert_int_equal(test_sim_start(&rig), -EINVAL);
	assert_non_null(strstr(rig.fault.text, "expected sim.source = studio"));
	finish(&rig);
}

/* How far a pixel's depth is from that of the empty room's wall, in m; NAN: it is not known. */
static double depth_off(const struct tsai_camera *camera, const struct frame *frame, int x, int y,
			double *depth)
{
	const uint8_t *word = frame->planes[0].data + (size_t)y * frame->planes[0].stride +
			      (size_t)(2 * x);
	const double px[2] = {x + 0.5, y + 0.5}, *axis = &camera->rotation[6];
	double origin[3], dir[3];
	struct studio_hit hit;

	assert_int_equal(tsai_ray(camera, px, origin, dir), 0);
	assert_true(studio_hit(origin, dir, &hit));
	*depth = hit.distance * (axis[0] * dir[0] + axis[1] * dir[1] + axis[2] * dir[2]);
	return word[0] | word[1] ? (word[0] | word[1] << 8) / 1000.0 - *depth : NAN;
}

TEST("depths are where walls are")
{
	const double eye[3] = {0, -1.7, 0.95}, target[3] = {0, 0, 0.12};
	const double noise_mm[2] = {0, 4};
	struct tsai_camera camera;

	assert_int_equal(tsai_look_at(&camera, 64, 48, eye, target, 46, NULL), 0);
	for (int n = 0; n < 2; n++) {
		struct frame frame;
		struct sim_rig rig;
		double worst = 0, sum = 0;
		int known = 0;

		test_sim_prepare(&rig, "view=perspective", "clock=frames",
				 n ? "depth_noise=4" : "depth_noise=0", NULL);
		rig.settings.format = PIXEL_Z16;
		must_start(&rig);
		test_sim_grab(&rig, &frame);
		assert_int_equal(frame.format, PIXEL_Z16);
		for (int y = 0; y < 48; y++)
			for (int x = 0; x < 64; x++) {
				double depth;
				const double off = depth_off(&camera, &frame, x, y, &depth);

				if (isnan(off))
					continue;
				known++;
				worst = fmax(worst, fabs(off));
				sum += pow(off / (depth * depth), 2);
			}
		expect_above(known, 0.9 * 64 * 48, "noise %g", noise_mm[n]);
		if (n)
			expect_at_most(fabs(1000 * sqrt(sum / known) - noise_mm[n]),
				       0.05 * noise_mm[n], "standard deviation at 1 m");
		else
			expect_at_most(worst, 0.00051, "rounding");
		camera_release(&rig.camera, &frame);
		finish(&rig);
	}
}

/* Walkers are nearer than the room; at their outlines nothing is known. */
TEST("depths have holes at edges")
{
	const double eye[3] = {0, -1.7, 0.95}, target[3] = {0, 0, 0.12};
	struct tsai_camera camera;
	struct sim_rig rig;
	int nearer = 0, jumps = 0, holes = 0;

	assert_int_equal(tsai_look_at(&camera, 64, 48, eye, target, 46, NULL), 0);
	test_sim_prepare(&rig, "view=perspective", "clock=frames", "walkers=4", NULL);
	rig.settings.format = PIXEL_Z16;
	rig.settings.rate_hz = 2;
	must_start(&rig);
	for (int n = 0; n < 60; n++) {
		struct frame frame;

		test_sim_grab(&rig, &frame);
		for (int y = 0; y < 48; y++) {
			double before = NAN;

			for (int x = 0; x < 64; x++) {
				double depth;
				const double off = depth_off(&camera, &frame, x, y, &depth);

				nearer += off < -0.2;
				holes += isnan(off);
				jumps += fabs(off - before) > 0.3; /* false for those not known */
				before = off;
			}
		}
		camera_release(&rig.camera, &frame);
	}
	finish(&rig);
	expect_above(nearer, 2000, "pixels of walkers");
	expect_above(holes, 300, "pixels at edges");
	expect_equal(jumps, 0, "edges without a hole");
}

TEST("a closed camera is harmless")
{
	struct camera camera = {0};
	struct frame frame;

	camera_close(&camera);
	assert_int_equal(camera_descriptor(&camera), -EBADF);
	assert_int_equal(camera_grab(&camera, &frame, NULL), -EBADF);
	camera_release(&camera, &frame);
}

static int make_folder(void **state)
{
	(void)state;
	return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
	static const char *const names[] = {
		"flat.pfm", "colours.pfm", "p001.png",	 "p002.png",	"p003.png",  "p004.png",
		"one.png",  "clip.y4m",	   "pipe",	 "garbage.y4m", "empty.y4m", "tall.y4m",
		"deep.y4m", "empty.png",   "square.pfm", "camera.ini",
	};

	(void)state;
	for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
		unlink(in_folder(names[i]));
	return rmdir(folder);
}

TEST_GROUP(make_folder, remove_folder);
