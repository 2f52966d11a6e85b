/* SPDX-License-Identifier: MIT */
/* The pipeline on a basis made by hand: six lights; one object pixel sees only the zenith's light
 * and one only another light; the rest is background. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/basis/basis_writer.h"
#include "hal/frame/frame.h"
#include "tests/support/basis/hand_block.h"
#include "tests/support/expect.h"
#include "tests/support/plain_pipeline.h"
#include "tests/support/test.h"

enum { WIDTH = 20, HEIGHT = 18, LIGHTS = 6, SKY = 64 };

#define SHARE 0.5 /* t of the object's pixels: half of the radiance of its light */

static char folder[] = "/tmp/test_app_pipeline_XXXXXX";
static char path[80];
static struct basis basis;

/* Object pixels (3, 2) and (4, 2) of the first tile, wholly covered. */
static void write_basis(const char *to, bool off)
{
	struct basis_info_chunk info = {.width = WIDTH,
					.height = HEIGHT,
					.lights = LIGHTS,
					.dome_frequency = 1,
					.poses = 1,
					.coarse = LIGHTS};
	static struct basis_light lights[LIGHTS];
	static uint16_t coverage[WIDTH * HEIGHT];
	static float peak[LIGHTS + 1][3], value[2][3][LIGHTS];
	const uint16_t pixel[2] = {2 * BASIS_TILE + 3, 2 * BASIS_TILE + 4};
	struct basis_block_payload block;

	hand_block_lights(1, LIGHTS, lights);
	if (off)
		lights[1].solid_angle_sr *= 1.01;
	for (int c = 0; c < 3; c++) {
		value[0][c][0] = SHARE;
		value[1][c][3] = SHARE;
		peak[0][c] = peak[3][c] = peak[LIGHTS][c] = SHARE;
	}
	coverage[2 * WIDTH + 3] = coverage[2 * WIDTH + 4] = 65535;
	block = hand_block_of_object(0, 2, pixel, LIGHTS, lights, &value[0][0][0]);
	hand_block_file(to, &info, lights, &block, coverage, (const float(*)[3])peak);
}

static int open_basis(void **state)
{
	struct fault fault = {.text = ""};

	(void)state;
	if (!mkdtemp(folder))
		return -1;
	snprintf(path, sizeof(path), "%s/hand.inlay", folder);
	write_basis(path, false);
	expect_success(basis_open(&basis, path, BASIS_SHOWN, &fault), &fault);
	return 0;
}

static int close_basis(void **state)
{
	(void)state;
	basis_close(&basis);
	unlink(path);
	return rmdir(folder);
}

static struct pipeline *made(const struct pipeline_settings *settings)
{
	struct pipeline *pipeline;
	struct fault fault = {.text = ""};

	expect_success(pipeline_create(&pipeline, &basis, settings, &fault), &fault);
	return pipeline;
}

static void test_pipeline_choose(struct pipeline *pipeline, double threshold)
{
	struct pipeline_choice choice = {.threshold = {.value = threshold}, .object = true};

	assert_int_equal(pipeline_choose(pipeline, &choice, NULL), 0);
}

static struct canvas flat(int width, int height, int code)
{
	struct canvas canvas;

	assert_int_equal(canvas_create(&canvas, width, height), 0);
	memset(canvas.pixels, code, canvas.stride * (size_t)height);
	return canvas;
}

static struct picture whole(const struct canvas *canvas)
{
	struct view view = {.width = canvas->width, .height = canvas->height, .squash = 1};

	return view_picture(&view, canvas->pixels, canvas->stride);
}

/* Composites over a flat background of code 90. */
static void composite(struct pipeline *pipeline, uint8_t out[HEIGHT][WIDTH][4])
{
	struct canvas background = flat(WIDTH, HEIGHT, 90);
	struct picture picture = whole(&background);
	struct backdrop backdrop = backdrop_of(&picture);

	assert_int_equal(pipeline_composite(pipeline, &backdrop, &out[0][0][0], WIDTH * 4, NULL),
			 0);
	canvas_free(&background);
}

