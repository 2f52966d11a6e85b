/* SPDX-License-Identifier: MIT */
#include "drivers/kms/kms.h"

#include <drm_fourcc.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xf86drm.h>

#include "hal/base/log.h"

int kms_screen_refused(const struct kms_screen *screen, int err, const char *what,
		       struct fault *fault)
{
	return fault_say(fault, err, "kms display: %s: cannot %s: %s", screen->path.connector_name,
			 what, strerror(-err));
}

int kms_screen_held(const struct kms_screen *screen, struct fault *fault)
{
	return fault_say(
		fault, -EBUSY,
		"kms display: another program (a desktop or another inlay) holds the screen %s: stop it (as root, fuser -v %s tells its name)",
		screen->path.connector_name, screen->path.device);
}

int kms_screen_become_master(struct kms_screen *screen, struct fault *fault)
{
	/* The first process to open a card becomes its master by that. A later one that is not root
	 * gets EACCES here, although the reason is that another program is master. */
	if (!drmIsMaster(screen->path.card) && drmSetMaster(screen->path.card))
		return kms_screen_held(screen, fault);
	screen->master = true;
	return 0;
}

/* ---- buffers ---- */

static int create_buffer(struct kms_screen *screen, struct kms_buffer *buffer)
{
	const int card = screen->path.card;
	struct drm_mode_create_dumb create = {
		.width = screen->path.mode.hdisplay,
		.height = screen->path.mode.vdisplay,
		.bpp = 32,
	};
	struct drm_mode_map_dumb map = {0};
	void *pixels;
	int err;

	if (drmIoctl(card, DRM_IOCTL_MODE_CREATE_DUMB, &create))
		return -errno;
	buffer->handle = map.handle = create.handle;
	buffer->stride = create.pitch;
	buffer->bytes = create.size;
	err = drmModeAddFB2(card, create.width, create.height, DRM_FORMAT_XRGB8888,
			    (uint32_t[4]){create.handle}, (uint32_t[4]){create.pitch},
			    (uint32_t[4]){0}, &buffer->framebuffer, 0);
	if (err)
		return err;
	if (drmIoctl(card, DRM_IOCTL_MODE_MAP_DUMB, &map))
		return -errno;
	pixels = mmap(NULL, create.size, PROT_READ | PROT_WRITE, MAP_SHARED, card,
		      (off_t)map.offset);
	if (pixels == MAP_FAILED)
		return -errno;
	buffer->map = pixels;
	buffer->fit = screen->fit;
	memset(buffer->map, 0, create.size);
	return 0;
}

static void destroy_buffer(struct kms_screen *screen, struct kms_buffer *buffer)
{
	struct drm_mode_destroy_dumb destroy = {.handle = buffer->handle};

	if (buffer->map)
		munmap(buffer->map, buffer->bytes);
	if (buffer->framebuffer)
		drmModeRmFB(screen->path.card, buffer->framebuffer);
	if (buffer->handle)
		drmIoctl(screen->path.card, DRM_IOCTL_MODE_DESTROY_DUMB, &destroy);
	*buffer = (struct kms_buffer){0};
}

/* ---- modes ---- */

void kms_screen_set_fit(struct kms_state *state, const struct kms_fit *fit)
{
	const uint64_t source[4] = {0, 0, (uint64_t)fit->width << 16, (uint64_t)fit->height << 16};
	/* The properties are signed 32-bit numbers; none of these is negative. */
	const uint64_t target[4] = {(uint64_t)fit->box.x, (uint64_t)fit->box.y,
				    (uint64_t)fit->box.width, (uint64_t)fit->box.height};

	memcpy(state->plane_source, source, sizeof(source));
	memcpy(state->plane_target, target, sizeof(target));
}

struct kms_fit kms_screen_whole(const struct kms_screen *screen)
{
	const int width = screen->path.mode.hdisplay, height = screen->path.mode.vdisplay;

	return (struct kms_fit){width, height, {0, 0, width, height}};
}

int kms_screen_set_mode(struct kms_screen *screen, int index, struct fault *fault)
{
	struct kms_state *ours = &screen->ours;
	int err;

	ours->plane_fb = screen->swap.buffers[index].framebuffer;
	kms_screen_set_fit(ours, &screen->swap.buffers[index].fit);
	kms_state_uncover(&screen->path, ours);
	err = kms_state_commit(&screen->path, &screen->properties, ours,
			       DRM_MODE_ATOMIC_TEST_ONLY | DRM_MODE_ATOMIC_ALLOW_MODESET);
	if (!err)
		err = kms_state_commit(&screen->path, &screen->properties, ours,
				       DRM_MODE_ATOMIC_ALLOW_MODESET);
	if (err)
		return kms_screen_refused(screen, err, "set the mode", fault);
	screen->set = true;
	screen->swap.shown = index;
	return 0;
}

int kms_screen_set_dark(struct kms_screen *screen, struct fault *fault)
{
	struct kms_state dark = screen->ours;
	int err;

	dark.crtc_active = 0;
	err = kms_state_commit(&screen->path, &screen->properties, &dark,
			       DRM_MODE_ATOMIC_ALLOW_MODESET);
	return err ? kms_screen_refused(screen, err, "switch it off", fault) : 0;
}

