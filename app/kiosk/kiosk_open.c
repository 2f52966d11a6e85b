/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "app/pipeline/pipeline_config.h"
#include "drivers/drivers.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

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
struct transfer_curve kiosk_curve_for(const struct config *config, const char *camera)
{
	return !strcmp(config->background.view.camera, camera)
		       ? config_background_curve(&config->background)
		       : config_fisheye_curve(&config->fisheye);
}

static int create_source(struct kiosk *k, struct config_camera *camera, struct fault *fault)
{
	int driver = config_driver_index(k->config, CONFIG_CAMERA, camera->driver);
	struct source *source = &k->sources[k->source_count];
	struct source_settings settings = {
		.name = camera->name,
		.ops = camera_drivers[driver],
		.camera = camera->settings,
		.options = config_options(k->config, CONFIG_CAMERA, camera, driver),
		.deinterlace = (enum deinterlace)camera->deinterlace,
		.curve = kiosk_curve_for(k->config, camera->name),
	};
	int err = source_create(source, &settings);

	if (err)
		return fault_say(fault, err, "camera %s: cannot be set up: %s", camera->name,
				 strerror(-err));
	k->source_count++;
	source_open(source);
	return 0;
}

static int create_sources(struct kiosk *k, struct fault *fault)
{
	for (int i = 0; i < k->config->camera_count; i++) {
		struct config_camera *camera = k->config->cameras[i];
		int err;

		if (!is_watched(k->config, camera->name)) {
			log_info("camera %s: no view names it, it stays closed", camera->name);
			continue;
		}
		err = create_source(k, camera, fault);
		if (err)
			return err;
	}
	k->eyes.fisheye = eye_of(k, "fisheye", &k->config->fisheye.view);
	exposing_start(&k->exposing, &k->config->fisheye);
	k->eyes.background = eye_of(k, "background", &k->config->background.view);
	k->eyes.scene = eye_of(k, "scene", &k->config->scene.view);
	return 0;
}

/* What was chosen before a power cut goes over what the configuration says; whatever is wrong with
 * it is said, and no reason not to start. */
static void take_state(struct kiosk *k)
{
	const struct config *config = k->config;
	struct state_values values = {k->choice.threshold, k->what, k->choice.pose};
	struct output probe = {.stream = NULL};
	struct fault fault = {.text = ""};
	int err;

	if (!*config->state.file)
		return;
	err = state_read(config->state.file, &values, &fault);
	if (err && err != -ENOENT)
		log_warning("state: %s; the configuration counts", fault.text);
	/* Better said now than when something was chosen, months later. */
	if (output_open(&probe, config->state.file, &fault))
		log_warning("state: %s; what is chosen cannot be kept", fault.text);
	output_abandon(&probe);
	k->choice.threshold = values.threshold;
	if (values.view == SHOW_SCENE && !*config->scene.view.camera)
		log_warning("state: %s: view is scene, but no camera looks at it; ignored",
			    config->state.file);
	else
		k->what = (enum config_show)values.view;
	if ((uint32_t)values.pose >= k->basis.info.poses)
		log_warning("state: %s: pose is %d, expected 0..%u as in the basis; ignored",
			    config->state.file, values.pose, k->basis.info.poses - 1);
	else
		kiosk_take_pose(k, values.pose);
}

static int open_state(struct kiosk *k, struct fault *fault)
{
	const struct state_values values = {k->choice.threshold, k->what, k->choice.pose};
	int err = state_create(&k->state, &k->config->state, &values);

	return err ? fault_say(fault, err, "state: cannot be kept: %s", strerror(-err)) : 0;
}

static int open_pipeline(struct kiosk *k, struct fault *fault)
{
	struct pipeline_settings settings = pipeline_settings_of(k->config);
	int err = pipeline_create(&k->pipeline, &k->basis, &settings, fault);

	if (err)
		return err;
	return pipeline_choose(&k->pipeline, &k->choice, fault); /* is there such a pose? */
}

int kiosk_open(struct kiosk *k, struct fault *fault)
{
	const struct config *config = k->config;
	int err;

	k->loop.epoll = k->loop.signals = k->loop.timer = k->loop.terminal = -1;
	k->choice = (struct pipeline_choice){
		.threshold = config->lights.threshold, .pose = config->basis.pose, .object = true};
	k->what = (enum config_show)config->screen->show;
	k->split = config->screen->split;
	k->information = config->screen->information;
	service_start(&k->service);
	err = pipeline_open_basis(&k->basis, config->basis.file, pipeline_part_of(config), fault);
	if (!err)
		err = loop_open(&k->loop, fault); /* before any thread: they inherit its signals */
	if (!err)
		err = open_pipeline(k, fault);
	if (err)
		return err;
	kiosk_take_pose(k, config->basis.pose);
	take_state(k);
	err = open_state(k, fault);
	if (!err)
		err = stats_open(&k->stats, k->settings->stats, fault);
	if (!err)
		err = kiosk_control_open(k, true, fault); /* a second kiosk ends here */
	if (!err)
		err = kiosk_buttons_open(k, true, fault);
	return err ? err : create_sources(k, fault);
}

int kiosk_close(struct kiosk *k, struct fault *fault)
{
	int err = display_close(&k->display, fault);

	kiosk_control_close(k);
	kiosk_buttons_close(k);
	for (int i = 0; i < k->source_count; i++)
		source_destroy(&k->sources[i]);
	stats_close(&k->stats);
	state_destroy(k->state);
	overlay_free(&k->overlay);
	show_free(&k->show);
	pipeline_destroy(&k->pipeline);
	loop_close(&k->loop);
	basis_close(&k->basis);
	return err;
}
