#include <errno.h>
#include <string.h>

#include "app/kiosk_parts.h"
#include "app/pipeline_config.h"
#include "drivers/drivers.h"

static struct source *source_named(struct kiosk *k, const char *name)
{
	for (int i = 0; i < k->source_count; i++) {
		if (!strcmp(k->sources[i].settings.name, name))
			return &k->sources[i];
	}
	return NULL;
}

static struct eye eye_of(struct kiosk *k, const char *section, const struct config_view *view)
{
	return (struct eye){
		.section = section,
		.source = source_named(k, view->camera),
		.wanted = config_view(view),
	};
}

/* Only cameras that a view looks through are opened. */
static bool is_watched(const struct config *config, const char *camera)
{
	return !strcmp(config->fisheye.view.camera, camera) ||
	       !strcmp(config->background.view.camera, camera) ||
	       !strcmp(config->scene.view.camera, camera);
}

/* Radiance that two views share is encoded as the background expects it. */
static enum transfer transfer_for(const struct config *config, const char *camera)
{
	return !strcmp(config->background.view.camera, camera)
		       ? (enum transfer)config->background.transfer
		       : (enum transfer)config->fisheye.transfer;
}

static int open_source(struct kiosk *k, struct config_camera *camera, struct fault *fault)
{
	int driver = config_driver_index(k->config, CONFIG_CAMERA, camera->driver);
	struct source *source = &k->sources[k->source_count];
	struct source_settings settings = {
		.name = camera->name,
		.ops = camera_drivers[driver],
		.camera = camera->settings,
		.options = config_options(k->config, CONFIG_CAMERA, camera, driver),
		.deinterlace = (enum deinterlace)camera->deinterlace,
		.transfer = transfer_for(k->config, camera->name),
	};
	struct fault reason = {.text = ""};
	int err = source_create(source, &settings);

	if (err)
		return fault_say(fault, err, "not enough memory for camera %s", camera->name);
	k->source_count++;
	err = source_open(source, &reason);
	if (err && source_is_hopeless(source))
		return fault_say(fault, err, "camera %s: %s", camera->name, reason.text);
	if (err)
		source_complain(source, &reason);
	return 0;
}

static int open_sources(struct kiosk *k, struct fault *fault)
{
	for (int i = 0; i < k->config->camera_count; i++) {
		struct config_camera *camera = k->config->cameras[i];
		int err;

		if (!is_watched(k->config, camera->name))
			continue;
		err = open_source(k, camera, fault);
		if (err)
			return err;
	}
	k->eyes.fisheye = eye_of(k, "fisheye", &k->config->fisheye.view);
	k->eyes.background = eye_of(k, "background", &k->config->background.view);
	k->eyes.scene = eye_of(k, "scene", &k->config->scene.view);
	return 0;
}

static int open_display(struct kiosk *k, struct fault *fault)
{
	struct config_screen *screen = k->config->screen;
	struct display_settings settings = screen->settings;
	int driver = config_driver_index(k->config, CONFIG_DISPLAY, screen->driver);

	show_size(k->what, &k->eyes, &k->basis, &settings.picture_width, &settings.picture_height);
	return display_open(&k->display, display_drivers[driver], &settings,
			    config_options(k->config, CONFIG_DISPLAY, screen, driver), fault);
}

static int open_buttons(struct kiosk *k, struct fault *fault)
{
	struct config_buttons *buttons = k->config->buttons;
	int drivers[CONFIG_DRIVERS_MAX];

	if (config_buttons_used(k->config, drivers) == 0)
		return 0; /* "none" */
	return buttons_open(&k->buttons, buttons_drivers[drivers[0]],
			    config_options(k->config, CONFIG_BUTTONS, buttons, drivers[0]), fault);
}

int kiosk_open(struct kiosk *k, struct fault *fault)
{
	const struct config *config = k->config;
	struct pipeline_settings settings = pipeline_settings_of(config);
	int err;

	k->loop.epoll = k->loop.signals = k->loop.timer = -1;
	k->choice = (struct pipeline_choice){config->lights.threshold, config->basis.pose, true};
	k->what = (enum config_show)config->screen->show;
	err = basis_open(&k->basis, config->basis.file, fault);
	if (err)
		return err;
	err = loop_open(&k->loop, fault); /* before any thread: they inherit its signals */
	if (err)
		return err;
	err = pipeline_create(&k->pipeline, &k->basis, &settings, fault);
	if (err)
		return err;
	err = pipeline_choose(&k->pipeline, &k->choice, fault); /* is there such a pose? */
	if (err)
		return err;
	err = open_sources(k, fault);
	if (err)
		return err;
	err = open_buttons(k, fault);
	if (err)
		return err;
	err = stats_open(&k->stats, k->settings->stats, fault);
	if (err)
		return err;
	return open_display(k, fault); /* last: until now the screen shows what it did */
}

int kiosk_close(struct kiosk *k, struct fault *fault)
{
	int err = display_close(&k->display, fault);

	stats_close(&k->stats);
	buttons_close(&k->buttons);
	for (int i = 0; i < k->source_count; i++)
		source_destroy(&k->sources[i]);
	show_free(&k->show);
	pipeline_destroy(&k->pipeline);
	loop_close(&k->loop);
	basis_close(&k->basis);
	return err;
}