static void is_light(const uint8_t bgr[4], double red, double green, double blue)
{
	const double rgb[3] = {red, green, blue};

	for (int c = 0; c < 3; c++)
		expect_at_most(fabs(bgr[2 - c] - 255 * transfer_encode(TRANSFER_SRGB, rgb[c])), 1,
			       "c=%d", c);
}

/* An even sky of code 150: each light has its radiance, and the object half of it. */
TEST("an even sky")
{
	struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *pipeline = made(&settings);
	struct canvas sky = flat(SKY, SKY, 150);
	struct picture picture = whole(&sky);
	double radiance = transfer_decode(TRANSFER_SRGB, 150 / 255.0);
	static uint8_t out[HEIGHT][WIDTH][4];

	assert_false(pipeline->light.lit);
	assert_int_equal(pipeline_light_picture(pipeline, &picture, NULL), 0);
	assert_true(pipeline->light.lit);
	for (int i = 0; i < LIGHTS; i++)
		expect_below(fabs(pipeline->light.radiance[i][1] - radiance), 1e-3, "i=%d", i);
	test_pipeline_choose(pipeline, 0);
	composite(pipeline, out);
	is_light(out[2][3], SHARE * radiance, SHARE * radiance, SHARE * radiance);
	is_light(out[2][4], SHARE * radiance, SHARE * radiance, SHARE * radiance);
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		if (i != 2 * WIDTH + 3 && i != 2 * WIDTH + 4)
			expect_equal(out[i / WIDTH][i % WIDTH][0], 90, "i=%d", i);
	}
	canvas_free(&sky);
	pipeline_destroy(pipeline);
	pipeline_destroy(NULL);
}

TEST("given lights reach their pixels")
{
	struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *pipeline = made(&settings);
	const float radiance[LIGHTS][3] = {[0] = {0.2f, 0.4f, 0.6f}, [5] = {9, 9, 9}};
	static uint8_t out[HEIGHT][WIDTH][4];
	static double exact[HEIGHT][WIDTH][3];
	struct canvas background = flat(WIDTH, HEIGHT, 90);
	struct picture picture = whole(&background);

	pipeline_light_given(pipeline, radiance);
	test_pipeline_choose(pipeline, 0);
	composite(pipeline, out);
	is_light(out[2][3], 0.1, 0.2, 0.3);
	is_light(out[2][4], 0, 0, 0);
	assert_int_equal(pipeline_reference(pipeline, &picture, &exact[0][0][0], NULL), 0);
	for (int c = 0; c < 3; c++)
		expect_below(
			fabs(exact[2][3][c] - 255 * transfer_encode(TRANSFER_SRGB, 0.1 * (c + 1))),
			0.1, "c=%d", c);
	canvas_free(&background);
	pipeline_destroy(pipeline);
}

/* A share of the light becomes grey of its luminance; all of it: the object is grey. */
TEST("neutral light keeps luminance")
{
	static const double shares[] = {0, 0.2, 1};
	const float radiance[LIGHTS][3] = {[0] = {0.2f, 0.4f, 0.6f}};
	const double grey = 0.2126 * 0.1 + 0.7152 * 0.2 + 0.0722 * 0.3;

	for (int k = 0; k < 3; k++) {
		struct pipeline_settings settings = plain_pipeline(1);
		static uint8_t out[HEIGHT][WIDTH][4];
		const double s = shares[k];
		struct pipeline *pipeline;

		settings.neutral = s;
		pipeline = made(&settings);
		pipeline_light_given(pipeline, radiance);
		test_pipeline_choose(pipeline, 0);
		composite(pipeline, out);
		composite(pipeline, out); /* of the same choice: it is not mixed twice */
		is_light(out[2][3], 0.1 + s * (grey - 0.1), 0.2 + s * (grey - 0.2),
			 0.3 + s * (grey - 0.3));
		pipeline_destroy(pipeline);
	}
}

