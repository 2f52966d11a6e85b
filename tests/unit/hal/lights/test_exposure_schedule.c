/* SPDX-License-Identifier: MIT */
/* The exposure that a frame has, for a played camera that obeys some frames later and loses
 * some. */
#include <errno.h>
#include <stdbool.h>

#include "hal/lights/exposure_schedule.h"
#include "tests/support/chance.h"
#include "tests/support/expect.h"
#include "tests/support/test.h"

enum { COUNT = 3, FRAMES = 400 };

/* A camera, and the exposure of each of its frames. */
struct scheduled_camera {
	int delay;
	bool beyond;  /* slower than the schedule allows for, so that its answers may be wrong */
	int64_t next; /* number of the next frame */
	int shown[FRAMES + 64]; /* exposure of each frame; 0 at first */
};

static const double light[COUNT] = {0.6, 0.1, 0.0125};

static void obey(struct scheduled_camera *camera, int exposure)
{
	for (int64_t k = camera->next + camera->delay; k < FRAMES + 64; k++)
		camera->shown[k] = exposure;
}

/* Captures one frame, after `lost` that are lost and with `late` more before the answer. Checks the
 * exposure that the schedule says, unless it says that it does not know. */
static int schedule_step(struct exposure_schedule *s, struct scheduled_camera *camera, int lost,
			 int late, uint32_t offset)
{
	const int64_t frame = camera->next + lost;
	int exposure, next;

	camera->next = frame + 1;
	exposure = exposure_schedule_take(s, offset + (uint32_t)frame);
	if (exposure >= 0 && !camera->beyond)
		assert_int_equal(exposure, camera->shown[frame]);
	camera->next += late;
	next = exposure_schedule_next(s);
	if (next >= 0) {
		obey(camera, next);
		exposure_schedule_asked(s, next, late);
	}
	return exposure;
}

TEST("every delay is kept track of")
{
	for (int delay = 0; delay <= EXPOSURE_DELAY_MAX; delay++) {
		struct scheduled_camera camera = {.delay = delay};
		struct exposure_schedule s;
		int count[COUNT] = {0};

		exposure_schedule_begin(&s, COUNT, delay);
		while (camera.next < 100) {
			const int exposure = schedule_step(&s, &camera, 0, 0, UINT32_MAX - 20);

			if (exposure >= 0)
				count[exposure]++;
			else
				expect_at_most(camera.next, delay + 1, "delay=%d", delay);
		}
		for (int k = 0; k < COUNT; k++)
			assert_in_range(count[k], 28, 34);
	}
}

TEST("lost and late frames shift nothing")
{
	struct chance chance = chance_begin("lost frames");

	for (int delay = 0; delay <= 6; delay++) {
		struct scheduled_camera camera = {.delay = delay};
		struct exposure_schedule s;
		int known = 0;

		exposure_schedule_begin(&s, COUNT, delay);
		while (camera.next < FRAMES - 10)
			known += schedule_step(&s, &camera, chance_int(&chance, 0, 9) ? 0 : 3,
					       chance_int(&chance, 0, 5) ? 0 : 2, 7) >= 0;
		expect_above(known, 150, "delay=%d", delay);
	}
}

/* A source that does not number its frames: they follow each other. */
TEST("numbers that stand still")
{
	struct exposure_schedule s;

	exposure_schedule_begin(&s, 2, 1);
	for (int k = 0; k < 20; k++) {
		const int exposure = exposure_schedule_take(&s, 0);

		expect_equal(exposure, k < 2 ? -1 : k % 2, "k=%d", k);
		exposure_schedule_asked(&s, exposure_schedule_next(&s), 0);
	}
}

/* Measures the delay as the kiosk does: asks with the frame, then tells its brightness. */
static int schedule_measure(struct scheduled_camera *camera, struct chance *chance, bool loses,
			    bool shows)
{
	struct exposure_schedule s;
	int err = 0;

	exposure_schedule_begin(&s, COUNT, -1);
	while (s.delay < 0 && !err && camera->next < FRAMES - 10) {
		const int lost = loses && !chance_int(chance, 0, 15);

		schedule_step(&s, camera, lost, 0, 0);
		err = exposure_schedule_measure(&s, shows ? light[camera->shown[camera->next - 1]] *
								    chance_real(chance, 0.97, 1.03)
							  : 0.5);
	}
	return err ? err : s.delay;
}

TEST("a delay is measured")
{
	struct chance chance = chance_begin("measured");

	for (int delay = 0; delay <= EXPOSURE_DELAY_MAX; delay++) {
		struct scheduled_camera camera = {.delay = delay};

		expect_equal(schedule_measure(&camera, &chance, false, true), delay, "delay=%d",
			     delay);
		expect_at_most(camera.next, 4 * (EXPOSURE_HOLD + 1) + 2, "delay=%d", delay);
	}
}

/* Whatever frames are lost, the measured delay is right, or the schedule says that it cannot tell.
 */
TEST("lost frames do not spoil the measurement")
{
	struct chance chance = chance_begin("measured with losses");
	int right = 0;

	for (int n = 0; n < 50; n++) {
		struct scheduled_camera camera = {.delay = n % 7};
		const int found = schedule_measure(&camera, &chance, true, true);

		right += found == n % 7;
		expect_that(found == n % 7 || found == n % 7 + 1 || found == -ENODATA, "n=%d", n);
	}
	assert_true(right >= 40);
}

TEST("what is not seen is said")
{
	struct chance chance = chance_begin("not seen");
	struct scheduled_camera camera = {.delay = 2},
				slow = {.delay = EXPOSURE_DELAY_MAX + 3, .beyond = true};

	assert_int_equal(schedule_measure(&camera, &chance, false, false), -ENODATA);
	assert_int_equal(schedule_measure(&slow, &chance, false, true), -ENODATA);
}
