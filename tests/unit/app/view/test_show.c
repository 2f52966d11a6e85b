/* SPDX-License-Identifier: MIT */
/* What each way of showing puts on the screen: a basis made by hand, pictures without cameras,
 * screens with guard pages. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/pipeline/pipeline.h"
#include "app/view/layout.h"
#include "app/view/show.h"
#include "hal/basis/basis_writer.h"
#include "tests/support/basis/hand_block.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/guarded_screen.h"
#include "tests/support/own_folder.h"
#include "tests/support/plain_pipeline.h"
#include "tests/support/test.h"

enum { WIDTH = 50, HEIGHT = 38, LIGHTS = 46, SKY = 61, SCENE_WIDTH = 33, SCENE_HEIGHT = 47 };

static struct basis basis;
static struct pipeline *pipeline;
static struct source sources[3]; /* fisheye, background, scene */
static struct eyes eyes;

/* ---- what there is to see ---- */

/* The first tile is object, which reflects a quarter of the zenith's light. */
static void write_basis(const char *path)
{
	enum { PIXELS = BASIS_TILE * BASIS_TILE };
	const struct basis_info_chunk info = {.width = WIDTH,
					      .height = HEIGHT,
					      .lights = LIGHTS,
					      .dome_frequency = 3,
					      .poses = 1,
					      .coarse = LIGHTS};
	static struct basis_light lights[LIGHTS];
	static uint16_t coverage[WIDTH * HEIGHT], pixel[PIXELS];
	static float peak[LIGHTS + 1][3], value[PIXELS][3][LIGHTS];
	struct basis_block_payload block;

	hand_block_lights(3, LIGHTS, lights);
	for (int p = 0; p < PIXELS; p++) {
		pixel[p] = (uint16_t)p;
		coverage[p / BASIS_TILE * WIDTH + p % BASIS_TILE] = 65535;
		for (int c = 0; c < 3; c++)
			value[p][c][0] = peak[0][c] = peak[LIGHTS][c] = 0.25f;
	}
	block = hand_block_of_object(0, PIXELS, pixel, LIGHTS, lights, &value[0][0][0]);
	hand_block_file(path, &info, lights, &block, coverage, (const float(*)[3])peak);
}

/* The cameras differ from each other and from the former contents of the screens. */
static void test_show_fill(struct canvas *canvas, int width, int height, int red)
{
	assert_int_equal(canvas_create(canvas, width, height), 0);
	for (int y = 0; y < height; y++) {
		for (int x = 0; x < width; x++) {
			uint8_t *p = canvas->pixels + (size_t)y * canvas->stride + 4 * (size_t)x;

			p[0] = (uint8_t)(40 + 3 * x);
			p[1] = (uint8_t)(40 + 3 * y);
			p[2] = (uint8_t)red;
		}
	}
}

static void test_show_look(struct eye *eye, struct source *source)
{
	struct fault fault = {.text = ""};

	*eye = (struct eye){.section = "test", .source = source, .wanted = {.squash = 1}};
	expect_success(eye_fit(eye, &fault), &fault);
}

static int set_up(void **state)
{
	const struct pipeline_settings settings = plain_pipeline(2);
	struct fault fault = {.text = ""};

	if (own_folder_make(state))
		return -1;
	write_basis(own_folder_path("show.inlay"));
	expect_success(basis_open(&basis, own_folder_path("show.inlay"), BASIS_SHOWN, &fault),
		       &fault);
	expect_success(pipeline_create(&pipeline, &basis, &settings, &fault), &fault);
	test_show_fill(&sources[0].canvas, SKY, SKY, 60);
	test_show_fill(&sources[1].canvas, WIDTH, HEIGHT, 100);
	test_show_fill(&sources[2].canvas, SCENE_WIDTH, SCENE_HEIGHT, 140);
	for (int i = 0; i < 3; i++)
		sources[i].whole = true;
	return 0;
}

static int tear_down(void **state)
{
	pipeline_destroy(pipeline);
	basis_close(&basis);
	for (int i = 0; i < 3; i++)
		canvas_free(&sources[i].canvas);
	unlink(own_folder_path("show.inlay"));
	return own_folder_remove(state);
}

