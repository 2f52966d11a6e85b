/* SPDX-License-Identifier: MIT */
#include "app/grab.h"

#include <errno.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>

#include "app/camera/eye.h"
#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

/* A control shows within so long. Only then is it watched whether the picture still changes. */
#define SETTLE_NS (3 * NS_PER_S / 2)
#define SETTLE_FRAMES 3		  /* of a camera without a clock of its own */
#define WITHIN_NS (60 * NS_PER_S) /* without a picture for so long there is none */

struct grab {
	struct source source;
	struct eye eye;
	int64_t since_ns; /* when the camera was opened, or a control set */
	int passed;	  /* frames since then */
};

/* The view of a name; NULL: it is none. */
static const struct config_view *find_view(const struct config *config, const char *name)
{
	const struct {
		const char *name;
		const struct config_view *view;
	} views[] = {{"fisheye", &config->fisheye.view},
		     {"background", &config->background.view},
		     {"scene", &config->scene.view},
		     {"depth", &config->depth.view}};

	for (int i = 0; i < 4; i++) {
		if (strcmp(views[i].name, name) == 0 && views[i].view->camera[0])
			return views[i].view;
	}
	return NULL;
}

static int start_source(struct grab *grab, struct config *config, struct config_camera *camera,
			struct fault *fault)
{
	const int driver = config_driver_index(config, CONFIG_CAMERA, camera->driver);
	const bool background = strcmp(config->background.view.camera, camera->name) == 0;
	const struct source_settings settings = {
		.name = camera->name,
		.ops = camera_drivers[driver],
		.camera = config_camera_settings(config, camera),
		.options = config_options(config, CONFIG_CAMERA, camera, driver),
		.deinterlace = (enum deinterlace)camera->deinterlace,
		.turn = (enum picture_turn)camera->turn,
		.curve = background ? config_background_curve(&config->background)
				    : config_fisheye_curve(&config->fisheye),
	};
	int err = source_create(&grab->source, &settings);

	if (err)
		return fault_say(fault, err, "camera %s: cannot be set up: %s", camera->name,
				 strerror(-err));
	source_open(&grab->source);
	return 0;
}

/* Waits until the camera has something to say. */
static int grab_wait(struct grab *grab, int64_t until_ns, struct fault *fault)
{
	const int64_t left_ns = until_ns - clock_now_ns();
	struct pollfd wait = {.fd = source_descriptor(&grab->source), .events = POLLIN};

	if (left_ns > 0 && wait.fd >= 0 &&
	    (poll(&wait, 1, (int)(left_ns / NS_PER_MS) + 1) > 0 || errno == EINTR))
		return 0;
	return fault_say(fault, -ETIMEDOUT, "camera %s: %s: no picture within %d s",
			 grab->source.settings.name,
			 camera_situation_names[grab->source.opening.situation],
			 (int)(WITHIN_NS / NS_PER_S));
}

static int grab_finish_opening(struct grab *grab, struct fault *fault)
{
	const int64_t until_ns = clock_now_ns() + WITHIN_NS;
	struct fault why = {""};
	int err = 0;

	while (!err && !grab->source.opening.tried) {
		err = grab_wait(grab, until_ns, fault);
		if (err)
			return err;
		err = source_take(&grab->source, clock_now_ns(), &why);
	}
	grab->since_ns = clock_now_ns();
	return err ? fault_say(fault, err, "camera %s: %s", grab->source.settings.name, why.text)
		   : 0;
}

int grab_open(struct grab **grab, struct config *config, const char *name, bool as_sent,
	      struct fault *fault)
{
	const struct config_view *view = find_view(config, name);
	struct config_camera *camera = config_camera_named(config, view ? view->camera : name);
	struct grab *g;
	int err;

	*grab = NULL;
	if (!camera)
		return fault_say(
			fault, -EINVAL,
			"no camera \"%s\", expected fisheye, background, scene, depth or the name of a [camera NAME] of the configuration",
			name);
	g = calloc(1, sizeof(*g));
	if (!g)
		return fault_say(fault, -ENOMEM, "no memory for a picture");
	g->eye = (struct eye){.section = name,
			      .source = &g->source,
			      .wanted = view && !as_sent ? view->view : (struct view){.squash = 1}};
	err = start_source(g, config, camera, fault);
	if (!err)
		err = grab_finish_opening(g, fault);
	if (err) {
		grab_close(g);
		return err;
	}
	*grab = g;
	return 0;
}

void grab_close(struct grab *grab)
{
	if (!grab)
		return;
	source_destroy(&grab->source);
	free(grab);
}

int grab_control(struct grab *grab, const char *name, const char *value, struct fault *fault)
{
	struct fault why = {""};
	int err = source_control(&grab->source, name, value, NULL, &why);

	if (err)
		return fault_say(fault, err, "camera %s: %s", grab->source.settings.name, why.text);
	grab->since_ns = clock_now_ns();
	grab->passed = 0;
	grab->source.settling.opening = 0;
	return 0;
}

static bool has_settled(struct grab *grab)
{
	struct settling *settling = &grab->source.settling;

	if (grab->source.camera.on_demand)
		return grab->passed > SETTLE_FRAMES;
	settling->kept = true;
	if (grab->source.picture_ns - grab->since_ns < SETTLE_NS)
		return false;
	if (grab->source.camera.format == PIXEL_Z16)
		return true;
	if (!eye_has_settled(&grab->eye, true))
		return false;
	if (settling->in_vain && settling->level >= 0)
		log_warning(
			"camera %s: its brightness still changes: the picture may be too bright or too dark",
			grab->source.settings.name);
	return true;
}

static int copy_picture(struct grab *grab, struct image *image, struct fault *fault)
{
	const struct picture picture = eye_picture(&grab->eye);
	int err = image_create_u8(image, picture.width, picture.height);

	if (err)
		return fault_say(fault, err, "no memory for a picture of %dx%d", picture.width,
				 picture.height);
	for (int y = 0; y < picture.height; y++)
		for (int x = 0; x < picture.width; x++) {
			const uint8_t *from = picture.origin + y * picture.y_step +
					      x * picture.x_step;
			uint8_t *to = image->u8 +
				      3 * ((size_t)y * (size_t)picture.width + (size_t)x);

			for (int c = 0; c < 3; c++)
				to[c] = from[2 - c];
		}
	return 0;
}

int grab_take(struct grab *grab, struct image *image, struct fault *fault)
{
	const int64_t until_ns = clock_now_ns() + SETTLE_NS + WITHIN_NS;
	struct source *source = &grab->source;

	for (;;) {
		int err = grab_wait(grab, until_ns, fault);

		if (err)
			return err;
		(void)source_take(source, clock_now_ns(), NULL);
		if (!source_is_open(source))
			return fault_say(fault, -ENODEV, "camera %s: %s%s%s", source->settings.name,
					 camera_situation_names[source->opening.situation],
					 source->opening.why.text[0] ? ": " : "",
					 source->opening.why.text);
		if (!source_has_news(source) || !source_decode(source, clock_now_ns()))
			continue;
		grab->passed++;
		err = eye_fit(&grab->eye, fault);
		if (err)
			return err;
		if (has_settled(grab))
			return copy_picture(grab, image, fault);
	}
}
