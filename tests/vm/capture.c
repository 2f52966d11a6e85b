/*
 * Takes frames from a real V4L2 device through the driver and says what came, one "name value" a
 * line, so that a shell test can check it.
 *
 *     capture FRAMES OUT.png [device=/dev/video0] [format=YUYV] [width=W] [height=H] [rate=HZ]
 *             [matrix=bt601|bt709] [range=limited|full] [hold=MS]
 *
 * hold keeps each frame that long before it is given back, as a busy program would. Exit 1 when the
 * camera does not open or ends; "situation" and "error" then say why.
 */
#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "drivers/drivers.h"
#include "hal/camera.h"
#include "hal/image/image.h"

struct request {
	struct camera_settings settings;
	int frames, hold_ms;
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

static const struct camera_ops *find_driver(void)
{
	for (int i = 0; camera_drivers[i]; i++)
		if (!strcmp(camera_drivers[i]->name, "v4l2"))
			return camera_drivers[i];
	fprintf(stderr, "capture: the driver v4l2 is not in this build\n");
	exit(1);
}

static struct request parse(int argc, char **argv)
{
	static const char *const matrices[] = {"auto", "bt601", "bt709", NULL};
	static const char *const ranges[] = {"auto", "limited", "full", NULL};
	struct request r = {.settings.buffers = 4};

	if (argc < 3) {
		fprintf(stderr, "usage: capture FRAMES OUT.png [name=value]...\n");
		exit(2);
	}
	r.frames = atoi(argv[1]);
	r.out = argv[2];
	for (int i = 3; i < argc; i++) {
		char *value = strchr(argv[i], '=');
		if (!value)
			exit(2);
		*value++ = '\0';
		if (!strcmp(argv[i], "device"))
			snprintf(r.settings.device, sizeof(r.settings.device), "%s", value);
		else if (!strcmp(argv[i], "format"))
			r.settings.format = name_index(pixel_format_names, value);
		else if (!strcmp(argv[i], "width"))
			r.settings.width = atoi(value);
		else if (!strcmp(argv[i], "height"))
			r.settings.height = atoi(value);
		else if (!strcmp(argv[i], "rate"))
			r.settings.rate_hz = atof(value);
		else if (!strcmp(argv[i], "matrix"))
			r.settings.matrix = name_index(matrices, value);
		else if (!strcmp(argv[i], "range"))
			r.settings.range = name_index(ranges, value);
		else if (!strcmp(argv[i], "hold"))
			r.hold_ms = atoi(value);
		else
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

/* What is watched over the frames of one run. */
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

/* One frame, waited for at most 5 s. */
static int next_frame(struct camera *camera, struct frame *frame, struct fault *fault)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	const time_t limit = now.tv_sec + 5;

	for (;;) {
		struct pollfd p = {.fd = camera_descriptor(camera), .events = POLLIN};
		poll(&p, 1, 500);
		int err = camera_grab(camera, frame, fault);
		if (err != -EAGAIN)
			return err;
		clock_gettime(CLOCK_MONOTONIC, &now);
		if (now.tv_sec > limit)
			return fault_say(fault, -ETIMEDOUT, "no frame for 5 s");
	}
}

static int take(struct camera *camera, const struct request *request, struct watch *watch,
		struct fault *fault)
{
	struct canvas canvas = {0};
	struct frame_decoder *decoder = NULL;
	int err = canvas_create(&canvas, camera->width, camera->height);

	if (!err)
		err = frame_decoder_create(&decoder);
	while (!err && watch->taken < request->frames) {
		struct frame frame;
		err = next_frame(camera, &frame, fault);
		if (err)
			break;
		if (watch->taken == 0)
			printf("stride %zu\nmatrix %s\nrange %s\n", frame.planes[0].stride,
			       frame.matrix == MATRIX_BT709 ? "bt709" : "bt601",
			       frame.range == RANGE_FULL ? "full" : "limited");
		watch_frame(watch, &frame);
		if (watch->taken == request->frames)
			err = frame_decode(decoder, &frame, &canvas, fault);
		if (request->hold_ms)
			poll(NULL, 0, request->hold_ms);
		camera_release(camera, &frame);
	}
	if (!err)
		err = write_canvas(request->out, &canvas, fault);
	frame_decoder_destroy(decoder);
	canvas_free(&canvas);
	return err;
}

int main(int argc, char **argv)
{
	const struct request request = parse(argc, argv);
	const struct camera_ops *driver = find_driver();
	struct camera camera = {0};
	struct watch watch = {0};
	struct fault fault = {""};
	void *options = driver->options_size ? calloc(1, driver->options_size) : NULL;

	setvbuf(stdout, NULL, _IOLBF, 0); /* a test waits for the first lines */
	if (driver->keys)
		ini_defaults(driver->keys, options);
	int err = camera_open(&camera, driver, &request.settings, options, &fault);
	if (!err) {
		printf("format %s\nsize %dx%d\nrate %g\n", pixel_format_names[camera.format],
		       camera.width, camera.height, camera.rate_hz);
		err = take(&camera, &request, &watch, &fault);
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
		printf("error %s\n", fault.text);
	camera_close(&camera);
	free(options);
	return err ? 1 : 0;
}
