/* SPDX-License-Identifier: MIT */
#include "app/pipeline/pipeline_config.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/base/log.h"

/* Tells the background's camera and view, in which a place has its pixels. */
static void name_camera(const struct config *config, char text[PIPELINE_CAMERA_MAX])
{
	const struct config_view *view = &config->background.view;
	const struct config_camera *camera = config_camera_named(config, view->camera);

	snprintf(text, PIPELINE_CAMERA_MAX, "%s %s %s %d %d %d,%d %dx%d %d %d", view->camera,
		 camera ? camera->driver : "", camera ? camera->settings.device : "",
		 camera ? camera->turn : 0, camera ? camera->deinterlace : 0, view->view.x,
		 view->view.y, view->view.width, view->view.height, view->view.hflip,
		 view->view.vflip);
}

struct pipeline_settings pipeline_settings_of(const struct config *config)
{
	struct pipeline_settings settings = {
		.sampler = {.placed = true,
			    .curve = config_fisheye_curve(&config->fisheye),
			    .gain = response_gain(&config->fisheye.measured, config->fisheye.gain)},
		.lens = config->fisheye.lens,
		.follow_ns = (int64_t)(config->lights.follow_s * (double)NS_PER_S),
		.threshold_mode = (enum threshold_mode)config->lights.threshold_mode,
		.background = config_background_curve(&config->background),
		.gain = config->composite.gain,
		.threads = config->composite.threads,
		.mode = (enum compositor_mode)config->composite.mode,
		.lamps = config->lamps,
		.occlude = config->people.occlude,
		.depth_camera = config->depth.camera,
		.follow_exposure = config->composite.follow_exposure,
		.neutral = config->composite.neutral_percent / 100,
		.grain = config->composite.grain,
	};

	settings.exposures = config_exposures(&config->fisheye);
	for (int k = 0; k < settings.exposures; k++)
		settings.exposure[k] = config->fisheye.exposures[k] / config->fisheye.exposures[0];
	settings.patch = (struct pipeline_patch){
		.x = (int)config->background.patch[0],
		.y = (int)config->background.patch[1],
		.width = (int)config->background.patch[2],
		.height = (int)config->background.patch[3],
	};
	memcpy(settings.patch.reflectance, config->background.reflectance,
	       sizeof(settings.patch.reflectance));
	memcpy(settings.sampler.colours, config->fisheye.measured.colours,
	       sizeof(settings.sampler.colours));
	name_camera(config, settings.camera);
	snprintf(settings.mask, sizeof(settings.mask), "%s", config->people.mask);
	snprintf(settings.kernel, sizeof(settings.kernel), "%s", config->composite.kernel);
	_Static_assert(sizeof(settings.lamp_name) == sizeof(config->lamp_name), "names fit");
	memcpy(settings.lamp_name, config->lamp_name, sizeof(settings.lamp_name));
	return settings;
}

enum basis_part pipeline_part_of(const struct config *config)
{
	return config->composite.mode == COMPOSITOR_EXACT ? BASIS_WITH_EXACT : BASIS_SHOWN;
}

int pipeline_open_basis(struct basis *basis, const char *path, enum basis_part part,
			struct fault *fault)
{
	struct fault reason = {.text = ""};
	const int err = basis_open(basis, path, part, &reason);

	if (err == -ENODATA)
		return fault_say(fault, err, "%s: inlay-bake render --exact", reason.text);
	return err ? fault_say(fault, err, "%s", reason.text) : 0;
}

static int check_config_pose(const struct config *config, const struct basis *basis)
{
	if ((uint32_t)config->basis.pose < basis->info.poses)
		return 0;
	log_error("%s: [basis] pose: is %d, expected 0..%u, the poses that the file holds",
		  config->name, config->basis.pose, basis->info.poses - 1);
	return -EINVAL;
}

static int check_config_patch(const struct config *config, const struct basis *basis)
{
	const struct pipeline_settings settings = pipeline_settings_of(config);
	struct fault fault = {.text = ""};
	const int err = pipeline_check_patch(&settings.patch, basis, &fault);

	if (err)
		log_error("%s: %s", config->name, fault.text);
	return err;
}

static int check_config_mask(const struct config *config, const struct basis *basis, uint8_t **mask)
{
	struct fault fault = {.text = ""};
	const int err = pipeline_read_mask(config->people.mask, basis, mask, &fault);

	if (err)
		log_error("%s: %s", config->name, fault.text);
	return err;
}

/* The picture's size is known where the configuration names it. */
static int check_config_size(const struct config *config, const struct basis *basis)
{
	const struct config_camera *camera = config_camera_named(config,
								 config->background.view.camera);
	struct view view = config->background.view.view;

	if (!camera || !camera->settings.width || !camera->settings.height ||
	    view_resolve(&view, camera->settings.width, camera->settings.height, NULL) ||
	    ((uint32_t)view.width == basis->info.width &&
	     (uint32_t)view.height == basis->info.height))
		return 0;
	log_error(
		"%s: [background] the picture is %dx%d pixels, expected %ux%u as the basis was baked",
		config->name, view.width, view.height, basis->info.width, basis->info.height);
	return -EINVAL;
}

static int check_kernel(const struct config *config)
{
	if (compositor_has_kernel(config->composite.kernel))
		return 0;
	log_error(
		"%s: [composite] kernel: this processor has none called \"%s\", expected auto or one that inlay bench lists",
		config->name, config->composite.kernel);
	return -ENOTSUP;
}

int pipeline_config_check(const struct config *config, const struct basis *basis, uint8_t **mask)
{
	const int pose = basis ? check_config_pose(config, basis) : 0;
	const int patch = basis ? check_config_patch(config, basis) : 0;
	const int masked = basis ? check_config_mask(config, basis, mask) : 0;
	const int size = basis ? check_config_size(config, basis) : 0;
	const int kernel = check_kernel(config);

	return pose ? pose : patch ? patch : masked ? masked : size ? size : kernel;
}
