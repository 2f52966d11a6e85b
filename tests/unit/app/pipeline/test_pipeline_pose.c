/* SPDX-License-Identifier: MIT */
/* The pose that is shown while others are being unpacked. The basis is made by hand: each pose is a
 * plane of one grey. No result depends on how long unpacking takes. */
#include <errno.h>
#include <math.h>
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/pipeline/pipeline_parts.h"
#include "hal/base/clock.h"
#include "hal/basis/basis_writer.h"
#include "tests/support/basis/hand_block.h"
#include "tests/support/expect.h"
#include "tests/support/plain_pipeline.h"
#include "tests/support/test.h"

enum { WIDTH = 320, HEIGHT = 256, LIGHTS = 6, POSES = 10, TILES = WIDTH * HEIGHT / 256 };

/* Far more than unpacking a pose takes, which is milliseconds. */
#define LONGEST_NS (60 * NS_PER_S)

static char path[] = "/tmp/test_pipeline_pose_XXXXXX"; /* of the basis file */
static struct basis basis;
static struct pipeline *pipeline;
static uint8_t out[HEIGHT][WIDTH][4];

static double grey_of(int pose)
{
	return (pose + 1) / (POSES + 1.0);
}

static void write_pose(struct basis_writer *writer, const struct basis_light *lights, int pose)
{
	static uint16_t coverage[WIDTH * HEIGHT], pixel[256];
	static float peak[LIGHTS + 1][3], value[256][3][LIGHTS];
	struct fault fault = {.text = ""};
	struct basis_block_payload block;

	memset(coverage, 0xff, sizeof(coverage));
	for (int p = 0; p < 256; p++) {
		pixel[p] = (uint16_t)p;
		for (int c = 0; c < 3; c++)
			value[p][c][0] = (float)grey_of(pose);
	}
	for (int c = 0; c < 3; c++)
		peak[0][c] = peak[LIGHTS][c] = 1;
	block = hand_block_of_object(0, 256, pixel, LIGHTS, lights, &value[0][0][0]);
	for (uint32_t t = 0; t < TILES; t++) {
		block.entry.tile = t;
		expect_success(basis_writer_blocks(writer, &block, 1, &fault), &fault);
	}
	free((void *)block.payload);
	expect_success(basis_writer_pose_end(writer, coverage, (const float(*)[3])peak, &fault),
		       &fault);
}

static void write_basis(void)
{
	const struct basis_info_chunk info = {.width = WIDTH,
					      .height = HEIGHT,
					      .lights = LIGHTS,
					      .dome_frequency = 1,
					      .poses = POSES,
					      .coarse = LIGHTS};
	struct basis_light lights[LIGHTS];
	struct fault fault = {.text = ""};
	struct basis_writer *writer;

	hand_block_lights(1, LIGHTS, lights);
	expect_success(basis_writer_open(&writer, path, &info, lights, NULL, NULL, "", &fault),
		       &fault);
	for (int pose = 0; pose < POSES; pose++)
		write_pose(writer, lights, pose);
	expect_success(basis_writer_finish(writer, &info, "", &fault), &fault);
}

static int open_basis(void **state)
{
	struct fault fault = {.text = ""};
	const int file = mkstemp(path);

	(void)state;
	if (file < 0)
		return -1;
	close(file);
	write_basis();
	expect_success(basis_open(&basis, path, BASIS_SHOWN, &fault), &fault);
	return 0;
}

static int close_basis(void **state)
{
	(void)state;
	basis_close(&basis);
	return unlink(path);
}

static int test_pose_begin(void **state)
{
	const struct pipeline_settings settings = plain_pipeline(2);
	static const float light[LIGHTS][3] = {{1, 1, 1}};
	struct fault fault = {.text = ""};

	(void)state;
	expect_success(pipeline_create(&pipeline, &basis, &settings, &fault), &fault);
	pipeline_light_given(pipeline, light);
	return 0;
}

static int test_pose_end(void **state)
{
	(void)state;
	pipeline_destroy(pipeline);
	return 0;
}

static void shows(double grey)
{
	for (int at = 0; at < WIDTH * HEIGHT; at += WIDTH * HEIGHT - 1) {
		const uint8_t *pixel = out[at / WIDTH][at % WIDTH];

		for (int c = 0; c < 3; c++)
			expect_at_most(fabs(pixel[c] - 255 * transfer_encode(TRANSFER_SRGB, grey)),
				       1, "at=%d, c=%d", at, c);
	}
}

/* Composites one frame and checks that it shows the poses that it reports. A held frame has all of
 * its data in memory before. */
