/*
 * The screen itself, without a desktop: atomic modesetting, dumb buffers of XRGB8888, page flips
 * reported by events. Buffers may be write-combined: they are never read here.
 *
 * The state that was found is put back at close. Should the program be killed, the kernel takes the
 * buffers back and, when no other program holds the card, shows its console again.
 */
#include <drm_fourcc.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/kms/kms.h"
#include "hal/clock.h"

#define NONE (-1)
#define BUFFERS_MAX 3

struct kms_buffer {
	uint32_t handle, stride, framebuffer;
	uint64_t bytes;
	uint8_t *map; /* NULL: not mapped */
	int64_t token;
};

struct kms_screen {
	struct kms_path path; /* path.card is ours; -1: closed */
	bool master;
	bool timestamps; /* of events are CLOCK_MONOTONIC */

	struct kms_properties properties;
	struct kms_state before, ours;
	bool kept; /* before is known */
	bool set;  /* ours is on the screen */

	struct kms_buffer buffers[BUFFERS_MAX];
	int buffer_count;
	int on_screen; /* index */
	int flipping;  /* queued in the kernel, or NONE */
	int waiting;   /* submitted while another was flipping, or NONE */
	struct display_event shown;
};

static const struct ini_key kms_keys[] = {
	{.name = "connector",
	 .type = INI_TEXT,
	 .offset = offsetof(struct kms_options, connector),
	 .fallback = "",
	 .help = "Connector to use, like HDMI-A-1; empty: the first that has a screen."},
	{.name = "buffers",
	 .type = INI_INT,
	 .offset = offsetof(struct kms_options, buffers),
	 .min = 2,
	 .max = BUFFERS_MAX,
	 .fallback = "2",
	 .help = "Framebuffers: 2 for the least latency, 3 to miss fewer refreshes."},
	INI_KEYS_END,
};

static int say_refused(const struct kms_screen *screen, int err, const char *what,
		       struct fault *fault)
{
	if (err == -EACCES || err == -EBUSY || err == -EPERM)
		return fault_say(fault, err,
				 "kms display: another program (a desktop or another inlay) holds "
				 "the screen (%s of %s): stop it or switch to a free console",
				 screen->path.connector_name, screen->path.device);
	return fault_say(fault, err, "kms display: %s: cannot %s: %s", screen->path.connector_name,
			 what, strerror(-err));
}

static int become_master(struct kms_screen *screen, struct fault *fault)
{
	int err = 0;

	/* The first to open a card is its master already. */
	if (!drmIsMaster(screen->path.card) && drmSetMaster(screen->path.card))
		err = -errno;
	if (err)
		return say_refused(screen, err, "become its master", fault);
	screen->master = true;
	return 0;
}

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

/* Shows the first buffer, black. Tried before it is done, so that a refusal changes nothing. */
static int set_mode(struct kms_screen *screen, struct fault *fault)
{
	const drmModeModeInfo *mode = &screen->path.mode;
	struct kms_state *ours = &screen->ours;
	uint32_t blob = 0;
	int err;

	err = drmModeCreatePropertyBlob(screen->path.card, mode, sizeof(*mode), &blob);
	if (err)
		return say_refused(screen, err, "describe the mode", fault);
	*ours = (struct kms_state){
		.connector_crtc = screen->path.crtc,
		.crtc_active = 1,
		.crtc_mode = blob,
		.plane_fb = screen->buffers[0].framebuffer,
		.plane_crtc = screen->path.crtc,
		/* Of the source in 16.16. */
		.plane_source = {0, 0, (uint64_t)mode->hdisplay << 16,
				 (uint64_t)mode->vdisplay << 16},
		.plane_target = {0, 0, mode->hdisplay, mode->vdisplay},
	};
	err = kms_state_commit(&screen->path, &screen->properties, ours,
			       DRM_MODE_ATOMIC_TEST_ONLY | DRM_MODE_ATOMIC_ALLOW_MODESET);
	if (!err)
		err = kms_state_commit(&screen->path, &screen->properties, ours,
				       DRM_MODE_ATOMIC_ALLOW_MODESET);
	if (err)
		return say_refused(screen, err, "set the mode", fault);
	screen->set = true;
	return 0;
}

static int open_screen(struct display *display, struct kms_screen *screen, struct fault *fault)
{
	const struct kms_options *options = display->options;
	uint64_t monotonic = 0;
	int err;

	err = kms_find(&display->settings, options->connector, &screen->path, fault);
	if (err < 0)
		return err;
	err = become_master(screen, fault);
	if (err)
		return err;
	screen->timestamps =
		!drmGetCap(screen->path.card, DRM_CAP_TIMESTAMP_MONOTONIC, &monotonic) && monotonic;
	err = kms_state_read(&screen->path, &screen->properties, &screen->before, fault);
	if (err)
		return err;
	screen->kept = true;
	screen->buffer_count = options->buffers;
	for (int i = 0; i < screen->buffer_count; i++) {
		err = create_buffer(screen, &screen->buffers[i]);
		if (err)
			return say_refused(screen, err, "make a framebuffer", fault);
	}
	return set_mode(screen, fault);
}

static int kms_open(struct display *display, struct fault *fault)
{
	struct kms_screen *screen = calloc(1, sizeof(*screen));
	int err;

	if (!screen)
		return fault_say(fault, -ENOMEM, "kms display: not enough memory");
	screen->path.card = -1;
	screen->flipping = screen->waiting = NONE;
	display->state = screen;
	err = open_screen(display, screen, fault);
	if (err)
		return err;
	display->width = screen->path.mode.hdisplay;
	display->height = screen->path.mode.vdisplay;
	display->rate_hz = kms_mode_rate(&screen->path.mode);
	return 0;
}

