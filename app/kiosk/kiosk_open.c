/* SPDX-License-Identifier: MIT */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "app/pipeline/pipeline_config.h"
#include "drivers/drivers.h"
#include "hal/base/log.h"
#include "hal/base/output.h"

static struct source *source_named(struct kiosk_inputs *in, const char *name)
{
	for (int i = 0; i < in->source_count; i++) {
		if (!strcmp(in->sources[i].settings.name, name))
			return &in->sources[i];
	}
	return NULL;
}

static struct eye eye_of(struct kiosk_inputs *in, const char *section,
			 const struct config_view *view)
{
	return (struct eye){
		.section = section,
		.source = source_named(in, view->camera),
		.wanted = view->view,
	};
}

/* Whether a view looks through this camera; others stay closed. */
static bool is_watched(const struct config *config, const char *camera)
{
	return !strcmp(config->fisheye.view.camera, camera) ||
	       !strcmp(config->background.view.camera, camera) ||
	       !strcmp(config->scene.view.camera, camera) ||
	       !strcmp(config->depth.view.camera, camera);
}

static int create_source(struct kiosk_inputs *in, const struct config *config,
			 struct config_camera *camera, bool resting, struct fault *fault)
{
	int driver = config_driver_index(config, CONFIG_CAMERA, camera->driver);
	struct source *source = &in->sources[in->source_count];
	struct source_settings settings = {
		.name = camera->name,
		.ops = camera_drivers[driver],
		.camera = config_camera_settings(config, camera),
		.options = config_options(config, CONFIG_CAMERA, camera, driver),
		.deinterlace = (enum deinterlace)camera->deinterlace,
		.turn = (enum picture_turn)camera->turn,
		.curve = kiosk_curve_for(config, camera->name),
	};
	int err = source_create(source, &settings);

	if (err)
		return fault_say(fault, err, "camera %s: cannot be set up: %s", camera->name,
				 strerror(-err));
	in->source_count++;
	source_rest(source, resting);
	source_open(source);
	return 0;
}

static int create_sources(struct kiosk_inputs *in, struct config *config, bool resting,
			  struct fault *fault)
{
	for (int i = 0; i < config->camera_count; i++) {
		struct config_camera *camera = config->cameras[i];
		int err;

		if (!is_watched(config, camera->name)) {
			log_info("camera %s: no view names it, it stays closed", camera->name);
			continue;
		}
		err = create_source(in, config, camera, resting, fault);
		if (err)
			return err;
	}
	in->eyes.fisheye = eye_of(in, "fisheye", &config->fisheye.view);
	exposing_start(&in->exposing, &config->fisheye);
	in->eyes.background = eye_of(in, "background", &config->background.view);
	in->eyes.scene = eye_of(in, "scene", &config->scene.view);
	in->eyes.depth = eye_of(in, "depth", &config->depth.view);
	return 0;
}

/* Takes what was chosen before a power cut, in place of the configuration's choice. Faults in the
 * file are logged and do not keep the kiosk from starting. */
static void take_state(struct kiosk *k)
{
	const struct config *config = k->config;
	struct state_values values = kiosk_chosen(&k->controls);
	struct output probe = {.stream = NULL};
	struct fault fault = {.text = ""};
	int err;

	if (!*config->state.file)
		return;
	err = state_read(config->state.file, &values, &fault);
	if (err && err != -ENOENT)
		log_warning("state: %s; the configuration counts", fault.text);
	/* A file that cannot be written is reported now, not months later when somebody chooses
	 * something. */
	if (output_open(&probe, config->state.file, &fault))
		log_warning("state: %s; what is chosen cannot be kept", fault.text);
	output_abandon(&probe);
	k->controls.choice.threshold = values.threshold;
	if (values.view == SHOW_SCENE && !*config->scene.view.camera)
		log_warning("state: %s: view is scene, but no camera looks at it; ignored",
			    config->state.file);
	else
		k->controls.view = (enum config_show)values.view;
	if ((uint32_t)values.pose >= k->picture.basis->info.poses)
		log_warning("state: %s: pose is %d, expected 0..%u as in the basis; ignored",
			    config->state.file, values.pose, k->picture.basis->info.poses - 1);
	else
		kiosk_take_pose(k, values.pose);
}

static int open_state(struct kiosk *k, struct fault *fault)
{
	const struct state_values values = kiosk_chosen(&k->controls);
	int err = keeper_create(&k->controls.keeper);

	if (!err)
		err = state_create(&k->controls.state, k->controls.keeper, &k->config->state,
				   &values);
	if (!err)
		err = learned_create(&k->controls.learned, k->controls.keeper, &k->config->state);
	if (err)
		return fault_say(fault, err, "state: cannot be kept: %s", strerror(-err));
	learned_restore(k->controls.learned, k->picture.pipeline);
	return 0;
}

static int open_pipeline(struct kiosk *k, struct fault *fault)
{
	struct pipeline_settings settings = pipeline_settings_of(k->config);
	int err = pipeline_create(&k->picture.pipeline, k->picture.basis, &settings, fault);

	if (err)
		return err;
	/* Fails where the basis has no such pose. */
	return pipeline_choose(k->picture.pipeline, &k->controls.choice, fault);
}

int kiosk_open(struct kiosk *k, struct fault *fault)
{
	const struct config *config = k->config;
	int err;

	k->loop.epoll = k->loop.signals = k->loop.timer = k->loop.terminal = -1;
	k->controls.choice = (struct pipeline_choice){
		.threshold = config->lights.threshold, .pose = config->basis.pose, .object = true};
	k->controls.view = (enum config_show)config->screen->show;
	k->controls.split = config->screen->split;
	k->controls.information = config->screen->information;
	/* Before any thread is started, which might read the environment meanwhile. */
	if (*config->screen->time_zone)
		setenv("TZ", config->screen->time_zone, 1);
	service_start(&k->service);
	err = kiosk_basis_open(&k->picture.basis, &k->picture.basis_file, config->basis.file,
			       pipeline_part_of(config), fault);
	/* Before any thread is started: threads inherit the blocked signals. */
	if (!err)
		err = loop_open(&k->loop, fault);
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
		err = kiosk_control_open(k, true, fault); /* fails where another kiosk runs */
	if (!err)
		err = kiosk_buttons_open(k, true, fault);
	if (err)
		return err;
	kiosk_rest_begin(k);
	return create_sources(&k->inputs, k->config, k->rest.resting, fault);
}

int kiosk_close(struct kiosk *k, struct fault *fault)
{
	int err = display_close(&k->screen.display, fault);

	kiosk_reload_close(k);
	kiosk_control_close(k);
	kiosk_buttons_close(k);
	for (int i = 0; i < k->inputs.source_count; i++)
		source_destroy(&k->inputs.sources[i]);
	stats_close(&k->stats);
	state_destroy(k->controls.state);
	learned_destroy(k->controls.learned, k->picture.pipeline);
	keeper_destroy(k->controls.keeper);
	overlay_free(&k->picture.overlay);
	show_free(&k->picture.show);
	pipeline_destroy(k->picture.pipeline);
	loop_close(&k->loop);
	kiosk_basis_close(k->picture.basis);
	return err;
}
