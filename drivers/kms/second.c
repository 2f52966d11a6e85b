/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <errno.h>
#include <string.h>

#include "hal/base/log.h"

/* The whole framebuffer, scaled as the screen has room; or as it is, in the middle. */
static void state_aim(struct kms_state *state, const drmModeModeInfo *mode, int width, int height,
		      bool scaled)
{
	const struct kms_box box =
		scaled ? kms_fit_box(width, height, 1, mode->hdisplay, mode->vdisplay)
		       : (struct kms_box){(mode->hdisplay - width) / 2,
					  (mode->vdisplay - height) / 2, width, height};
	const uint64_t source[4] = {0, 0, (uint64_t)width << 16, (uint64_t)height << 16};
	const uint64_t target[4] = {(uint64_t)box.x, (uint64_t)box.y, (uint64_t)box.width,
				    (uint64_t)box.height};

	memcpy(state->plane_source, source, sizeof(source));
	memcpy(state->plane_target, target, sizeof(target));
}

static int second_commit(struct kms_second *second, const struct kms_state *state, uint32_t flags)
{
	return kms_state_commit(&second->path, &second->properties, state,
				flags | DRM_MODE_ATOMIC_ALLOW_MODESET);
}

/* A card that does not scale may still show the picture as it is, where the screen is not
 * smaller. */
static int second_aim(struct kms_second *second, const drmModeModeInfo *first)
{
	const drmModeModeInfo *mode = &second->path.mode;
	const int width = first->hdisplay, height = first->vdisplay;
	int err;

	state_aim(&second->ours, mode, width, height, true);
	err = second_commit(second, &second->ours, DRM_MODE_ATOMIC_TEST_ONLY);
	if (!err || width > mode->hdisplay || height > mode->vdisplay)
		return err;
	state_aim(&second->ours, mode, width, height, false);
	return second_commit(second, &second->ours, DRM_MODE_ATOMIC_TEST_ONLY);
}

static void second_complain(const struct kms_second *second, int err)
{
	const drmModeModeInfo *mode = &second->path.mode;

	log_warning_paced(
		"kms display: the second screen at %s stays dark: the card cannot show the first one's picture at its %ux%u: %s",
		second->path.connector_name, mode->hdisplay, mode->vdisplay, strerror(-err));
}

/* What was found is read once: later it is the driver's own. */
static int second_read(struct kms_second *second, struct fault *fault)
{
	struct kms_state now = {0};
	int err = kms_state_read(&second->path, &second->properties, &now, fault);

	if (err || second->kept) {
		kms_state_forget(second->path.card, &now);
		return err;
	}
	second->before = now;
	second->kept = true;
	second->connector.link_property = second->properties.connector_link;
	return 0;
}

static int second_set(struct kms_second *second, const drmModeModeInfo *first, uint32_t framebuffer)
{
	const struct kms_path *path = &second->path;
	uint32_t blob = 0;
	int err;

	err = drmModeCreatePropertyBlob(path->card, &path->mode, sizeof(path->mode), &blob);
	if (err)
		return err;
	second->ours = (struct kms_state){
		.connector_crtc = path->crtc,
		.connector_link = DRM_MODE_LINK_STATUS_GOOD,
		.connector_range = second->before.connector_range,
		.crtc_active = 1,
		.crtc_mode = blob,
		.plane_fb = framebuffer,
		.plane_crtc = path->crtc,
	};
	kms_state_uncover(path, &second->ours);
	err = second_aim(second, first);
	return err ? err : second_commit(second, &second->ours, 0);
}

void kms_second_show(struct kms_second *second, const struct kms_options *options,
		     const struct kms_path *first, uint32_t framebuffer)
{
	struct fault fault = {""};
	int err;

	if (second->shown || !options->second[0])
		return;
	err = kms_find_second(options, first, &second->path, &fault);
	second->connector.id = second->path.connector;
	if (!err)
		err = second_read(second, &fault);
	if (err) {
		if (err != -ENOLINK)
			log_warning_paced("%s; the second screen stays dark", fault.text);
		return;
	}
	err = second_set(second, &first->mode, framebuffer);
	second->shown = !err;
	if (!err) {
		log_info_paced("kms display: %s shows the same, at %dx%d",
			       second->path.connector_name, second->path.mode.hdisplay,
			       second->path.mode.vdisplay);
		return;
	}
	kms_state_forget(second->path.card, &second->ours);
	second_complain(second, err);
}

void kms_second_hide(struct kms_second *second)
{
	const struct kms_state dark = {.connector_link = DRM_MODE_LINK_STATUS_GOOD,
				       .connector_range = second->before.connector_range};

	if (!second->shown)
		return;
	(void)second_commit(second, &dark, 0); /* a card that is gone shows nothing either */
	kms_state_forget(second->path.card, &second->ours);
	second->shown = false;
}

/* Whether the screen that is shown is as it was when its mode was set. */
static bool second_is_same(const struct kms_second *second)
{
	const struct kms_connector *now = &second->connector;

	if (now->connection == DRM_MODE_DISCONNECTED || now->link_failed)
		return false;
	for (int i = 0; i < now->count; i++)
		if (kms_mode_same(&now->modes[i], &second->path.mode))
			return true;
	return false;
}

void kms_second_look(struct kms_second *second, const struct kms_options *options,
		     const struct kms_path *first, uint32_t framebuffer, bool probe)
{
	const unsigned known = second->connector.connection;
	int err;

	if (!options->second[0])
		return;
	err = second->connector.id ? kms_connector_read(first->card, second->connector.id, probe,
							&second->connector)
				   : -ENOENT;
	if (err == -E2BIG)
		return;
	if (second->shown && (err || !second_is_same(second))) {
		log_warning_paced(
			"kms display: the second screen at %s was unplugged, is off or has other modes now",
			second->path.connector_name);
		kms_second_hide(second);
	}
	if (!second->shown && (probe || (!err && second->connector.connection != known)))
		kms_second_show(second, options, first, framebuffer);
}

void kms_second_release(struct kms_second *second)
{
	kms_second_hide(second);
	if (second->kept) {
		(void)second_commit(second, &second->before, 0);
		kms_state_forget(second->path.card, &second->before);
	}
	second->kept = false;
}
