/* SPDX-License-Identifier: MIT */
/*
 * A screen that writes files. The name says which kind:
 *
 *     clip.y4m       one YUV4MPEG2 video, 4:4:4, BT.601 limited range (as players assume), at
 *                    [screen] rate frames a second, or 30; the file appears when it is closed
 *     out%04d.png    a picture for each frame, numbered from 0
 *     now.png        the newest frame
 *
 * It takes frames as fast as they come. submit() writes the file, so it takes as long as the disk.
 */
#include <ctype.h>
#include <errno.h>
#include <libyuv.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/base/output.h"
#include "hal/frame/frame.h"
#include "hal/image/image.h"

#define RATE_FALLBACK_HZ 30.0

enum file_kind { FILE_Y4M, FILE_SEQUENCE, FILE_NEWEST };

struct file_screen {
	enum file_kind kind;
	/* A sequence: the name is a prefix, a number of at least `digits` digits, and a suffix. */
	int prefix_length, digits;
	bool zeros;
	const char *suffix;
	int number; /* frames written */

	struct canvas canvas;
	struct output video;
	uint8_t *planes; /* Y, U, V of a Y4M frame */
	struct image picture;
	bool failed;

	int event; /* eventfd: readable while `shown` is to be reported */
	struct display_event shown;
};

/* Splits a name at its number. True: it has exactly one %d, %4d or %04d and no other % sign. */
static bool find_number(struct file_screen *screen, const char *path)
{
	const char *percent = strchr(path, '%');
	const char *at;

	if (!percent)
		return false;
	at = percent + 1;
	screen->prefix_length = (int)(percent - path);
	screen->zeros = *at == '0';
	while (isdigit((unsigned char)*at) && screen->digits < 20)
		screen->digits = screen->digits * 10 + (*at++ - '0');
	screen->suffix = at + 1;
	return *at == 'd' && screen->digits < 20 && !strchr(screen->suffix, '%');
}

static int choose_kind(struct file_screen *screen, const char *path, struct fault *fault)
{
	const char *dot = strrchr(path, '.');
	const bool png = dot && !strcasecmp(dot, ".png");

	if (dot && !strcasecmp(dot, ".y4m"))
		screen->kind = FILE_Y4M;
	else if (png && !strchr(path, '%'))
		screen->kind = FILE_NEWEST;
	else if (png && find_number(screen, path))
		screen->kind = FILE_SEQUENCE;
	else
		return fault_say(
			fault, -EINVAL,
			"file display: cannot tell what to write from the name \"%s\", expected clip.y4m, out%%04d.png or now.png",
			path);
	return 0;
}

static int start_video(struct display *display, struct file_screen *screen, struct fault *fault)
{
	const double wanted = display->settings.rate_hz;
	const double rate = wanted > 0 ? wanted : RATE_FALLBACK_HZ;
	const bool whole = fabs(rate - round(rate)) < 1e-6;
	int err;

	screen->planes = malloc(3 * (size_t)display->width * (size_t)display->height);
	if (!screen->planes)
		return fault_say(fault, -ENOMEM, "file display: not enough memory");
	err = output_open(&screen->video, display->settings.device, fault);
	if (err)
		return err;
	fprintf(screen->video.stream,
		"YUV4MPEG2 W%d H%d F%ld:%d Ip A1:1 C444 XCOLORRANGE=LIMITED\n", display->width,
		display->height, lrint(whole ? rate : rate * 1000), whole ? 1 : 1000);
	return 0;
}

static int file_open(struct display *display, struct fault *fault)
{
	struct file_screen *screen;
	int err;

	err = display_free_size(display, &display->width, &display->height, fault);
	if (err)
		return err;
	screen = calloc(1, sizeof(*screen));
	if (!screen)
		return fault_say(fault, -ENOMEM, "file display: not enough memory");
	display->state = screen;
	display->rate_hz = 0;
	screen->event = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
	if (screen->event < 0) {
		err = -errno;
		return fault_say(fault, err, "file display: eventfd: %s", strerror(-err));
	}
	err = choose_kind(screen, display->settings.device, fault);
	if (err)
		return err;
	err = canvas_create(&screen->canvas, display->width, display->height);
	if (!err && screen->kind != FILE_Y4M)
		err = image_create_u8(&screen->picture, display->width, display->height);
	if (err)
		return fault_say(fault, err, "file display: no memory for %d x %d pixels",
				 display->width, display->height);
	return screen->kind == FILE_Y4M ? start_video(display, screen, fault) : 0;
}

