/* SPDX-License-Identifier: MIT */
#include "bake/calibrate/observe/live.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "bake/calibrate/observe/live_screen.h"
#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/colour/transfer.h"
#include "hal/device/camera.h"
#include "hal/frame/frame_decode.h"

struct live {
	struct config_driver_room room; /* the drivers that the configuration may name */
	struct config *config;
	const char *name; /* the camera's name in the configuration */
	struct camera camera;
	struct frame_decoder *decoder;
	struct transfer_tables *tables; /* for cameras that deliver linear light */
	struct canvas canvas;		/* the decoded frame */
	struct view view;
	int64_t newer_than_ns; /* older frames are skipped */
};

/* ---- opening ---- */

static int read_config(struct live *live, const char *path, struct fault *fault)
{
	/* Nobody presses buttons here, but a kiosk's configuration has their keys. */
	const struct config_drivers drivers = config_drivers_of(&live->room, camera_drivers,
								display_drivers, buttons_drivers);
	struct ini_report report = {.count = 0};
	int err = config_create(&live->config, &drivers);

	if (err)
		return fault_say(fault, err, "%s: out of memory", path);
	err = config_read(live->config, path, &report);
	return err ? fault_say(fault, err, "%s", report.first.text) : 0;
}

/* Opens the camera as the kiosk does. The lens and light files, which calibration writes, are not
 * read. */
static int open_camera(struct live *live, struct config_camera *camera, struct fault *fault)
{
	const int driver = config_driver_index(live->config, CONFIG_CAMERA, camera->driver);
	struct fault why = {{0}};
	int err;

	live->name = camera->name;
	if (driver < 0)
		return fault_say(fault, -EINVAL,
				 "%s: [camera %s] driver: there is no driver \"%s\"",
				 live->config->name, camera->name, camera->driver);
	err = camera_open(&live->camera, camera_drivers[driver], &camera->settings,
			  config_options(live->config, CONFIG_CAMERA, camera, driver), &why);
	if (err)
		return fault_say(fault, err, "camera %s: %s: %s", camera->name,
				 camera_situation_names[live->camera.situation], why.text);
	return 0;
}

static int prepare_pictures(struct live *live, const struct config_camera *camera,
			    const struct transfer_curve *curve, struct fault *fault)
{
	const enum picture_turn turn = (enum picture_turn)camera->turn;
	const bool sideways = picture_turn_is_sideways(turn);
	const int width = sideways ? live->camera.height : live->camera.width;
	const int height = sideways ? live->camera.width : live->camera.height;
	struct fault why = {{0}};
	int err = view_resolve(&live->view, width, height, &why);

	if (err)
		return fault_say(fault, err, "%s: camera %s: %s", live->config->name, camera->name,
				 why.text);
	if (turn != PICTURE_UPRIGHT && live->camera.format == PIXEL_RGBF)
		return fault_say(fault, -ENOTSUP,
				 "%s: [camera %s] rotate: pictures of linear light are not turned",
				 live->config->name, camera->name);
	err = frame_decoder_create(&live->decoder, (enum deinterlace)camera->deinterlace, turn);
	if (!err)
		err = canvas_create(&live->canvas, width, height);
	live->tables = malloc(sizeof(*live->tables));
	if (err || !live->tables)
		return fault_say(fault, err ? err : -ENOMEM, "camera %s: out of memory",
				 camera->name);
	transfer_tables_fill(live->tables, curve);
	return 0;
}

static int open_view(struct live *live, const char *path, enum live_view which, struct fault *fault)
{
	const struct config_view *view;
	struct config_camera *camera;
	struct transfer_curve curve;
	int err = read_config(live, path, fault);

	if (err)
		return err;
	view = which == LIVE_FISHEYE ? &live->config->fisheye.view : &live->config->background.view;
	curve = which == LIVE_FISHEYE ? config_fisheye_curve(&live->config->fisheye)
				      : config_background_curve(&live->config->background);
	camera = config_camera_named(live->config, view->camera);
	if (!camera)
		return fault_say(fault, -EINVAL, "%s: [%s] camera: %s%s%s", path,
				 which == LIVE_FISHEYE ? "fisheye" : "background",
				 *view->camera ? "there is no [camera " : "it names no camera",
				 view->camera, *view->camera ? "]" : "");
	live->view = view->view;
	err = open_camera(live, camera, fault);
	return err ? err : prepare_pictures(live, camera, &curve, fault);
}

int live_open(struct live **live, const char *config, enum live_view view, struct fault *fault)
{
	struct live *l = calloc(1, sizeof(*l));
	int err;

	*live = NULL;
	if (!l)
		return fault_say(fault, -ENOMEM, "%s: out of memory", config);
	err = open_view(l, config, view, fault);
	if (err) {
		live_close(l);
		return err;
	}
	*live = l;
	return 0;
}

void live_close(struct live *live)
{
	if (!live)
		return;
	camera_close(&live->camera);
	frame_decoder_destroy(live->decoder);
	canvas_free(&live->canvas);
	free(live->tables);
	config_destroy(live->config);
	free(live);
}

int live_width(const struct live *live)
{
	return live->view.width;
}

int live_height(const struct live *live)
{
	return live->view.height;
}

struct config *live_config(struct live *live)
{
	return live->config;
}

double live_squash(const struct live *live)
{
	return live->view.squash;
}