/* A light that reaches the threshold is used. The threshold is a level of the camera's picture,
 * whatever its black level and gain. */
TEST("threshold is a level of the picture")
{
	static const struct {
		int black;
		double gain;
	} cases[] = {{0, 1}, {19, 1}, {0, 10}, {19, 0.25}};

	for (size_t i = 0; i < sizeof(cases) / sizeof(*cases); i++) {
		struct pipeline_settings settings = plain_pipeline(1);
		struct canvas sky = flat(SKY, SKY, 100);
		struct picture picture = whole(&sky);
		struct pipeline *pipeline;

		settings.sampler.curve.black = cases[i].black;
		settings.sampler.gain = cases[i].gain;
		pipeline = made(&settings);
		assert_int_equal(pipeline_light_picture(pipeline, &picture, NULL), 0);
		test_pipeline_choose(pipeline, 99);
		expect_equal(pipeline->selection.used_count, LIGHTS, "i=%zu", i);
		test_pipeline_choose(pipeline, 101);
		expect_equal(pipeline->selection.used_count, 0, "i=%zu", i);
		test_pipeline_choose(pipeline, 0);
		expect_equal(pipeline->selection.used_count, LIGHTS, "i=%zu", i);
		canvas_free(&sky);
		pipeline_destroy(pipeline);
	}
}

/* A view inside a camera's picture of linear light, turned by 180 degrees. Upright, its left half
 * is lit; the light around the view must not be read. */
TEST("linear light is read through its view")
{
	const struct pipeline_settings settings = plain_pipeline(1);
	struct view view = {.x = 10,
			    .y = 6,
			    .width = SKY,
			    .height = SKY,
			    .hflip = true,
			    .vflip = true,
			    .squash = 1};
	struct pipeline *pipeline = made(&settings);
	struct image camera;

	assert_int_equal(image_create_f32(&camera, SKY + 15, SKY + 9), 0);
	for (int y = 0; y < camera.height; y++) {
		for (int x = 0; x < camera.width; x++) {
			float *p = camera.f32 + 3 * (y * camera.width + x);
			int upright = SKY - 1 - (x - view.x);
			bool inside = x >= view.x && x < view.x + SKY && y >= view.y &&
				      y < view.y + SKY;

			p[0] = inside ? (upright < SKY / 2 ? 2 : 0) : 1000;
			p[1] = p[2] = p[0];
		}
	}
	assert_int_equal(pipeline_light_linear(pipeline, &camera, &view, NULL), 0);
	for (int i = 1; i < LIGHTS; i++) { /* light 0, the zenith, is on the border */
		double x = pipeline->dome.direction[i][0];

		/* a cell may extend a little into the other half */
		expect_above(fabs(x), 0.2, "i=%d", i);
		expect_below(fabs(pipeline->light.radiance[i][0] - (x < 0 ? 2 : 0)), 0.5, "i=%d",
			     i);
	}
	image_free(&camera);
	pipeline_destroy(pipeline);
}

TEST("without the object it is the background")
{
	struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *pipeline = made(&settings);
	struct pipeline_choice choice = {.object = false};
	static uint8_t out[HEIGHT][WIDTH][4];

	assert_int_equal(pipeline_choose(pipeline, &choice, NULL), 0);
	composite(pipeline, out);
	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		for (int c = 0; c < 3; c++)
			expect_equal(out[i / WIDTH][i % WIDTH][c], 90, "i=%d, c=%d", i, c);
	}
	pipeline_destroy(pipeline);
}

