/* SPDX-License-Identifier: MIT */
/* SIGHUP: reads the configuration again and opens the statistics' file again, while the kiosk goes
 * on. A thread reads what may take long: the configuration, its mask, another basis with a pose and
 * what measures its light. */
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "app/kiosk/kiosk_parts.h"
#include "app/kiosk/reload.h"
#include "app/pipeline/pipeline_config.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

struct reading {
	pthread_t thread;
	int done;    /* eventfd; readable: the thread has ended */
	bool repeat; /* another SIGHUP has come meanwhile */
	/* The thread reads of it what stays as it is until the thread has ended: settings,
	 * configuration in force, basis. */
	const struct kiosk *kiosk;
	int pose;			   /* chosen at SIGHUP */
	int fisheye_width, fisheye_height; /* of its pictures; 0 0: none has come */
	/* What the thread has read: */
	int err;
	struct config *fresh;
	unsigned effects;    /* enum reload_effect */
	uint8_t *mask;	     /* of [people]; NULL: none */
	struct basis *basis; /* that takes the place of the one in use; NULL: that stays */
	struct stat basis_file;
	struct pipeline *pipeline; /* of this basis; it has a pose in memory */
};

/* ---- what the thread does ---- */

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
static int reading_open_basis(struct reading *r)
{
	const struct kiosk *k = r->kiosk;
	const struct basis_info_chunk *old = &k->picture.basis->info;
	struct fault fault = {.text = ""};
	int err;

	if (!is_other_file(k, r->fresh))
		return 0;
	err = kiosk_basis_open(&r->basis, &r->basis_file, r->fresh->basis.file,
			       pipeline_part_of(k->config), &fault);
	if (!err && (r->basis->info.width != old->width || r->basis->info.height != old->height))
		err = fault_say(&fault, -EINVAL, "%s: is of %ux%u pixels, expected %ux%u as before",
				r->fresh->basis.file, r->basis->info.width, r->basis->info.height,
				old->width, old->height);
	if (err)
		log_error("%s: [basis] file: %s", r->fresh->name, fault.text);
	return err;
}

/* Checks what only the running kiosk knows. Logs each fault. */
static int reading_check(struct reading *r)
{
	const struct config *fresh = r->fresh;
	const struct basis *basis = r->basis ? r->basis : r->kiosk->picture.basis;
	struct fault fault = {.text = ""};
	struct fisheye lens;
	int err = pipeline_config_check(fresh, basis, &r->mask);

	if (fresh->screen->show == SHOW_SCENE && !r->kiosk->inputs.eyes.scene.source) {
		log_error("%s: [screen] show: is scene, whose camera is not open", fresh->name);
		err = -EINVAL;
	}
	if (r->fisheye_width && fisheye_prepare(&lens, &fresh->fisheye.lens, r->fisheye_width,
						r->fisheye_height, &fault)) {
		log_error("%s: %s", fresh->name, fault.text);
		err = -EINVAL;
	}
	return err;
}

/* Makes the pipeline of another basis, which has to show a pose: its file may be cut or copied over
 * at any time afterwards. fresh has the settings that will be in force. */
static int reading_make_pipeline(struct reading *r)
{
	const struct config *fresh = r->fresh;
	struct pipeline_settings settings = pipeline_settings_of(fresh);
	const bool stays = !(r->effects & RELOAD_POSE) && (uint32_t)r->pose < r->basis->info.poses;
	const struct pipeline_choice choice = {.threshold = fresh->lights.threshold,
					       .pose = stays ? r->pose : fresh->basis.pose,
					       .object = true};
	struct fault fault = {.text = ""};
	int err;

	settings.mask_pixels = r->mask;
	err = pipeline_create(&r->pipeline, r->basis, &settings, &fault);
	if (!err)
		err = pipeline_choose(r->pipeline, &choice, &fault);
	if (!err && r->fisheye_width)
		err = pipeline_light_prepare(r->pipeline, r->fisheye_width, r->fisheye_height, true,
					     &fault);
	if (err)
		log_error("%s: [basis] file: %s", fresh->name, fault.text);
	return err;
}

static int reading_read(struct reading *r)
{
	const struct kiosk_settings *settings = r->kiosk->settings;
	struct ini_report report = {.count = 0};
	int err = settings->reread(settings->context, &r->fresh, &report);

	if (!err) /* else every fault has been logged */
		err = reading_open_basis(r);
	if (!err)
		err = reading_check(r);
	if (err)
		return err;
	r->effects = reload_compare(r->kiosk->config, r->fresh);
	reload_keep(r->fresh, r->kiosk->config);
	return r->basis ? reading_make_pipeline(r) : 0;
}

static void *reading_run(void *context)
{
	struct reading *r = context;

	r->err = reading_read(r);
	(void)eventfd_write(r->done, 1);
	return NULL;
}

/* ---- what the kiosk takes ---- */

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

static int apply_pipeline(struct kiosk *k, const uint8_t *mask, struct fault *fault)
{
	struct pipeline_settings settings = pipeline_settings_of(k->config);
	int err;

	settings.mask_pixels = mask;
	err = pipeline_change(k->picture.pipeline, &settings, fault);
	if (!err)
		encode_sources(k);
	return err;
}