/* All cameras work, light is measured, and half of the lights are used. */
static int test_show_begin(void **state)
{
	const struct pipeline_choice choice = {.threshold = {.value = 120}, .object = true};
	struct fault fault = {.text = ""};
	struct picture sky;

	(void)state;
	test_show_look(&eyes.fisheye, &sources[0]);
	test_show_look(&eyes.background, &sources[1]);
	test_show_look(&eyes.scene, &sources[2]);
	sky = eye_picture(&eyes.fisheye);
	expect_success(pipeline_light_picture(pipeline, &sky, &fault), &fault);
	expect_success(pipeline_choose(pipeline, &choice, &fault), &fault);
	assert_true(pipeline_report(pipeline).lights_used > 5);
	assert_true(pipeline_report(pipeline).lights_used < LIGHTS - 5);
	return 0;
}

static struct show_request plain(enum config_show view)
{
	return (struct show_request){.view = view, .scale = SCALE_FIT, .split = 0.5, .squash = 1};
}

static struct show_picture picture_of(const struct eye *eye)
{
	if (!eye_has_picture(eye))
		return (struct show_picture){.squash = 1};
	return (struct show_picture){eye_picture(eye), eye->view.squash};
}

static struct guarded_screen shown_by(struct show *show, const struct show_request *request,
				      int width, int height, int fill)
{
	struct guarded_screen screen = guarded_screen_create(width, height, fill);
	struct fault fault = {.text = ""};

	struct show_request whole = *request;
	struct show_pictures pictures = {
		.fisheye = picture_of(&eyes.fisheye),
		.background = picture_of(&eyes.background),
		.scene = picture_of(&eyes.scene),
		.marks = {pipeline_dome(pipeline), pipeline_lens(pipeline), pipeline_used(pipeline),
			  pipeline_radiance(pipeline)},
	};
	const struct backdrop backdrop = backdrop_of(&pictures.background.picture);

	pictures.composite = (struct show_composite){.width = pictures.background.picture.width,
						     .height = pictures.background.picture.height,
						     .squash = pictures.background.squash};
	whole.pool = pipeline_pool(pipeline);
	expect_success(show_room(show, &whole, &pictures.composite, &screen.buffer, &fault),
		       &fault);
	if (pictures.composite.pixels)
		expect_success(pipeline_composite(pipeline, &backdrop, pictures.composite.pixels,
						  pictures.composite.stride, &fault),
			       &fault);
	expect_success(show_draw(show, &whole, &pictures, &screen.buffer, &fault), &fault);
	return screen;
}

static struct guarded_screen shown(const struct show_request *request, int width, int height)
{
	struct show show = {.after = {.width = 0}};
	struct guarded_screen screen = shown_by(&show, request, width, height, 0);

	show_free(&show);
	show_free(&show);
	return screen;
}

static bool same_pixel(const struct guarded_screen *a, int ax, int ay,
		       const struct guarded_screen *b, int bx, int by)
{
	return !memcmp(guarded_screen_pixel(a, ax, ay), guarded_screen_pixel(b, bx, by), 3);
}

static bool is_code(const struct guarded_screen *s, int x, int y, int blue, int green, int red)
{
	const uint8_t *p = guarded_screen_pixel(s, x, y);

	return p[0] == blue && p[1] == green && p[2] == red;
}

/* ---- tests ---- */

/* Whatever the memory held before, the picture is the same, so each pixel is written; the guards
 * prove that no other byte is. Squashed, cut, fitted, on screens down to one pixel. */
TEST_BETWEEN("every pixel and no other", test_show_begin, NULL)
{
	struct chance chance = chance_begin("every_pixel_and_no_other");
	static const int sizes[][2] = {{1, 1},	 {2, 1},   {1, 7},  {31, 23}, {50, 38},	 {100, 76},
				       {51, 39}, {160, 9}, {9, 91}, {97, 61}, {161, 119}};
	static const double squashes[] = {1, 2, 0.5, 1.37};

	for (int run = 0; run < 40 * SHOW_COUNT; run++) {
		const int *size = sizes[run % (int)(sizeof(sizes) / sizeof(*sizes))];
		struct overlay overlay = {.trouble_count = 0};
		struct show_request request = plain((enum config_show)(run % SHOW_COUNT));
		struct show show = {.after = {.width = 0}};
		struct guarded_screen one, other;

		request.scale = chance_int(&chance, 0, 1) ? SCALE_FIT : SCALE_NONE;
		request.split = chance_real(&chance, 0, 1);
		request.squash = squashes[chance_int(&chance, 0, 3)];
		request.overlay = chance_int(&chance, 0, 1) ? &overlay : NULL;
		overlay_information(&overlay, "lights 1 of 2");
		eyes.background.view.squash = squashes[chance_int(&chance, 0, 3)];
		eyes.fisheye.view.squash = squashes[chance_int(&chance, 0, 3)];
		one = shown_by(&show, &request, size[0], size[1], 0x11);
		other = shown_by(&show, &request, size[0], size[1], 0xee);
		for (int y = 0; y < size[1]; y++) {
			for (int x = 0; x < size[0]; x++)
				expect_that(same_pixel(&one, x, y, &other, x, y),
					    "run=%d, y=%d, x=%d", run, y, x);
		}
		guarded_screen_free(&one);
		guarded_screen_free(&other);
		show_free(&show);
		overlay_free(&overlay);
	}
}

