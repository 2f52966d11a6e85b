/* SPDX-License-Identifier: MIT */
/* SIGHUP: reads the configuration again and opens the statistics' file again, while the kiosk goes
 * on. */
#include <errno.h>
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "app/kiosk/reload.h"
#include "app/pipeline/pipeline_config.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

/* A basis that takes the place of the one in use. NULL: that stays. */
struct fresh_basis {
	struct basis *basis;
	struct stat file;
};

/* Whether the file that the configuration names is another than the one in use. One that has gone
 * is none, unless the configuration names it anew. */
static bool is_other_file(const struct kiosk *k, const struct config *fresh)
{
	const struct stat *before = &k->picture.basis_file;
	struct stat now;

	if (strcmp(fresh->basis.file, k->config->basis.file) != 0)
		return true;
	return stat(fresh->basis.file, &now) == 0 &&
	       (now.st_dev != before->st_dev || now.st_ino != before->st_ino ||
		now.st_size != before->st_size || now.st_mtim.tv_sec != before->st_mtim.tv_sec ||
		now.st_mtim.tv_nsec != before->st_mtim.tv_nsec);
}

/* Opens another basis, with the layers of the mode in force. Pictures of another size would fit
 * neither the cameras' nor the screen. Logs each fault. */
static int open_fresh_basis(const struct kiosk *k, const struct config *fresh,
			    struct fresh_basis *to)
{
	const struct basis_info_chunk *old = &k->picture.basis->info;
	struct fault fault = {.text = ""};
	int err;

	if (!is_other_file(k, fresh))
		return 0;
	err = kiosk_basis_open(&to->basis, &to->file, fresh->basis.file,
			       pipeline_part_of(k->config), &fault);
	if (!err && (to->basis->info.width != old->width || to->basis->info.height != old->height))
		err = fault_say(&fault, -EINVAL, "%s: is of %ux%u pixels, expected %ux%u as before",
				fresh->basis.file, to->basis->info.width, to->basis->info.height,
				old->width, old->height);
	if (err)
		log_error("%s: [basis] file: %s", fresh->name, fault.text);
	return err;
}

/* Checks what only the running kiosk knows. Logs each fault. */
static int check_fresh(const struct kiosk *k, const struct config *fresh, const struct basis *basis)
{
	struct fault fault = {.text = ""};
	int err = pipeline_config_check(fresh, basis);

	if (fresh->screen->show == SHOW_SCENE && !k->inputs.eyes.scene.source) {
		log_error("%s: [screen] show: is scene, whose camera is not open", fresh->name);
		err = -EINVAL;
	}
	if (pipeline_check_lens(k->picture.pipeline, &fresh->fisheye.lens, &fault)) {
		log_error("%s: %s", fresh->name, fault.text);
		err = -EINVAL;
	}
	return err;
}

/* Encodes each camera's linear radiance by the new curves. */
static void encode_sources(struct kiosk *k)
{
	for (int i = 0; i < k->inputs.source_count; i++) {
		const struct transfer_curve curve =
			kiosk_curve_for(k->config, k->inputs.sources[i].settings.name);

		source_encode_as(&k->inputs.sources[i], &curve);
	}
}

static int apply_light(struct kiosk *k, struct fault *fault)
{
	struct pipeline_settings settings = pipeline_settings_of(k->config);

	encode_sources(k);
	return pipeline_relight(k->picture.pipeline, &settings, fault);
}

static int apply_pipeline(struct kiosk *k, struct fault *fault)
{
	struct pipeline_settings settings = pipeline_settings_of(k->config);
	int err = pipeline_change(k->picture.pipeline, &settings, fault);

	if (!err)
		encode_sources(k);
	return err;
}

/* Takes another basis, whose light is measured at once, unless the picture's exposure is one of
 * several. Memory or threads may not suffice: then the one before stays until the next reload. */
static int apply_basis(struct kiosk *k, struct fresh_basis *fresh, struct fault *fault)
{
	const struct pipeline_settings settings = pipeline_settings_of(k->config);
	struct kiosk_picture *picture = &k->picture;
	struct pipeline *pipeline;
	int err = pipeline_create(&pipeline, fresh->basis, &settings, fault);

	if (err)
		return err;
	pipeline_destroy(picture->pipeline);
	kiosk_basis_close(picture->basis);
	picture->pipeline = pipeline;
	picture->basis = fresh->basis;
	picture->basis_file = fresh->file;
	fresh->basis = NULL;
	memset(picture->pose_said, 0, sizeof(picture->pose_said));
	if ((uint32_t)k->controls.choice.pose >= picture->basis->info.poses)
		k->controls.choice.pose = k->config->basis.pose;
	kiosk_take_pose(k, k->controls.choice.pose);
	if (settings.exposures > 1)
		pipeline_expose(pipeline, -1, k->inputs.exposing.ratio);
	else if (picture->begun)
		err = kiosk_measure_light(&k->inputs, picture, fault);
	picture->redraw = true;
	log_info("basis of %u lights, %u pose%s%s", picture->basis->info.lights,
		 picture->basis->info.poses, picture->basis->info.poses == 1 ? "" : "s",
		 basis_is_preview(picture->basis) ? ", a preview" : "");
	return err;
}