TEST("what does not fit is said")
{
	struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *pipeline = made(&settings);
	struct pipeline_choice choice = {.pose = 1};
	struct canvas narrow = flat(WIDTH - 1, HEIGHT, 0);
	struct picture picture = whole(&narrow);
	struct backdrop backdrop = backdrop_of(&picture);
	struct fault fault = {.text = ""};
	struct basis other;
	char off[96];
	static uint8_t out[HEIGHT][WIDTH][4];
	static double exact[HEIGHT][WIDTH][3];

	assert_int_equal(pipeline_choose(pipeline, &choice, &fault), -EINVAL);
	assert_string_equal(fault.text, "pose 1 is not in the basis, expected 0..0");
	choice.pose = -1;
	assert_int_equal(pipeline_choose(pipeline, &choice, &fault), -EINVAL);
	assert_int_equal(pipeline_composite(pipeline, &backdrop, &out[0][0][0], WIDTH * 4, &fault),
			 -EINVAL);
	assert_string_equal(
		fault.text,
		"the background is 19x18 pixels, expected 20x18 as the basis was baked");
	assert_int_equal(pipeline_reference(pipeline, &picture, &exact[0][0][0], &fault), -EINVAL);
	canvas_free(&narrow);
	pipeline_destroy(pipeline);

	snprintf(off, sizeof(off), "%s/off.inlay", folder);
	write_basis(off, true);
	expect_success(basis_open(&other, off, BASIS_SHOWN, &fault), &fault);
	assert_int_equal(pipeline_create(&pipeline, &other, &settings, &fault), -EINVAL);
	assert_string_equal(
		fault.text,
		"light 1 of the basis has a solid angle of 1.05767 sr, expected 1.0472 by the lights around it");
	basis_close(&other);
	unlink(off);
}

/* A camera may come back with another size; the light stays right. */
TEST("another size of sky")
{
	struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *pipeline = made(&settings);

	for (int side = 40; side <= 60; side += 10) {
		struct canvas sky = flat(side, side, side + 100);
		struct picture picture = whole(&sky);
		double radiance = transfer_decode(TRANSFER_SRGB, (side + 100) / 255.0);

		assert_int_equal(pipeline_light_picture(pipeline, &picture, NULL), 0);
		expect_equal(pipeline->light.lens_width, side, "side=%d", side);
		for (int i = 0; i < LIGHTS; i++)
			expect_below(fabs(pipeline->light.radiance[i][2] - radiance), 1e-3,
				     "side=%d, i=%d", side, i);
		canvas_free(&sky);
	}
	pipeline_destroy(pipeline);
}

static double test_pipeline_measure(struct pipeline *pipeline, int side, int code, int64_t at_ms)
{
	struct canvas sky = flat(side, side, code);
	struct picture picture = whole(&sky);

	assert_int_equal(pipeline_light_picture(pipeline, &picture, NULL), 0);
	pipeline_follow(pipeline, at_ms * 1000000);
	canvas_free(&sky);
	return (double)pipeline->light.radiance[0][1];
}

/* Light is filtered over time; the first picture of a size or of other settings is taken as
 * measured. */
TEST("light is followed")
{
	struct pipeline_settings settings = plain_pipeline(1);
	const double bright = transfer_decode(TRANSFER_SRGB, 200 / 255.0);
	const double dark = transfer_decode(TRANSFER_SRGB, 50 / 255.0);
	struct pipeline *pipeline;
	double first;

	settings.follow_ns = 100000000;
	pipeline = made(&settings);
	first = test_pipeline_measure(pipeline, SKY, 200, 1000);
	assert_true(fabs(first - bright) < 1e-3);
	assert_true(test_pipeline_measure(pipeline, SKY, 200, 1033) == first);
	assert_true(test_pipeline_measure(pipeline, SKY, 50, 1066) - dark > 0.4 * (bright - dark));
	assert_true(fabs(test_pipeline_measure(pipeline, SKY, 50, 1133) - dark) <
		    0.11 * (bright - dark));
	assert_true(fabs(test_pipeline_measure(pipeline, SKY + 8, 200, 1166) - bright) < 1e-3);
	settings.follow_ns = 0;
	assert_int_equal(pipeline_change(pipeline, &settings, NULL), 0);
	assert_true(fabs(test_pipeline_measure(pipeline, SKY + 8, 50, 1200) - dark) < 1e-3);
	pipeline_destroy(pipeline);
}