static void test_pose_frame(struct pipeline_choice choice)
{
	static const uint8_t row[WIDTH * 4];
	const struct picture black = {.origin = row, .x_step = 4, .width = WIDTH, .height = HEIGHT};
	const struct backdrop backdrop = backdrop_of(&black);
	const struct pipeline_choice *shown = &pipeline->choice;
	struct fault fault = {.text = ""};

	choice.object = true;
	expect_success(pipeline_choose(pipeline, &choice, &fault), &fault);
	if (choice.hold) {
		assert_true(basis_pose_ready(&basis, shown->pose));
		assert_true(shown->share == 0 || basis_pose_ready(&basis, shown->next));
	}
	expect_success(pipeline_composite(pipeline, &backdrop, &out[0][0][0], WIDTH * 4, &fault),
		       &fault);
	shows((1 - shown->share) * grey_of(shown->pose) + shown->share * grey_of(shown->next));
}

/* Held frames until these poses are shown. After a jump, the first frame shows the poses of before.
 */
static void jump(struct pipeline_choice choice)
{
	const struct pipeline_choice before = pipeline->choice;
	const int64_t start = clock_now_ns();

	choice.hold = true;
	test_pose_frame(choice);
	assert_int_equal(pipeline->choice.pose, before.pose);
	assert_int_equal(pipeline->choice.next, before.next);
	while (pipeline->choice.pose != choice.pose || pipeline->choice.share != choice.share) {
		assert_int_equal(pipeline->choice.pose, before.pose);
		assert_true(clock_now_ns() - start < LONGEST_NS);
		sched_yield();
		test_pose_frame(choice);
	}
	assert_true(choice.share == 0 || pipeline->choice.next == choice.next);
}

TEST_BETWEEN("no frame waits for a jump", test_pose_begin, test_pose_end)
{
	static const int order[] = {4, 8, 2, 6, 0, 5};

	test_pose_frame((struct pipeline_choice){.pose = 0});
	for (size_t k = 0; k < sizeof(order) / sizeof(*order); k++)
		jump((struct pipeline_choice){.pose = order[k]});
	/* to a mix of two poses */
	jump((struct pipeline_choice){.pose = 8, .next = 2, .share = 0.25});
	jump((struct pipeline_choice){.pose = 5});
}

static void wait_for(int pose)
{
	const int64_t start = clock_now_ns();

	while (!basis_pose_ready(&basis, pose)) {
		assert_true(clock_now_ns() - start < LONGEST_NS);
		sched_yield();
	}
}

/* All poses in order, either way round, each with time to unpack the next: each is ready at once.
 */
TEST_BETWEEN("a neighbour is there at once", test_pose_begin, test_pose_end)
{
	int pose = 3;

	test_pose_frame((struct pipeline_choice){.pose = pose});
	for (int k = 0; k < 3 * POSES; k++) {
		pose = (pose + (k < 2 * POSES ? 1 : POSES - 1)) % POSES;
		wait_for(pose);
		test_pose_frame((struct pipeline_choice){.pose = pose, .hold = true});
		expect_equal(pipeline->choice.pose, pose, "k=%d", k);
	}
}

/* A held choice waits when there is no pose to show; a choice that does not hold waits always. */
TEST_BETWEEN("others wait", test_pose_begin, test_pose_end)
{
	test_pose_frame((struct pipeline_choice){.pose = 7});
	assert_int_equal(pipeline->choice.pose, 7);
	test_pose_frame((struct pipeline_choice){.pose = 3});
	assert_int_equal(pipeline->choice.pose, 3);
	test_pose_end(NULL);
	test_pose_begin(NULL);
	test_pose_frame((struct pipeline_choice){.pose = 9});
	assert_int_equal(pipeline->choice.pose, 9);
}

/* The choice changes before it can be shown: some of the choices are shown all the same. */
TEST_BETWEEN("a restless choice is followed", test_pose_begin, test_pose_end)
{
	const int64_t start = clock_now_ns();
	int seen = 0, last = 0;

	test_pose_frame((struct pipeline_choice){.pose = 0});
	for (int k = 1; seen < 10; k++) {
		expect_below(clock_now_ns() - start, LONGEST_NS, "k=%d", k);
		test_pose_frame((struct pipeline_choice){.pose = 3 * k % POSES, .hold = true});
		seen += pipeline->choice.pose != last;
		last = pipeline->choice.pose;
	}
	/* an earlier choice is not shown again */
	while (pipeline->choice.pose != 5) {
		assert_true(clock_now_ns() - start < LONGEST_NS);
		test_pose_frame((struct pipeline_choice){.pose = 5, .hold = true});
	}
	test_pose_frame((struct pipeline_choice){.pose = 5, .hold = true});
	assert_int_equal(pipeline->choice.pose, 5);
}