/* Returns the effects that failed for want of memory or threads; they are owed to the next
 * reload. */
static unsigned apply_effects(struct kiosk *k, unsigned effects)
{
	const struct config *config = k->config;
	struct fault fault = {.text = ""};
	unsigned owed = 0;

	if (effects & RELOAD_PIPELINE && apply_pipeline(k, &fault)) {
		log_error("reload: %s", fault.text);
		owed |= RELOAD_PIPELINE | RELOAD_DRAWING;
	}
	if (effects & RELOAD_LIGHT && apply_light(k, &fault)) {
		log_error("reload: %s", fault.text);
		owed |= RELOAD_LIGHT | RELOAD_DRAWING;
	}
	if (effects & RELOAD_THRESHOLD)
		k->controls.choice.threshold = config->lights.threshold;
	if (effects & RELOAD_POSE)
		kiosk_take_pose(k, config->basis.pose);
	if (effects & RELOAD_POSES)
		kiosk_take_pose(k, k->controls.choice.pose);
	if (effects & RELOAD_VIEW)
		k->controls.view = (enum config_show)config->screen->show;
	if (effects & RELOAD_SPLIT)
		k->controls.split = config->screen->split;
	if (effects & RELOAD_INFORMATION)
		k->controls.information = config->screen->information;
	if (effects & RELOAD_HOURS)
		rest_take_hours(&k->rest, config->screen->hours);
	if (effects & RELOAD_STATE)
		state_move(k->controls.state, &config->state);
	if (effects & RELOAD_STATE)
		learned_move(k->controls.learned, &config->state);
	/* Has effect where people are looked for anew. */
	learned_restore(k->controls.learned, k->picture.pipeline);
	if (effects & (RELOAD_THRESHOLD | RELOAD_POSE | RELOAD_VIEW))
		kiosk_keep_state(&k->controls);
	/* first is false: what cannot be opened now is tried again later. */
	(void)kiosk_control_open(k, false, NULL);
	(void)kiosk_buttons_open(k, false, NULL);
	kiosk_text(k);
	k->picture.redraw |= (effects & RELOAD_DRAWING) != 0;
	return owed;
}

static int reload_config(struct kiosk *k)
{
	const struct kiosk_settings *settings = k->settings;
	struct ini_report report = {.count = 0};
	struct fresh_basis basis = {.basis = NULL};
	struct fault fault = {.text = ""};
	struct config *fresh;
	unsigned effects;
	int err = settings->reread(settings->context, &fresh, &report);

	if (err)
		return err; /* every fault has been logged */
	err = open_fresh_basis(k, fresh, &basis);
	if (!err)
		err = check_fresh(k, fresh, basis.basis ? basis.basis : k->picture.basis);
	if (err) {
		kiosk_basis_close(basis.basis);
		config_destroy(fresh);
		return err;
	}
	effects = reload_compare(k->config, fresh) | k->owed;
	/* Drivers borrow values of the configuration, which must not change under them. */
	if (effects & RELOAD_BUTTONS)
		kiosk_buttons_close(k);
	if (effects & RELOAD_CONTROL)
		kiosk_control_close(k);
	reload_adopt(k->config, fresh);
	config_destroy(fresh);
	k->owed = 0;
	if (basis.basis && apply_basis(k, &basis, &fault)) {
		log_error("reload: %s", fault.text);
		k->owed = RELOAD_DRAWING;
	}
	kiosk_basis_close(basis.basis);
	k->owed |= apply_effects(k, effects);
	return 0;
}

void kiosk_reload(struct kiosk *k)
{
	int err;

	service_reloading(&k->service, clock_now_ns());
	stats_reopen(&k->stats);
	err = reload_config(k);
	if (err)
		log_error("the configuration %s; the old one stays",
			  err == -EINVAL ? "is wrong" : "cannot be read");
	else if (k->owed)
		log_error("the configuration has been read again, but not all of it is in force: "
			  "reload it once more");
	else
		log_info("the configuration has been read again");
	service_reloaded(&k->service);
}