/* ---- the background camera's exposure ---- */

/* A place of many greys in an even sky of that radiance, by a camera of that exposure; lamps
 * flicker by a share of all light. */
struct lit_place {
	double radiance, exposure, flicker;
};

/* 30 frames a second, 100 Hz, one cycle from the first row to the last. */
static double place_row(const struct lit_place *place, int frame, int y)
{
	return 1 + place->flicker * cos(2 * M_PI * (frame * 100 / 30.0 + (double)y / HEIGHT));
}

/* Makes a frame of it, as the kiosk does. Returns the green of the object's pixel, 0..255. */
static int place_film(struct pipeline *pipeline, const struct lit_place *place, int frame)
{
	struct canvas background = flat(WIDTH, HEIGHT, 0);
	struct picture picture = whole(&background);
	struct backdrop backdrop = backdrop_of(&picture);
	float radiance[LIGHTS][3];
	static uint8_t out[HEIGHT][WIDTH][4];

	for (int i = 0; i < WIDTH * HEIGHT; i++) {
		const double albedo = 0.2 + 0.4 * i / (WIDTH * HEIGHT);

		memset(background.pixels + (size_t)(i / WIDTH) * background.stride +
			       4 * (size_t)(i % WIDTH),
		       (int)lrint(255 *
				  transfer_encode(TRANSFER_SRGB,
						  albedo * place->radiance * place->exposure *
							  place_row(place, frame, i / WIDTH))),
		       4);
	}
	for (int i = 0; i < LIGHTS; i++)
		for (int c = 0; c < 3; c++)
			radiance[i][c] = (float)place->radiance;
	pipeline_light_given(pipeline, (const float(*)[3])radiance);
	test_pipeline_choose(pipeline, 0);
	assert_true(pipeline_looks(pipeline));
	pipeline_look(pipeline, &picture, NULL, frame * INT64_C(33000000));
	assert_int_equal(pipeline_composite(pipeline, &backdrop, &out[0][0][0], WIDTH * 4, NULL),
			 0);
	canvas_free(&background);
	return out[2][3][1];
}

/* Films that place for a second, then the other one, in which the object is right from the third
 * frame on. */
static void expect_follows(const struct lit_place *first, const struct lit_place *then)
{
	struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *pipeline;

	settings.follow_exposure = true;
	pipeline = made(&settings);
	for (int frame = 0; frame < 60; frame++) {
		const struct lit_place *place = frame < 30 ? first : then;
		const double light = SHARE * place->radiance * place->exposure / first->exposure;
		const int code = place_film(pipeline, place, frame);

		if (frame < 30 || frame >= 32)
			expect_at_most(fabs(code - 255 * transfer_encode(TRANSFER_SRGB, light)), 1,
				       "frame=%d, exposure=%g, code=%d", frame, then->exposure,
				       code);
	}
	pipeline_destroy(pipeline);
}

/* What the background's camera alone sees is exposure, and the object follows it. */
TEST("the object follows the exposure")
{
	const struct lit_place first = {.radiance = 0.5, .exposure = 0.8};

	for (int k = 0; k < 4; k++) {
		const struct lit_place then = {0.5, 0.8 * (0.7 + 0.15 * k), 0};

		expect_follows(&first, &then);
	}
}

