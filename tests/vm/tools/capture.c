/* SPDX-License-Identifier: MIT */
/*
 * Takes frames from a camera through its driver and says what came, one "name value" a line, so
 * that a shell test can check it; the last frame becomes a picture, unless OUT.png is "-", and what
 * its lines of even and of odd number hold is said ("even LOWEST HIGHEST", without the first two:
 * in them a PAL camera signals its aspect).
 *
 *     capture DRIVER FRAMES OUT.png [device=/dev/video0] [format=YUYV] [width=W] [height=H]
 *             [rate=HZ] [matrix=bt601|bt709] [range=limited|full] [hold=MS] [controls=LIST]
 *             [give_up=WORDS] [deinterlace=weave|bob|blend] [change=CONTROL=VALUE]
 *             [OPTION=VALUE]...
 *
 * OPTION is the driver's own. hold keeps each frame that long before it is given back, as a busy
 * program would. change sets a control once the first frame has come. Exit 1 when the camera does
 * not open or ends; "situation", "code" and "error" then say why.
 */
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/device/camera.h"
#include "hal/frame/frame_decode.h"
#include "hal/image/image.h"
#include "tests/vm/tools/driver_option.h"

struct capture_request {
	struct camera_settings settings;
	int frames, hold_ms;
	enum deinterlace deinterlace;
	struct camera_control change; /* an empty name: none */
	const char *out;
};

static int name_index(const char *const *names, const char *name)
{
	for (int i = 0; names[i]; i++)
		if (!strcasecmp(names[i], name))
			return i;
	fprintf(stderr, "capture: no such name: %s\n", name);
	exit(2);
}

static const struct camera_ops *find_driver(const char *name)
{
	for (int i = 0; camera_drivers[i]; i++)
		if (!strcmp(camera_drivers[i]->name, name))
			return camera_drivers[i];
	fprintf(stderr, "capture: the driver %s is not in this build\n", name);
	exit(1);
}

static struct camera_control read_control(const char *text)
{
	struct camera_control control;
	struct fault fault = {""};

	if (camera_controls_next(&text, &control, &fault) > 0)
		return control;
	fprintf(stderr, "capture: change: expected CONTROL=VALUE. %s\n", fault.text);
	exit(2);
}

/* The value if text is "name=value", else NULL. */
static const char *value_of(const char *text, const char *name)
{
	const size_t length = strlen(name);
	return strncmp(text, name, length) || text[length] != '=' ? NULL : text + length + 1;
}

static struct capture_request parse(int argc, char **argv, const struct camera_ops *driver,
				    void *options)
{
	static const char *const matrices[] = {"auto", "bt601", "bt709", NULL};
	static const char *const ranges[] = {"auto", "limited", "full", NULL};
	struct capture_request r = {.settings.buffers = 4, .frames = atoi(argv[2]), .out = argv[3]};
	const char *value;

	for (int i = 4; i < argc; i++) {
		if ((value = value_of(argv[i], "device")))
			snprintf(r.settings.device, sizeof(r.settings.device), "%s", value);
		else if ((value = value_of(argv[i], "format")))
			r.settings.format = name_index(pixel_format_names, value);
		else if ((value = value_of(argv[i], "width")))
			r.settings.width = atoi(value);
		else if ((value = value_of(argv[i], "height")))
			r.settings.height = atoi(value);
		else if ((value = value_of(argv[i], "rate")))
			r.settings.rate_hz = atof(value);
		else if ((value = value_of(argv[i], "matrix")))
			r.settings.matrix = name_index(matrices, value);
		else if ((value = value_of(argv[i], "range")))
			r.settings.range = name_index(ranges, value);
		else if ((value = value_of(argv[i], "controls")))
			snprintf(r.settings.controls, sizeof(r.settings.controls), "%s", value);
		else if ((value = value_of(argv[i], "give_up")))
			snprintf(r.settings.give_up, sizeof(r.settings.give_up), "%s", value);
		else if ((value = value_of(argv[i], "deinterlace")))
			r.deinterlace = (enum deinterlace)name_index(deinterlace_names, value);
		else if ((value = value_of(argv[i], "change")))
			r.change = read_control(value);
		else if ((value = value_of(argv[i], "hold")))
			r.hold_ms = atoi(value);
		else if (driver_option_set(driver->name, driver->keys, options, argv[i]))
			exit(2);
	}
	return r;
}

static int write_canvas(const char *path, const struct canvas *canvas, struct fault *fault)
{
	struct image image;
	int err = image_create_u8(&image, canvas->width, canvas->height);

	if (err)
		return err;
	for (int y = 0; y < canvas->height; y++) {
		const uint8_t *from = canvas->pixels + (size_t)y * canvas->stride;
		uint8_t *to = image.u8 + (size_t)y * canvas->width * 3;
		for (int x = 0; x < canvas->width; x++) {
			to[3 * x + 0] = from[4 * x + 2];
			to[3 * x + 1] = from[4 * x + 1];
			to[3 * x + 2] = from[4 * x + 0];
		}
	}
	err = image_write(path, &image, fault);
	image_free(&image);
	return err;
}

/* What is counted over the frames of a run. */
struct watch {
	int taken, backwards, sequence_gaps;
	int64_t first_ns, last_ns;
	uint32_t last_sequence;
};