int live_lens(struct live *live, struct fisheye_settings *lens, struct transfer_curve *curve,
	      struct fault *fault)
{
	struct ini_report report = {.count = 0};
	int err;

	/* Linear light is encoded here, by the curve as configured. */
	*curve = config_fisheye_curve(&live->config->fisheye);
	err = config_read_files(live->config, &report);
	if (err)
		return fault_say(fault, err, "%s", report.first.text);
	*lens = live->config->fisheye.lens;
	if (live->camera.format != PIXEL_RGBF)
		*curve = config_fisheye_curve(&live->config->fisheye);
	return 0;
}

/* ---- pictures ---- */

/* Encodes linear light as the kiosk does. The comparison is written so that NaN becomes black. */
static uint8_t code_of_light(const struct transfer_tables *tables, float linear)
{
	if (!(linear > 0))
		return tables->encode[0];
	return tables->encode[linear < 1 ? (int)(linear * 65535 + 0.5F) : 65535];
}

static int encode_light(struct live *live, const struct frame *frame)
{
	const struct frame_plane *plane = &frame->planes[0];
	const size_t row = (size_t)frame->width * 3 * sizeof(float);

	if (frame->width != live->canvas.width || frame->height != live->canvas.height ||
	    plane->stride < row || plane->bytes < plane->stride * (size_t)(frame->height - 1) + row)
		return -EINVAL;
	for (int y = 0; y < frame->height; y++) {
		const uint8_t *from = plane->data + (size_t)y * plane->stride;
		uint8_t *to = live->canvas.pixels + (size_t)y * live->canvas.stride;

		for (int x = 0; x < frame->width; x++, from += 3 * sizeof(float), to += 4) {
			float rgb[3];

			memcpy(rgb, from, sizeof(rgb));
			for (int c = 0; c < 3; c++)
				to[c] = code_of_light(live->tables, rgb[2 - c]);
		}
	}
	return 0;
}

static void copy_upright(const struct live *live, struct image *picture)
{
	const struct picture upright = view_picture(&live->view, live->canvas.pixels,
						    live->canvas.stride);
	uint8_t *to = picture->u8;

	for (int y = 0; y < upright.height; y++) {
		const uint8_t *from = upright.origin + y * upright.y_step;

		for (int x = 0; x < upright.width; x++, from += upright.x_step, to += 3) {
			to[0] = from[2];
			to[1] = from[1];
			to[2] = from[0];
		}
	}
}

/* Returns 0; -EAGAIN: no frame yet, or not a usable one; -ENODEV. */
static int live_take_frame(struct live *live, int64_t *captured_ns, struct fault *fault)
{
	struct fault why = {{0}};
	struct frame frame;
	int err = camera_grab(&live->camera, &frame, &why);

	if (err == -EAGAIN)
		return err;
	if (err)
		return fault_say(fault, -ENODEV, "camera %s: %s: %s", live->name,
				 camera_situation_names[live->camera.situation],
				 err == -ESTALE ? "it sends another kind of picture now"
						: why.text);
	*captured_ns = frame.timestamp_ns;
	if (frame.timestamp_ns <= live->newer_than_ns)
		err = -EAGAIN;
	else if (frame.format == PIXEL_RGBF)
		err = encode_light(live, &frame);
	else
		err = frame_decode(live->decoder, &frame, &live->canvas, NULL);
	camera_release(&live->camera, &frame);
	return err ? -EAGAIN : 0; /* damaged frames are skipped */
}

static int wait_for_frame(struct live *live, int64_t until_ns, int timeout_ms, struct fault *fault)
{
	struct pollfd wait = {.fd = camera_descriptor(&live->camera), .events = POLLIN};
	const int64_t left_ns = until_ns - clock_now_ns();
	const int left_ms = left_ns > 0 ? (int)((left_ns + NS_PER_MS - 1) / NS_PER_MS) : 0;
	const int ready = poll(&wait, 1, left_ms);

	if (ready > 0 || (ready < 0 && errno == EINTR))
		return 0;
	return fault_say(fault, -ETIMEDOUT, "camera %s: no picture within %d ms", live->name,
			 timeout_ms);
}

int live_next(struct live *live, int timeout_ms, struct image *picture, int64_t *captured_ns,
	      struct fault *fault)
{
	const int64_t until_ns = clock_now_ns() + timeout_ms * NS_PER_MS;
	int err;

	if (!picture->u8 && image_create_u8(picture, live->view.width, live->view.height))
		return fault_say(fault, -ENOMEM, "camera %s: out of memory", live->name);
	do {
		err = wait_for_frame(live, until_ns, timeout_ms, fault);
		if (!err)
			err = live_take_frame(live, captured_ns, fault);
		/* A camera that sends only unusable frames times out, too. */
		if (err == -EAGAIN && clock_now_ns() >= until_ns)
			err = fault_say(fault, -ETIMEDOUT,
					"camera %s: no picture of use within %d ms", live->name,
					timeout_ms);
	} while (err == -EAGAIN);
	if (!err)
		copy_upright(live, picture);
	return err;
}

int live_flush(struct live *live, struct fault *fault)
{
	(void)fault;
	/* A camera that renders frames on demand has none queued, and a clock of its own. */
	if (!live->camera.on_demand)
		live->newer_than_ns = clock_now_ns();
	return 0;
}