static int file_descriptor(struct display *display)
{
	return ((struct file_screen *)display->state)->event;
}

static int file_acquire(struct display *display, struct display_buffer *buffer)
{
	const struct file_screen *screen = display->state;

	if (screen->shown.kind != DISPLAY_NOTHING)
		return -EAGAIN;
	*buffer = (struct display_buffer){
		.pixels = screen->canvas.pixels,
		.stride = screen->canvas.stride,
		.width = screen->canvas.width,
		.height = screen->canvas.height,
	};
	return 0;
}

static int file_write_video(struct file_screen *screen, struct fault *fault)
{
	const struct canvas *canvas = &screen->canvas;
	const size_t plane = (size_t)canvas->width * (size_t)canvas->height;
	FILE *stream = screen->video.stream;
	int err;

	ARGBToI444(canvas->pixels, (int)canvas->stride, screen->planes, canvas->width,
		   screen->planes + plane, canvas->width, screen->planes + 2 * plane, canvas->width,
		   canvas->width, canvas->height);
	if (fputs("FRAME\n", stream) >= 0 &&
	    fwrite(screen->planes, 1, 3 * plane, stream) == 3 * plane)
		return 0;
	err = -errno;
	return fault_say(fault, err, "%s: cannot write the video: %s", screen->video.path,
			 strerror(-err));
}

static int file_write_picture(struct file_screen *screen, const char *device, struct fault *fault)
{
	const struct canvas *canvas = &screen->canvas;
	char path[INI_PATH_MAX + 32];

	if (screen->kind == FILE_NEWEST)
		snprintf(path, sizeof(path), "%s", device);
	else
		snprintf(path, sizeof(path), screen->zeros ? "%.*s%0*d%s" : "%.*s%*d%s",
			 screen->prefix_length, device, screen->digits, screen->number,
			 screen->suffix);
	/* libyuv's RAW is R, G, B in memory. */
	ARGBToRAW(canvas->pixels, (int)canvas->stride, screen->picture.u8, canvas->width * 3,
		  canvas->width, canvas->height);
	return image_write(path, &screen->picture, fault);
}

static int file_submit(struct display *display, struct display_buffer *buffer, int64_t token,
		       struct fault *fault)
{
	struct file_screen *screen = display->state;
	const uint64_t one = 1;
	int err;

	(void)buffer;
	err = screen->kind == FILE_Y4M
		      ? file_write_video(screen, fault)
		      : file_write_picture(screen, display->settings.device, fault);
	if (!err && write(screen->event, &one, sizeof(one)) < 0)
		err = -errno;
	if (err) {
		screen->failed = true;
		return err;
	}
	screen->number++;
	screen->shown = (struct display_event){
		.kind = DISPLAY_SHOWN,
		.time_ns = clock_now_ns(),
		.token = token,
	};
	return 0;
}

static int file_dispatch(struct display *display, struct display_event *event, struct fault *fault)
{
	struct file_screen *screen = display->state;
	uint64_t count;

	if (read(screen->event, &count, sizeof(count)) < 0) {
		const int err = -errno;

		return err == -EAGAIN ? 0 : fault_say(fault, err, "file display: eventfd");
	}
	*event = screen->shown;
	screen->shown.kind = DISPLAY_NOTHING;
	return 0;
}

/* Discards a video that has no frames or whose last one is incomplete. */
static int file_close(struct display *display, struct fault *fault)
{
	struct file_screen *screen = display->state;
	int err = 0;

	if (!screen)
		return 0;
	if (screen->video.stream && screen->number && !screen->failed)
		err = output_commit(&screen->video, fault);
	output_abandon(&screen->video);
	if (screen->event >= 0)
		close(screen->event);
	canvas_free(&screen->canvas);
	image_free(&screen->picture);
	free(screen->planes);
	free(screen);
	display->state = NULL;
	return err;
}

const struct display_ops display_file = {
	.name = "file",
	.description =
		"a video (.y4m), numbered pictures (out%04d.png) or the newest one (now.png)",
	.open = file_open,
	.descriptor = file_descriptor,
	.acquire = file_acquire,
	.submit = file_submit,
	.dispatch = file_dispatch,
	.close = file_close,
};