static void watch_frame(struct watch *w, const struct frame *frame)
{
	if (w->taken == 0)
		w->first_ns = frame->timestamp_ns;
	else if (frame->timestamp_ns <= w->last_ns)
		w->backwards++;
	if (w->taken && frame->sequence != w->last_sequence + 1)
		w->sequence_gaps++;
	w->last_ns = frame->timestamp_ns;
	w->last_sequence = frame->sequence;
	w->taken++;
}

/* Waits for the next frame, 5 s at most. */
static int next_frame(struct camera *camera, struct frame *frame, struct fault *fault)
{
	const int64_t limit_ns = clock_now_ns() + 5 * NS_PER_S;

	for (;;) {
		struct pollfd p = {.fd = camera_descriptor(camera), .events = POLLIN};
		poll(&p, 1, 500);
		int err = camera_grab(camera, frame, fault);
		if (err != -EAGAIN)
			return err;
		if (clock_now_ns() > limit_ns)
			return fault_say(fault, -ETIMEDOUT, "no frame for 5 s");
	}
}

static const char *fields_text(const struct frame *frame)
{
	static const char *const names[] = {"none", "interlaced", "top-bottom", "bottom-top",
					    "pair", "top",	  "bottom"};
	static char text[40];

	snprintf(text, sizeof(text), "%s%s", names[frame->fields],
		 frame->bottom_first ? " bottom-first" : "");
	return text;
}

static void say_lines(const struct canvas *canvas, int parity)
{
	int lowest = 255, highest = 0;

	for (int y = 2 + parity; y < canvas->height; y += 2)
		for (int x = 0; x < canvas->width * 4; x++) {
			const int level = canvas->pixels[(size_t)y * canvas->stride + (size_t)x];
			if (x % 4 == 3)
				continue;
			lowest = level < lowest ? level : lowest;
			highest = level > highest ? level : highest;
		}
	printf("%s %d %d\n", parity ? "odd" : "even", lowest, highest);
}

static int capture_take(struct camera *camera, const struct capture_request *request,
			struct watch *watch, struct fault *fault)
{
	struct canvas canvas = {0};
	struct frame_decoder *decoder = NULL;
	int err = canvas_create(&canvas, camera->width, camera->height);

	if (!err)
		err = frame_decoder_create(&decoder, request->deinterlace, PICTURE_UPRIGHT);
	while (!err && watch->taken < request->frames) {
		struct frame frame;
		err = next_frame(camera, &frame, fault);
		if (err)
			break;
		if (watch->taken == 0)
			printf("fields %s\nstride %zu\nmatrix %s\nrange %s\n", fields_text(&frame),
			       frame.planes[0].stride,
			       frame.matrix == MATRIX_BT709 ? "bt709" : "bt601",
			       frame.range == RANGE_FULL ? "full" : "limited");
		watch_frame(watch, &frame);
		if (watch->taken == request->frames)
			err = frame_decode(decoder, &frame, &canvas, fault);
		if (request->hold_ms)
			poll(NULL, 0, request->hold_ms);
		camera_release(camera, &frame);
		if (!err && watch->taken == 1 && *request->change.name)
			err = camera_set_control(camera, request->change.name,
						 request->change.value, NULL, fault);
	}
	for (int parity = 0; parity < 2 && !err; parity++)
		say_lines(&canvas, parity);
	if (!err && strcmp(request->out, "-") != 0)
		err = write_canvas(request->out, &canvas, fault);
	frame_decoder_destroy(decoder);
	canvas_free(&canvas);
	return err;
}

int main(int argc, char **argv)
{
	struct camera camera = {0};
	struct watch watch = {0};
	struct fault fault = {""};

	if (argc < 4) {
		fprintf(stderr, "usage: capture DRIVER FRAMES OUT.png [name=value]...\n");
		return 2;
	}
	setvbuf(stdout, NULL, _IOLBF, 0); /* a test waits for the first lines */
	const struct camera_ops *driver = find_driver(argv[1]);
	void *options = calloc(1, driver->options_size + 1);
	if (driver->keys)
		ini_defaults(driver->keys, options);
	const struct capture_request request = parse(argc, argv, driver, options);
	int err = camera_open(&camera, driver, &request.settings, options, &fault);
	if (!err) {
		printf("name %s\nformat %s\nsize %dx%d\nrate %g\n", camera.name,
		       pixel_format_names[camera.format], camera.width, camera.height,
		       camera.rate_hz);
		err = capture_take(&camera, &request, &watch, &fault);
		printf("taken %d\nframes %llu\nlost %llu\nbroken %llu\nbackwards %d\ngaps %d\n",
		       watch.taken, (unsigned long long)camera.frames,
		       (unsigned long long)camera.lost, (unsigned long long)camera.broken,
		       watch.backwards, watch.sequence_gaps);
		if (watch.taken > 1)
			printf("measured_rate %.2f\n",
			       1e9 * (watch.taken - 1) / (double)(watch.last_ns - watch.first_ns));
	}
	printf("situation %s\n", camera_situation_names[camera.situation]);
	if (err)
		printf("code %s\nerror %s\n", strerrorname_np(-err), fault.text);
	camera_close(&camera);
	free(options);
	return err ? 1 : 0;
}