/* Takes another basis, whose light is measured at once, unless the picture's exposure is one of
 * several. */
static void apply_basis(struct kiosk *k, struct reading *r)
{
	struct kiosk_picture *picture = &k->picture;

	pipeline_destroy(picture->pipeline);
	kiosk_basis_close(picture->basis);
	picture->pipeline = r->pipeline;
	picture->basis = r->basis;
	picture->basis_file = r->basis_file;
	r->pipeline = NULL;
	r->basis = NULL;
	memset(picture->pose_said, 0, sizeof(picture->pose_said));
	if ((uint32_t)k->controls.choice.pose >= picture->basis->info.poses)
		k->controls.choice.pose = k->config->basis.pose;
	kiosk_take_pose(k, k->controls.choice.pose);
	encode_sources(k);
	if (k->inputs.exposing.count > 1)
		pipeline_expose(picture->pipeline, -1, k->inputs.exposing.ratio);
	else if (picture->begun)
		(void)kiosk_measure_light(&k->inputs, picture, NULL); /* an error is logged */
	picture->redraw = true;
	log_info("basis of %u lights, %u pose%s%s", picture->basis->info.lights,
		 picture->basis->info.poses, picture->basis->info.poses == 1 ? "" : "s",
		 basis_is_preview(picture->basis) ? ", a preview" : "");
}

/* Returns the effects that failed for want of memory or threads; they are owed to the next
 * reload. */
static unsigned apply_effects(struct kiosk *k, unsigned effects, const uint8_t *mask)
{
	const struct config *config = k->config;
	struct fault fault = {.text = ""};
	unsigned owed = 0;

	if (effects & RELOAD_PIPELINE && apply_pipeline(k, mask, &fault)) {
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

static void take_config(struct kiosk *k, struct reading *r)
{
	unsigned effects = r->effects | k->owed;

	/* Drivers borrow values of the configuration, which must not change under them. */
	if (effects & RELOAD_BUTTONS)
		kiosk_buttons_close(k);
	if (effects & RELOAD_CONTROL)
		kiosk_control_close(k);
	reload_adopt(k->config, r->fresh);
	if (r->basis) { /* its pipeline has the new settings */
		apply_basis(k, r);
		effects &= ~(unsigned)(RELOAD_PIPELINE | RELOAD_LIGHT);
	}
	k->owed = apply_effects(k, effects, r->mask);
}

static void reading_free(struct reading *r)
{
	pipeline_destroy(r->pipeline);
	kiosk_basis_close(r->basis);
	config_destroy(r->fresh);
	free(r->mask);
	if (r->done >= 0)
		close(r->done);
	free(r);
}

void kiosk_reload_close(struct kiosk *k)
{
	if (!k->reading)
		return;
	pthread_join(k->reading->thread, NULL);
	(void)loop_watch(&k->loop, SLOT_READING, -1, NULL);
	reading_free(k->reading);
	k->reading = NULL;
}

static int reading_begin(struct kiosk *k)
{
	struct reading *r = calloc(1, sizeof(*r));
	int err = 0;

	if (!r)
		return -ENOMEM;
	r->kiosk = k;
	r->pose = k->controls.choice.pose;
	pipeline_lens_size(k->picture.pipeline, &r->fisheye_width, &r->fisheye_height);
	r->done = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	if (r->done < 0)
		err = -errno;
	if (!err)
		err = loop_watch(&k->loop, SLOT_READING, r->done, NULL);
	if (!err)
		err = -pthread_create(&r->thread, NULL, reading_run, r);
	if (!err) {
		k->reading = r;
		return 0;
	}
	(void)loop_watch(&k->loop, SLOT_READING, -1, NULL);
	reading_free(r);
	return err;
}

static void say_outcome(const struct kiosk *k, int err)
{
	if (err)
		log_error("the configuration %s; the old one stays",
			  err == -EINVAL ? "is wrong" : "cannot be read");
	else if (k->owed)
		log_error(
			"the configuration has been read again, but not all of it is in force: reload it once more");
	else
		log_info("the configuration has been read again");
}

void kiosk_reload_take(struct kiosk *k)
{
	struct reading *r = k->reading;
	const bool repeat = r->repeat;

	pthread_join(r->thread, NULL);
	if (!r->err)
		take_config(k, r);
	say_outcome(k, r->err);
	(void)loop_watch(&k->loop, SLOT_READING, -1, NULL);
	reading_free(r);
	k->reading = NULL;
	service_reloaded(&k->service);
	if (repeat)
		kiosk_reload(k);
}

void kiosk_reload(struct kiosk *k)
{
	int err;

	stats_reopen(&k->stats);
	if (k->reading) {
		k->reading->repeat = true;
		return;
	}
	service_reloading(&k->service, clock_now_ns());
	err = reading_begin(k);
	if (!err)
		return;
	say_outcome(k, err);
	service_reloaded(&k->service);
}
