/* SPDX-License-Identifier: MIT */
/* Depth pictures: upright pixels of turned, flipped and cut frames; what is refused. */
#include <errno.h>
#include <string.h>

#include "hal/frame/depth.h"
#include "hal/frame/frame_decode.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { WIDTH = 5, HEIGHT = 3, STRIDE = 2 * WIDTH + 4 };

/* Each pixel's depth tells where it is in the frame: 1000 + 100 y + x. */
static void make_frame(struct frame *frame, uint8_t bytes[STRIDE * HEIGHT])
{
	memset(bytes, 0xee, STRIDE * HEIGHT);
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++) {
			const int word = 1000 + 100 * y + x;

			bytes[y * STRIDE + 2 * x] = (uint8_t)word;
			bytes[y * STRIDE + 2 * x + 1] = (uint8_t)(word >> 8);
		}
	*frame = (struct frame){.format = PIXEL_Z16,
				.width = WIDTH,
				.height = HEIGHT,
				.range = RANGE_FULL,
				.planes = {{bytes, STRIDE, STRIDE * HEIGHT}}};
}

static int mm_at(const struct depth_map *map, int x, int y)
{
	return (int)(1000 * depth_map_at(map, x, y) + 0.5);
}

TEST("pixels are found however the camera hangs")
{
	uint8_t bytes[STRIDE * HEIGHT];
	struct frame frame;

	make_frame(&frame, bytes);
	for (int turn = 0; turn < PICTURE_TURN_COUNT; turn++)
		for (int flips = 0; flips < 4; flips++) {
			const bool sideways = picture_turn_is_sideways(turn);
			const int across = sideways ? HEIGHT : WIDTH,
				  down = sideways ? WIDTH : HEIGHT;
			const struct view view = {.x = 1,
						  .y = 1,
						  .width = across - 1,
						  .height = down - 1,
						  .hflip = flips & 1,
						  .vflip = flips & 2,
						  .squash = 1};
			struct depth_map map;

			assert_int_equal(depth_map_of(&map, &frame, turn, &view, 0.001, NULL), 0);
			assert_int_equal(map.width, across - 1);
			assert_int_equal(map.height, down - 1);
			for (int y = 0; y < map.height; y++)
				for (int x = 0; x < map.width; x++) {
					/* In the turned picture, then in the frame. */
					const int u = flips & 1 ? across - 1 - x : 1 + x;
					const int v = flips & 2 ? down - 1 - y : 1 + y;
					const int at[PICTURE_TURN_COUNT][2] = {
						{u, v},
						{v, HEIGHT - 1 - u},
						{WIDTH - 1 - u, HEIGHT - 1 - v},
						{WIDTH - 1 - v, u}};

					expect_equal(mm_at(&map, x, y),
						     1000 + 100 * at[turn][1] + at[turn][0],
						     "turn %d, flips %d, %d, %d", turn, flips, x,
						     y);
				}
		}
}

/* The turns are those of pictures that are decoded. */
TEST("turns are those of pictures")
{
	const struct view view = {.width = HEIGHT, .height = WIDTH, .squash = 1};
	uint8_t bytes[STRIDE * HEIGHT];
	struct frame_decoder *decoder;
	struct canvas canvas;
	struct depth_map map;
	struct frame frame;

	make_frame(&frame, bytes);
	for (int i = 0; i < STRIDE * HEIGHT; i += 2) { /* 32 mm are a level */
		const int word = 32 * (i % 97);

		bytes[i] = (uint8_t)word;
		bytes[i + 1] = (uint8_t)(word >> 8);
	}
	for (int turn = PICTURE_TURN_90; turn <= PICTURE_TURN_270; turn += 2) {
		assert_int_equal(frame_decoder_create(&decoder, DEINTERLACE_WEAVE, turn), 0);
		assert_int_equal(canvas_create(&canvas, HEIGHT, WIDTH), 0);
		assert_int_equal(frame_decode(decoder, &frame, &canvas, NULL), 0);
		assert_int_equal(depth_map_of(&map, &frame, turn, &view, 1, NULL), 0);
		for (int y = 0; y < WIDTH; y++)
			for (int x = 0; x < HEIGHT; x++)
				expect_at_most(
					__builtin_fabs(canvas.pixels[(size_t)y * canvas.stride +
								     (size_t)x * 4] -
						       depth_map_at(&map, x, y) * 255 / 8191),
					0.501, "turn %d: %d, %d", turn, x, y);
		canvas_free(&canvas);
		frame_decoder_destroy(decoder);
	}
}

TEST("depths for eyes end in white")
{
	static const uint8_t words[] = {0, 0, 0xff, 0x1f, 0, 0x20, 0xff, 0xff, 0, 0x10};
	const struct frame frame = {.format = PIXEL_Z16,
				    .width = 5,
				    .height = 1,
				    .range = RANGE_FULL,
				    .planes = {{words, 10, 10}}};
	struct frame_decoder *decoder;
	struct canvas canvas;

	assert_int_equal(frame_decoder_create(&decoder, DEINTERLACE_WEAVE, PICTURE_UPRIGHT), 0);
	assert_int_equal(canvas_create(&canvas, 5, 1), 0);
	assert_int_equal(frame_decode(decoder, &frame, &canvas, NULL), 0);
	assert_int_equal(canvas.pixels[0], 0);
	for (int x = 1; x < 4; x++)
		assert_int_equal(canvas.pixels[4 * x], 255);
	assert_int_equal(canvas.pixels[16], 128);
	canvas_free(&canvas);
	frame_decoder_destroy(decoder);
}

TEST("what has no depths is refused")
{
	const struct view whole = {.width = WIDTH, .height = HEIGHT, .squash = 1};
	const struct view beyond = {.x = 1, .width = WIDTH, .height = HEIGHT, .squash = 1};
	uint8_t bytes[STRIDE * HEIGHT];
	struct fault fault = {""};
	struct depth_map map;
	struct frame frame;

	make_frame(&frame, bytes);
	assert_int_equal(depth_map_of(&map, &frame, 0, &beyond, 1, &fault), -EINVAL);
	assert_int_equal(depth_map_of(&map, &frame, PICTURE_TURN_90, &whole, 1, &fault), -EINVAL);
	frame.planes[0].bytes -= 5;
	assert_int_equal(depth_map_of(&map, &frame, 0, &whole, 1, &fault), -EINVAL);
	frame.format = PIXEL_YUYV;
	assert_int_equal(depth_map_of(&map, &frame, 0, &whole, 1, &fault), -ENOTSUP);
	assert_string_equal(fault.text, "the camera sends YUYV, expected Z16");
}