static int kms_descriptor(struct display *display)
{
	return ((struct kms_screen *)display->state)->path.card;
}

static int kms_acquire(struct display *display, struct display_buffer *buffer)
{
	const struct kms_screen *screen = display->state;

	for (int i = 0; i < screen->buffer_count; i++) {
		if (i == screen->on_screen || i == screen->flipping || i == screen->waiting)
			continue;
		*buffer = (struct display_buffer){
			.pixels = screen->buffers[i].map,
			.stride = screen->buffers[i].stride,
			.width = display->width,
			.height = display->height,
			.index = i,
		};
		return 0;
	}
	return -EAGAIN;
}

/* By hand rather than with drmModeAtomicCommit(), which allocates. */
static int flip(struct kms_screen *screen, int index)
{
	uint32_t object = screen->path.plane;
	uint32_t count = 1;
	uint32_t property = screen->properties.plane_fb;
	uint64_t value = screen->buffers[index].framebuffer;
	struct drm_mode_atomic atomic = {
		.flags = DRM_MODE_PAGE_FLIP_EVENT | DRM_MODE_ATOMIC_NONBLOCK,
		.count_objs = 1,
		.objs_ptr = (uintptr_t)&object,
		.count_props_ptr = (uintptr_t)&count,
		.props_ptr = (uintptr_t)&property,
		.prop_values_ptr = (uintptr_t)&value,
		.user_data = (uintptr_t)screen,
	};

	if (drmIoctl(screen->path.card, DRM_IOCTL_MODE_ATOMIC, &atomic))
		return -errno;
	screen->flipping = index;
	return 0;
}

static int kms_submit(struct display *display, struct display_buffer *buffer, int64_t token,
		      struct fault *fault)
{
	struct kms_screen *screen = display->state;
	int err;

	screen->buffers[buffer->index].token = token;
	if (screen->flipping != NONE) {
		screen->waiting = buffer->index;
		return 0;
	}
	err = flip(screen, buffer->index);
	return err ? say_refused(screen, err, "show a frame", fault) : 0;
}

static void on_flip(int card, unsigned sequence, unsigned seconds, unsigned microseconds,
		    unsigned crtc, void *user)
{
	struct kms_screen *screen = user;

	(void)card;
	(void)sequence;
	(void)crtc;
	if (screen->flipping == NONE)
		return;
	screen->on_screen = screen->flipping;
	screen->flipping = NONE;
	screen->shown = (struct display_event){
		.kind = DISPLAY_SHOWN,
		.time_ns = screen->timestamps
				   ? (int64_t)seconds * NS_PER_S + (int64_t)microseconds * 1000
				   : clock_now_ns(),
		.token = screen->buffers[screen->on_screen].token,
	};
}

static int kms_dispatch(struct display *display, struct display_event *event, struct fault *fault)
{
	struct kms_screen *screen = display->state;
	drmEventContext context = {
		.version = 3,
		.page_flip_handler2 = on_flip,
	};
	int err = 0;

	/* The card was opened non-blocking: without an event this says EAGAIN. */
	if (drmHandleEvent(screen->path.card, &context) && errno != EAGAIN && errno != EINTR)
		err = -errno;
	if (!err && screen->flipping == NONE && screen->waiting != NONE) {
		err = flip(screen, screen->waiting);
		screen->waiting = NONE;
	}
	if (err)
		return say_refused(screen, err, "show a frame", fault);
	*event = screen->shown;
	screen->shown.kind = DISPLAY_NOTHING;
	return 0;
}

/* As it was; and where what was shown no longer exists, dark. A commit that may block waits for the
 * last flip. */
static int restore(struct kms_screen *screen)
{
	const struct kms_state dark = {0};
	int err = kms_state_commit(&screen->path, &screen->properties, &screen->before,
				   DRM_MODE_ATOMIC_ALLOW_MODESET);

	if (err)
		err = kms_state_commit(&screen->path, &screen->properties, &dark,
				       DRM_MODE_ATOMIC_ALLOW_MODESET);
	return err;
}

static int kms_close(struct display *display, struct fault *fault)
{
	struct kms_screen *screen = display->state;
	int err = 0;

	if (!screen)
		return 0;
	if (screen->set)
		err = restore(screen);
	if (err)
		say_refused(screen, err, "give the screen back", fault);
	for (int i = 0; i < BUFFERS_MAX; i++)
		destroy_buffer(screen, &screen->buffers[i]);
	if (screen->ours.crtc_mode)
		drmModeDestroyPropertyBlob(screen->path.card, (uint32_t)screen->ours.crtc_mode);
	if (screen->kept && screen->before.crtc_mode)
		drmModeDestroyPropertyBlob(screen->path.card, (uint32_t)screen->before.crtc_mode);
	if (screen->master)
		drmDropMaster(screen->path.card);
	if (screen->path.card >= 0)
		close(screen->path.card);
	free(screen);
	display->state = NULL;
	return err;
}

const struct display_ops display_kms = {
	.name = "kms",
	.description = "a screen without a desktop (DRM/KMS, atomic)",
	.keys = kms_keys,
	.options_size = sizeof(struct kms_options),
	.list = kms_list,
	.open = kms_open,
	.descriptor = kms_descriptor,
	.acquire = kms_acquire,
	.submit = kms_submit,
	.dispatch = kms_dispatch,
	.close = kms_close,
};