/* A view without composite: poses are chosen, but no picture is made. */
static void choose_unseen(int pose)
{
	const struct pipeline_choice choice = {.pose = pose, .object = true, .hold = true};
	const int64_t start = clock_now_ns();
	struct fault fault = {.text = ""};

	do {
		assert_true(clock_now_ns() - start < LONGEST_NS);
		sched_yield();
		expect_success(pipeline_choose(pipeline, &choice, &fault), &fault);
	} while (pipeline->choice.pose != pose);
}

/* The pose of the last picture has left memory and come back to another address. */
TEST_BETWEEN("a pose comes back unseen", test_pose_begin, test_pose_end)
{
	static const int unseen[] = {1, 2, 3, 4, 3, 2, 1, 0};

	test_pose_frame((struct pipeline_choice){.pose = 0});
	for (size_t k = 0; k < sizeof(unseen) / sizeof(*unseen); k++)
		choose_unseen(unseen[k]);
	test_pose_frame((struct pipeline_choice){.pose = 0, .hold = true});
	assert_int_equal(pipeline->choice.pose, 0);
}

/* ---- poses that cannot be had ---- */

static void stays(struct pipeline_choice choice, int shown, int missing)
{
	test_pose_frame(choice);
	assert_int_equal(pipeline->choice.pose, shown);
	assert_true(pipeline->choice.share == 0);
	assert_int_equal(pipeline->pose.missing, missing);
	assert_non_null(strstr(pipeline->pose.trouble.text, "cut short"));
}

/* Held frames until loading the pose has failed. */
static void try_in_vain(int pose, int shown)
{
	const int64_t start = clock_now_ns();

	do {
		assert_true(clock_now_ns() - start < LONGEST_NS);
		sched_yield();
		test_pose_frame((struct pipeline_choice){.pose = pose, .hold = true});
		assert_int_equal(pipeline->choice.pose, shown);
	} while (pipeline->pose.missing != pose);
	stays((struct pipeline_choice){.pose = pose, .hold = true}, shown, pose);
}

static void come(int pose)
{
	const int64_t start = clock_now_ns();

	pipeline_try_again(pipeline);
	while (pipeline->choice.pose != pose) {
		assert_true(clock_now_ns() - start < LONGEST_NS);
		sched_yield();
		test_pose_frame((struct pipeline_choice){.pose = pose, .hold = true});
	}
	assert_int_equal(pipeline->pose.missing, -1);
}

/* Waits until the thread has unpacked the neighbours of pose 0, and so nothing else any more. */
static void wait_for_neighbours(void)
{
	const int64_t start = clock_now_ns();

	while (!basis_pose_ready(&basis, 1) || !basis_pose_ready(&basis, POSES - 1) ||
	       (!basis_pose_ready(&basis, 2) && !basis_pose_ready(&basis, POSES - 2))) {
		assert_true(clock_now_ns() - start < LONGEST_NS);
		sched_yield();
	}
}

/* The file is cut short, and whole again at the end. */
TEST_BETWEEN("what is shown stays", test_pose_begin, test_pose_end)
{
	struct pipeline_choice fade = {.pose = 0, .next = 6, .share = 0.5};

	test_pose_frame((struct pipeline_choice){.pose = 0});
	assert_int_equal(pipeline->pose.missing, -1);
	wait_for_neighbours();
	assert_int_equal(truncate(path, 0), 0);
	try_in_vain(5, 0);
	stays((struct pipeline_choice){.pose = 6}, 0, 6);
	stays(fade, 0, 6);
	pipeline_try_again(pipeline);
	stays((struct pipeline_choice){.pose = 6}, 0, 6);
	try_in_vain(5, 0);
	test_pose_frame((struct pipeline_choice){.pose = 0, .hold = true});
	assert_int_equal(pipeline->pose.missing, -1); /* no pose that is wanted is missing */
	try_in_vain(5, 0);
	write_basis();
	stays((struct pipeline_choice){.pose = 5, .hold = true}, 0, 5);
	come(5);
	test_pose_frame(fade);
	assert_true(pipeline->choice.share > 0);
}

/* Before anything has been shown a missing pose is an error, and the next choice starts anew. */
TEST_BETWEEN("without a picture it is an error", test_pose_begin, test_pose_end)
{
	struct fault fault = {.text = ""};
	const struct pipeline_choice choice = {.pose = 5, .object = true};

	basis_poses_expect(&basis, NULL, 0);
	assert_int_equal(truncate(path, 0), 0);
	assert_int_equal(pipeline_choose(pipeline, &choice, &fault), -EBADMSG);
	assert_non_null(strstr(fault.text, "cut short"));
	write_basis();
	basis_poses_expect(&basis, NULL, 0);
	test_pose_frame(choice);
}

TEST_GROUP(open_basis, close_basis);