/* Rows of lamps that flicker are the object's, too. */
TEST("the object flickers with its row")
{
	const struct lit_place place = {.radiance = 0.5, .exposure = 0.8, .flicker = 0.2};
	struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *pipeline;

	settings.follow_exposure = true;
	pipeline = made(&settings);
	for (int frame = 0; frame < 60; frame++) {
		const double light = SHARE * place.radiance * place_row(&place, frame, 2);
		const int code = place_film(pipeline, &place, frame);

		if (frame >= 30)
			expect_at_most(fabs(code - 255 * transfer_encode(TRANSFER_SRGB, light)), 2,
				       "frame=%d, code=%d", frame, code);
	}
	expect_above(pipeline_report(pipeline).look_ns[PIPELINE_FLICKER], 0, "it takes time");
	settings.follow_exposure = false;
	assert_int_equal(pipeline_change(pipeline, &settings, NULL), 0);
	assert_null(pipeline_rows(pipeline));
	pipeline_destroy(pipeline);
}

/* What both cameras see is light: the object changes by it, and not by it twice. */
TEST("light is not followed twice")
{
	const struct lit_place first = {.radiance = 0.5, .exposure = 0.8};
	static const double steps[] = {0.3, 0.8, 1.25, 1.6};

	for (int k = 0; k < 4; k++) {
		const struct lit_place then = {0.5 * steps[k], 0.8, 0};

		expect_follows(&first, &then);
	}
}

/* Threads, kernel and ground patch change together or not at all. */
TEST("a change that fails changes nothing")
{
	struct pipeline_settings settings = plain_pipeline(1);
	struct pipeline *pipeline = made(&settings);
	const struct compositor *const compositor = pipeline->compositor;
	const struct pool *const pool = pipeline->pool;
	struct fault fault = {.text = ""};

	settings.threads = 3;
	settings.gain = 2;
	settings.patch = (struct pipeline_patch){.x = 4000, .width = 8, .height = 8};
	assert_int_equal(pipeline_change(pipeline, &settings, &fault), -EINVAL);
	assert_non_null(strstr(fault.text, "ground_patch: reaches to 4008, 8"));
	assert_ptr_equal(pipeline->compositor, compositor);
	assert_ptr_equal(pipeline->pool, pool);
	assert_true(pipeline->settings.gain == plain_pipeline(1).gain);
	settings.patch.width = 0;
	assert_int_equal(pipeline_change(pipeline, &settings, &fault), 0);
	assert_int_equal(pool_threads(pipeline->pool), 3);
	assert_true(pipeline->settings.gain == 2);
	pipeline_destroy(pipeline);
}

/* Two pixels, each lit by half of one light: lights are left out as long as neither pixel changes
 * by more than the budget. */
TEST("a percentage of white may change")
{
	struct pipeline_settings settings = plain_pipeline(1);
	const float radiance[LIGHTS][3] = {[0] = {0.016f, 0.016f, 0.016f}, [3] = {1, 1, 1}};
	struct pipeline_choice choice = {.object = true, .threshold = {.percent = true}};
	struct pipeline *pipeline = made(&settings);

	pipeline_light_given(pipeline, radiance);
	assert_int_equal(pipeline_choose(pipeline, &choice, NULL), 0);
	assert_int_equal(pipeline->selection.used_count, LIGHTS); /* 0 %: all lights are used */
	choice.threshold.value = 0.7;
	assert_int_equal(pipeline_choose(pipeline, &choice, NULL), 0);
	/* Leaving out dark lights costs nothing. */
	assert_int_equal(pipeline->selection.used_count, 2);
	choice.threshold.value = 0.9;
	assert_int_equal(pipeline_choose(pipeline, &choice, NULL), 0);
	assert_int_equal(pipeline->selection.used_count, 1);
	assert_true(pipeline->selection.used[3]);
	assert_true(fabs(pipeline->selection.dropped_error[0] - 0.008) < 1e-6);
	test_pipeline_choose(pipeline, 0); /* a threshold in grey levels again */
	assert_int_equal(pipeline->selection.used_count, LIGHTS);
	pipeline_destroy(pipeline);
}

TEST_GROUP(open_basis, close_basis);