/* The picture is the pipeline's, pixel by pixel, to the last bit. */
TEST_BETWEEN("composite is the composite", test_show_begin, NULL)
{
	struct show_request request = plain(SHOW_COMPOSITE);
	struct guarded_screen exact = shown(&request, WIDTH, HEIGHT);
	struct guarded_screen framed;
	static uint8_t made[HEIGHT][WIDTH][4];
	struct picture background = eye_picture(&eyes.background);
	struct backdrop backdrop = backdrop_of(&background);
	int changed = 0;

	request.scale = SCALE_NONE;
	framed = shown(&request, WIDTH + 31, HEIGHT + 7);
	assert_int_equal(pipeline_composite(pipeline, &backdrop, &made[0][0][0], WIDTH * 4, NULL),
			 0);
	for (int y = 0; y < HEIGHT; y++) {
		for (int x = 0; x < WIDTH; x++) {
			expect_same_picture(guarded_screen_pixel(&exact, x, y), made[y][x], 4, 3,
					    "of the pixel at (%d, %d)", x, y);
			expect_same_picture(guarded_screen_pixel(&framed, x + 15, y + 3),
					    made[y][x], 4, 3, "of the pixel at (%d, %d), framed", x,
					    y);
			changed += made[y][x][2] != 100;
		}
	}
	assert_int_equal(changed, BASIS_TILE * BASIS_TILE); /* the object is there */
	for (int x = 0; x < WIDTH + 31; x++)
		expect_that(is_code(&framed, x, 0, 0, 0, 0), "x=%d", x);
	guarded_screen_free(&exact);
	guarded_screen_free(&framed);
}

/* Left of the line is the view before, right of it the view after, at any scale. */
TEST_BETWEEN("split is before and after", test_show_begin, NULL)
{
	struct chance chance = chance_begin("split_is_before_and_after");
	static const int sizes[][2] = {
		{WIDTH, HEIGHT}, {211, 101}, {40, 90}, {31, 23}, {3 * WIDTH, 3 * HEIGHT}};

	for (int run = 0; run < 60; run++) {
		const int *size = sizes[run % 5];
		struct show_request request = plain(SHOW_BEFORE);
		struct guarded_screen before, after, split;
		struct layout_box whole, box;
		struct layout_span line;

		request.scale = run % 2 ? SCALE_FIT : SCALE_NONE;
		request.split = run < 4 ? run % 2 : chance_real(&chance, 0, 1);
		before = shown(&request, size[0], size[1]);
		request.view = SHOW_COMPOSITE;
		after = shown(&request, size[0], size[1]);
		request.view = SHOW_SPLIT;
		split = shown(&request, size[0], size[1]);
		whole = layout_whole(&split.buffer);
		box = layout_box(&whole, WIDTH, HEIGHT, 1, request.scale);
		line = layout_line(&whole, &box, request.split);
		for (int y = 0; y < size[1]; y++) {
			bool in_box = y >= box.y && y < box.y + box.height;

			for (int x = 0; x < size[0]; x++) {
				if (!in_box || x < line.from)
					expect_that(same_pixel(&split, x, y, &before, x, y),
						    "run=%d, y=%d, x=%d", run, y, x);
				else if (x >= line.to)
					expect_that(same_pixel(&split, x, y, &after, x, y),
						    "run=%d, y=%d, x=%d", run, y, x);
			}
		}
		guarded_screen_free(&before);
		guarded_screen_free(&after);
		guarded_screen_free(&split);
	}
}

