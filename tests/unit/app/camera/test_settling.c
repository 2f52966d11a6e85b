/* SPDX-License-Identifier: MIT */
/* Says which pictures of a camera that was just opened count, by times that are played. */
#include <math.h>
#include <string.h>

#include "app/camera/source.h"
#include "tests/support/test.h"

#define WIDTH 64
#define HEIGHT 48

static uint8_t memory[WIDTH * HEIGHT * 4];

static struct frame_reader reader_of(enum pixel_format format)
{
	const struct view view = {.width = WIDTH, .height = HEIGHT};
	static struct frame frame;
	struct frame_reader reader;
	struct fault fault;

	frame = (struct frame){
		.format = format,
		.width = WIDTH,
		.height = HEIGHT,
		.range = format == PIXEL_BGRX ? RANGE_FULL : RANGE_LIMITED,
		.planes = {{.data = memory,
			    .stride = frame_plane_stride(format, 0, WIDTH),
			    .bytes = sizeof(memory)}},
	};
	if (frame_reader_open(&reader, &frame, &view, &fault))
		fail_msg("%s", fault.text);
	return reader;
}

static struct settling_look look_at(enum pixel_format format)
{
	const struct frame_reader reader = reader_of(format);

	return settling_look_at(&reader);
}

TEST("blank pictures are known")
{
	struct settling_look look;

	memset(memory, 0, sizeof(memory));
	look = look_at(PIXEL_BGRX);
	assert_true(look.blank);
	assert_true(fabs(look.level) < 1e-9);
	look = look_at(PIXEL_YUYV); /* green */
	assert_true(look.blank);
	assert_true(look.level > 20);
	for (size_t i = 0; i < sizeof(memory); i++) /* the noise of a sensor in the dark */
		memory[i] = (uint8_t)((uint32_t)i * 2654435761u >> 28);
	assert_true(look_at(PIXEL_BGRX).blank);
	memset(memory, 90, sizeof(memory));
	look = look_at(PIXEL_BGRX);
	assert_false(look.blank);
	assert_true(fabs(look.level - 90) < 1e-6);
	/* A lamp, an eighth of the picture wide, in the dark, of any colour but green. */
	for (int c = 0; c < 3; c += 2) {
		memset(memory, 0, sizeof(memory));
		for (int y = 20; y < 28; y++)
			for (int x = 30; x < 38; x++)
				memory[4 * (y * WIDTH + x) + c] = 200;
		assert_false(look_at(PIXEL_BGRX).blank);
	}
}

/* A camera of 30 frames a second whose frame i is captured at 5 s + i / 30 s. */
static int64_t at(int i)
{
	return 5 * NS_PER_S + i * NS_PER_S / 30;
}

static bool settling_check(struct settling *s, unsigned opening, double level, int i)
{
	const struct settling_look look = {.level = level, .blank = level <= 0};

	return settling_take(s, opening, &look, true, at(i));
}

TEST("a steady camera takes a third of a second")
{
	struct settling s = {.opening = 0};

	for (int i = 0; i < 9; i++)
		assert_false(settling_check(&s, 1, 100 + 3 * sin(i), i));
	assert_true(settling_check(&s, 1, 100, 9));
	assert_true(settling_check(&s, 1, 200, 10)); /* a lamp is switched on */
	assert_int_equal(s.left_out, 9);
}

/* Ten black frames, then an exposure that approaches its own slowly. */
TEST("what changes is waited for")
{
	struct settling s = {.opening = 0};
	int i;

	for (i = 0; i < 10; i++)
		assert_false(settling_check(&s, 1, 0, i));
	for (; !settling_check(&s, 1, 120 * (1 - 0.9 * exp(-(i - 10) / 10.0)), i); i++)
		assert_true(i < 70);
	/* From then on the level changes by less than 4 % in 0.3 s: 0.9 exp(-t/10) (1 -
	 * exp(-0.9)) */
	assert_true(0.9 * exp(-(i - 9 - 10) / 10.0) * (1 - exp(-0.9)) < 0.041);
	assert_true(s.settled);
}

TEST("a night is not waited for for ever")
{
	struct settling s = {.opening = 0};
	int i = 0;

	while (!settling_check(&s, 1, 0, i))
		i++;
	assert_int_equal(i, 90);
	/* nor a light that never rests */
	s = (struct settling){.opening = 0};
	for (i = 0; !settling_check(&s, 1, i % 2 ? 50 : 100, i);)
		i++;
	assert_int_equal(i, 90);
}

TEST("each opening settles anew")
{
	struct settling s = {.opening = 0};
	int i = 0;

	while (!settling_check(&s, 1, 100, i))
		i++;
	assert_int_equal(s.left_out, 9);
	assert_false(settling_check(&s, 2, 100, 1000));
	assert_false(settling_check(&s, 2, 100, 1008));
	assert_true(settling_check(&s, 2, 100, 1009));
	assert_int_equal(s.left_out, 11);
}

/* Two pictures a second: three of them, not one. */
TEST("slow cameras show three pictures")
{
	struct settling s = {.opening = 0};

	assert_false(settling_check(&s, 1, 100, 0));
	assert_false(settling_check(&s, 1, 100, 15));
	assert_true(settling_check(&s, 1, 100, 30));
}

TEST("fixed exposures leave out blank pictures alone")
{
	const struct settling_look black = {.blank = true}, bright = {.level = 200},
				   dim = {.level = 20};
	struct settling s = {.opening = 0};

	assert_false(settling_take(&s, 1, &black, false, at(0)));
	assert_true(settling_take(&s, 1, &bright, false, at(1)));
	assert_true(settling_take(&s, 1, &dim, false, at(2)));
	assert_true(settling_take(&s, 1, &black, false, at(3)));
}