static int describe_mode(struct kms_screen *screen, struct fault *fault)
{
	const drmModeModeInfo *mode = &screen->path.mode;
	uint32_t blob = 0;
	int err;

	err = drmModeCreatePropertyBlob(screen->path.card, mode, sizeof(*mode), &blob);
	if (err)
		return kms_screen_refused(screen, err, "describe the mode", fault);
	screen->ours = (struct kms_state){
		.connector_crtc = screen->path.crtc,
		.connector_link = DRM_MODE_LINK_STATUS_GOOD,
		.connector_range = screen->before.connector_range,
		.crtc_active = 1,
		.crtc_mode = blob,
		.plane_crtc = screen->path.crtc,
	};
	return 0;
}

/* What the card cannot choose is left to its driver. */
static void choose_range(struct kms_screen *screen, enum kms_range range)
{
	const uint32_t property = screen->properties.connector_range;
	const char *name = kms_range_name(range);

	if ((!property ||
	     kms_panel_value(screen->path.card, property, name, &screen->ours.connector_range)) &&
	    range != KMS_RANGE_AUTO)
		log_warning_paced(
			"kms display: %s: the card cannot choose the range \"%s\"; its driver decides",
			screen->path.connector_name, name);
}

/* ---- open and release ---- */

static enum display_situation find_situation(int err)
{
	return err == -ENOENT	? DISPLAY_NO_DEVICE
	       : err == -EINVAL ? DISPLAY_NO_MODE
				: DISPLAY_FINE; /* the caller derives it from the error */
}

static int create_buffers(struct kms_screen *screen, int count, struct fault *fault)
{
	screen->swap.count = count;
	for (int i = 0; i < count; i++) {
		const int err = create_buffer(screen, &screen->swap.buffers[i]);

		if (err)
			return kms_screen_refused(screen, err, "make a framebuffer", fault);
	}
	return 0;
}

int kms_screen_open(struct kms_screen *screen, const struct display_settings *settings,
		    const struct kms_options *options, enum display_situation *situation,
		    struct fault *fault)
{
	struct fault trouble;
	uint64_t monotonic = 0;
	int err;

	screen->path.card = -1;
	screen->watch = (struct kms_watch){-1, -1, -1};
	screen->console = (struct kms_console){.tty = -1, .told = -1};
	screen->swap.shown = screen->swap.flipping = screen->swap.waiting = NONE;
	err = kms_find(settings, options, &screen->path, fault);
	if (err < 0) {
		*situation = find_situation(err);
		return err;
	}
	screen->fit = kms_screen_whole(screen);
	err = kms_screen_become_master(screen, fault);
	if (err)
		return err;
	screen->timestamps =
		!drmGetCap(screen->path.card, DRM_CAP_TIMESTAMP_MONOTONIC, &monotonic) && monotonic;
	err = kms_state_read(&screen->path, &screen->properties, &screen->before, fault);
	if (err)
		return err;
	screen->kept = true;
	screen->connector.link_property = screen->properties.connector_link;
	err = create_buffers(screen, options->buffers, fault);
	if (!err)
		err = describe_mode(screen, fault);
	if (err)
		return err;
	choose_range(screen, (enum kms_range)options->range);
	if (kms_console_open(&screen->console, options->vt, &trouble))
		log_warning_paced("kms display: %s; going on without it", trouble.text);
	return kms_watch_open(&screen->watch, screen->path.card, screen->console.told, fault);
}

/* Restores the state that was found. The kernel refuses it if a framebuffer no longer exists, like
 * a cursor's after it was switched off: then without the covers, and at last with the screen off. A
 * blocking commit waits for the last flip. */
static int screen_restore(struct kms_screen *screen)
{
	const struct kms_state dark = {0};
	int err = kms_state_commit(&screen->path, &screen->properties, &screen->before,
				   DRM_MODE_ATOMIC_ALLOW_MODESET);

	if (err && screen->before.cover_count) {
		screen->before.cover_count = 0;
		err = kms_state_commit(&screen->path, &screen->properties, &screen->before,
				       DRM_MODE_ATOMIC_ALLOW_MODESET);
	}
	if (err)
		err = kms_state_commit(&screen->path, &screen->properties, &dark,
				       DRM_MODE_ATOMIC_ALLOW_MODESET);
	return err == -ENODEV ? 0 : err; /* the card is gone: nothing to restore */
}

int kms_screen_release(struct kms_screen *screen)
{
	int err = 0;

	kms_second_release(&screen->second);
	if (screen->set)
		err = screen_restore(screen);
	/* This makes the kernel show its text, whatever was on the screen before. */
	kms_console_close(&screen->console);
	kms_watch_close(&screen->watch);
	for (int i = 0; i < BUFFERS_MAX; i++)
		destroy_buffer(screen, &screen->swap.buffers[i]);
	kms_state_forget(screen->path.card, &screen->ours);
	if (screen->kept)
		kms_state_forget(screen->path.card, &screen->before);
	if (screen->master)
		drmDropMaster(screen->path.card);
	if (screen->path.card >= 0)
		close(screen->path.card);
	free(screen);
	return err;
}