/* White between black, as high as the picture, at its share of the picture's width. */
TEST_BETWEEN("a line parts them", test_show_begin, NULL)
{
	struct show_request request = plain(SHOW_SPLIT);
	struct guarded_screen screen;

	request.split = 0.25;
	screen = shown(&request, 3 * WIDTH, HEIGHT); /* the picture covers columns 50 to 99 */
	for (int y = 0; y < HEIGHT; y++) {
		expect_that(is_code(&screen, 61, y, 0, 0, 0), "y=%d", y);
		expect_that(is_code(&screen, 62, y, 255, 255, 255), "y=%d", y);
		expect_that(is_code(&screen, 63, y, 0, 0, 0), "y=%d", y);
		assert_false(is_code(&screen, 64, y, 0, 0, 0));
		assert_false(is_code(&screen, 60, y, 0, 0, 0));
	}
	guarded_screen_free(&screen);
}

/* A screen without pictures still says what is wrong. */
TEST_BETWEEN("off keeps the text", test_show_begin, NULL)
{
	struct overlay overlay = {.trouble_count = 0};
	struct show_request request = plain(SHOW_OFF);
	struct guarded_screen screen, black = guarded_screen_create(320, 240, 0);

	screen = shown(&request, 320, 240);
	for (int y = 0; y < 240; y++) {
		for (int x = 0; x < 320; x++)
			expect_that(is_code(&screen, x, y, 0, 0, 0), "y=%d, x=%d", y, x);
	}
	guarded_screen_free(&screen);
	overlay_information(&overlay, "lights 1 of 2");
	request.overlay = &overlay;
	screen = shown(&request, 320, 240);
	assert_int_equal(overlay_draw(&overlay, &black.buffer), 0);
	for (int y = 0; y < 240; y++) {
		for (int x = 0; x < 320; x++)
			assert_true(same_pixel(&screen, x, y, &black, x, y));
	}
	guarded_screen_free(&screen);
	guarded_screen_free(&black);
	overlay_free(&overlay);
}

/* Outside its boxes nothing changes. */
TEST_BETWEEN("text lies over the picture", test_show_begin, NULL)
{
	struct overlay overlay = {.trouble_count = 0};
	struct show_request request = plain(SHOW_COMPOSITE);
	struct guarded_screen without = shown(&request, 320, 240), with;
	struct guarded_screen ink = guarded_screen_create(320, 240, 0x11);
	int covered = 0;

	overlay_information(&overlay, "lights 1 of 2");
	request.overlay = &overlay;
	with = shown(&request, 320, 240);
	assert_int_equal(overlay_draw(&overlay, &ink.buffer), 0);
	for (int y = 0; y < 240; y++) {
		for (int x = 0; x < 320; x++) {
			bool text = !is_code(&ink, x, y, 0x11, 0x11, 0x11);

			covered += text;
			expect_that(same_pixel(&with, x, y, text ? &ink : &without, x, y),
				    "y=%d, x=%d", y, x);
		}
	}
	assert_int_equal(covered > 0, WITH_CAIRO);
	guarded_screen_free(&with);
	guarded_screen_free(&without);
	guarded_screen_free(&ink);
	overlay_free(&overlay);
}

/* Each quarter shows what its view shows on a screen of that size. */
TEST_BETWEEN("quad is its four views", test_show_begin, NULL)
{
	static const enum config_show views[4] = {SHOW_SCENE, SHOW_FISHEYE, SHOW_BEFORE,
						  SHOW_COMPOSITE};
	static const int sizes[][2] = {{100, 76}, {321, 243}, {160, 121}, {60, 40}};

	for (int s = 0; s < 4; s++) {
		struct show_request request = plain(SHOW_QUAD);
		struct guarded_screen quad = shown(&request, sizes[s][0], sizes[s][1]);

		for (int q = 0; q < 4; q++) {
			struct layout_box box = layout_quarter(&quad.buffer, q);
			struct guarded_screen one;

			request.view = views[q];
			one = shown(&request, box.width, box.height);
			for (int y = 0; y < box.height; y++) {
				for (int x = 0; x < box.width; x++)
					expect_that(
						same_pixel(&quad, box.x + x, box.y + y, &one, x, y),
						"s=%d, q=%d, y=%d, x=%d", s, q, y, x);
			}
			guarded_screen_free(&one);
		}
		guarded_screen_free(&quad);
	}
}

/* Used lights are red and the others blue where r = f theta puts them, on a small quarter of the
 * screen, too. */
