/* SPDX-License-Identifier: MIT */
/* A still picture of a camera that finds its exposure while pictures come. Its time is played. */
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "app/grab.h"
#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "tests/support/captured_log.h"
#include "tests/support/test.h"

enum { SIZE = 8, RATE = 8, BRIGHT = 250, RIGHT = 130 };

/* The level falls from BRIGHT to RIGHT within so many pictures; < 0: it goes to and fro. */
static struct {
	int falling, i, since, ready;
	int64_t begun_ns;
	uint8_t memory[2][SIZE * SIZE * 4];
} fake;

static int fake_open(struct camera *camera, struct fault *fault)
{
	(void)fault;
	fake.begun_ns = clock_now_ns();
	camera->format = PIXEL_BGRX;
	camera->width = camera->height = SIZE;
	camera->rate_hz = RATE;
	camera->state = &fake;
	return 0;
}

static int fake_descriptor(struct camera *camera)
{
	(void)camera;
	return fake.ready;
}

static int fake_grab(struct camera *camera, struct frame *frame, struct fault *fault)
{
	uint8_t *memory = fake.memory[fake.i % 2];
	const int i = fake.i++ - fake.since;
	const int level = i < fake.falling	      ? BRIGHT - (BRIGHT - RIGHT) * i / fake.falling
			  : fake.falling < 0 && i % 2 ? BRIGHT
						      : RIGHT;

	(void)camera;
	(void)fault;
	memset(memory, level, sizeof(fake.memory[0]));
	*frame = (struct frame){.format = PIXEL_BGRX,
				.width = SIZE,
				.height = SIZE,
				.range = RANGE_FULL,
				.timestamp_ns = fake.begun_ns + fake.i * NS_PER_S / RATE,
				.planes = {{memory, SIZE * 4, sizeof(fake.memory[0])}}};
	return 0;
}

static void fake_release(struct camera *camera, struct frame *frame)
{
	(void)camera;
	(void)frame;
}

static void fake_close(struct camera *camera)
{
	camera->state = NULL;
}

/* The camera finds its exposure anew. */
static int fake_control(struct camera *camera, const char *name, const char *value, double *taken,
			struct fault *fault)
{
	(void)camera;
	(void)name;
	(void)value;
	(void)taken;
	(void)fault;
	fake.since = fake.i;
	fake.begun_ns = clock_now_ns() - fake.i * NS_PER_S / RATE;
	return 0;
}

static const struct camera_ops fake_ops = {
	.name = "fake",
	.description = "finds its exposure",
	.open = fake_open,
	.descriptor = fake_descriptor,
	.grab = fake_grab,
	.release = fake_release,
	.close = fake_close,
	.control = fake_control,
};

const struct camera_ops *const camera_drivers[] = {&fake_ops, NULL};

static const struct config_driver fakes[] = {{"fake", NULL, 0}, {NULL, NULL, 0}};
static const struct config_driver none[] = {{NULL, NULL, 0}};
static const struct config_drivers drivers = {{fakes, none, none}};

static struct config *config;
static struct grab *grab;

static void begin(int falling)
{
	static const char text[] = "[camera c]\ndriver = fake\n[background]\ncamera = c\n";
	struct ini_report report = {.count = 0};
	struct fault fault = {""};

	memset(&fake, 0, sizeof(fake));
	fake.falling = falling;
	fake.ready = eventfd(1, EFD_CLOEXEC);
	assert_int_equal(config_create(&config, &drivers), 0);
	if (config_read_memory(config, text, strlen(text), "k.conf", &report))
		fail_msg("%s", report.first.text);
	if (grab_open(&grab, config, "background", false, &fault))
		fail_msg("%s", fault.text);
}

static void end(void)
{
	grab_close(grab);
	config_destroy(config);
	close(fake.ready);
}

/* The level of the picture that is taken, and what is said meanwhile. */
static int level_taken(char said[512])
{
	struct captured_log log = captured_log_begin();
	struct image image = {.u8 = NULL};
	struct fault fault = {""};
	int err = grab_take(grab, &image, &fault), level = err ? -1 : image.u8[0];
	FILE *lines = captured_log_end(&log);

	*said = '\0';
	(void)!fgets(said, 512, lines);
	fclose(lines);
	image_free(&image);
	return level;
}

TEST("an exposure that moves is waited for")
{
	struct fault fault;
	char said[512];

	begin(60);
	assert_in_range(level_taken(said), RIGHT, RIGHT + RIGHT / 20);
	assert_string_equal(said, "");
	assert_in_range(fake.i, 60, 60 + 2 * RATE); /* no later than it is right */
	assert_int_equal(grab_control(grab, "gain", "1", &fault), 0);
	assert_in_range(level_taken(said), RIGHT, RIGHT + RIGHT / 20);
	end();
}

TEST("a picture that never rests is named")
{
	char said[512];

	begin(-1);
	assert_true(level_taken(said) > 0);
	assert_non_null(strstr(said, "camera c: its brightness still changes"));
	assert_in_range(fake.i, 11 * RATE, 12 * RATE);
	end();
}