TEST_BETWEEN("lights are marked", test_show_begin, NULL)
{
	static const int sides[] = {120, 240, 480, 960};

	for (int s = 0; s < 4; s++) {
		struct show_request request = plain(SHOW_QUAD);
		struct guarded_screen quad = shown(&request, sides[s] * 4 / 3, sides[s]);
		double radius = sides[s] / 4.0, width = sides[s] * 2 / 3;
		double middle[2] = {width * 1.5, sides[s] / 4.0};
		int seen[2] = {0, 0};

		for (int i = 0; i < LIGHTS; i++) {
			const double *d = pipeline_dome(pipeline)->direction[i];
			double r = radius * acos(d[2]) / (M_PI / 2), phi = atan2(d[1], d[0]);
			const uint8_t *p;

			if (acos(d[2]) > 1.4) /* at the edge a mark may be cut */
				continue;
			p = guarded_screen_pixel(&quad, (int)(middle[0] + r * cos(phi)),
						 (int)(middle[1] + r * sin(phi)));
			if (pipeline_used(pipeline)[i])
				expect_that(p[2] > 150 && p[2] > p[0] + 60 && p[2] > p[1] + 60,
					    "s=%d, i=%d", s, i);
			else
				expect_that(p[0] > 150 && p[0] > p[2] + 60 && p[0] > p[1] + 40,
					    "s=%d, i=%d", s, i);
			seen[pipeline_used(pipeline)[i]]++;
		}
		expect_that(seen[0] > 3 && seen[1] > 3, "s=%d", s);
		guarded_screen_free(&quad);
	}
}

/* Where the screen's hardware scales, nothing else does: pixels are copied one by one. */
TEST_BETWEEN("hardware that scales gets the plain pixels", test_show_begin, NULL)
{
	struct show_request request = plain(SHOW_COMPOSITE);
	struct guarded_screen straight = shown(&request, WIDTH, HEIGHT), fitted;
	struct show_fit fit;
	struct layout_box after = {WIDTH, HEIGHT, WIDTH, HEIGHT};

	eyes.background.wanted.squash = eyes.background.view.squash = 2;
	fit = show_fit(SHOW_COMPOSITE, &eyes, &basis);
	assert_int_equal(fit.width, WIDTH);
	assert_int_equal(fit.height, HEIGHT);
	assert_true(fit.squash == 2);
	request.squash = fit.squash;
	fitted = shown(&request, fit.width, fit.height);
	for (int y = 0; y < HEIGHT; y++) {
		for (int x = 0; x < WIDTH; x++)
			expect_that(same_pixel(&fitted, x, y, &straight, x, y), "y=%d, x=%d", y, x);
	}
	guarded_screen_free(&fitted);
	fit = show_fit(SHOW_QUAD, &eyes, &basis);
	assert_int_equal(fit.width, 2 * WIDTH);
	assert_int_equal(fit.height, 2 * HEIGHT);
	request.view = SHOW_QUAD;
	fitted = shown(&request, fit.width, fit.height);
	for (int y = 0; y < HEIGHT; y++) {
		for (int x = 0; x < WIDTH; x++)
			expect_that(same_pixel(&fitted, after.x + x, after.y + y, &straight, x, y),
				    "y=%d, x=%d", y, x);
	}
	guarded_screen_free(&fitted);
	guarded_screen_free(&straight);
}

TEST_BETWEEN("sizes are those of what is shown", test_show_begin, NULL)
{
	int width, height;

	eyes.background.wanted.squash = 2;
	show_size(SHOW_SPLIT, &eyes, &basis, &width, &height);
	assert_int_equal(width, WIDTH);
	assert_int_equal(height, 2 * HEIGHT);
	show_size(SHOW_QUAD, &eyes, &basis, &width, &height);
	assert_int_equal(width, 2 * WIDTH);
	assert_int_equal(height, 4 * HEIGHT);
}

/* Cameras without a picture are black, and nothing fails. */
TEST_BETWEEN("no pictures", test_show_begin, NULL)
{
	struct source none = {.canvas = {.width = 0}};

	eyes.fisheye.source = eyes.background.source = &none;
	eyes.scene.source = NULL;
	for (int what = 0; what < SHOW_COUNT; what++) {
		struct show_request request = plain((enum config_show)what);
		struct guarded_screen screen = shown(&request, 61, 43);

		for (int y = 0; y < 43; y++) {
			for (int x = 0; x < 61; x++)
				expect_that(is_code(&screen, x, y, 0, 0, 0), "what=%d, y=%d, x=%d",
					    what, y, x);
		}
		guarded_screen_free(&screen);
	}
}

TEST_GROUP(set_up, tear_down);
