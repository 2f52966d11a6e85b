/* SPDX-License-Identifier: MIT */
/*
 * A screen without a desktop (DRM/KMS): atomic mode setting, dumb buffers of XRGB8888, page flips
 * that the kernel reports by events. Buffers may be write-combined, so nothing here reads them.
 *
 * close() restores the state that open() found. If the program is killed, the kernel frees the
 * buffers and, if no other program holds the card, shows its console again.
 */
#include <errno.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xf86drm.h>

#include "drivers/drivers.h"
#include "drivers/kms/kms.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

#define FLIP_WITHIN_NS NS_PER_S
#define LOOK_EVERY_NS (2 * NS_PER_S) /* how often the connector is read without a message */

static const char *const scaling_choices[] = {"auto", "never", NULL};
static const char *const range_choices[] = {"auto", "full", "limited", NULL};

static const struct ini_key kms_keys[] = {
	{"connector", INI_TEXT, offsetof(struct kms_options, connector), .fallback = "",
	 .help = "Connector to use, like HDMI-A-1; empty: the first that has a screen."},
	{"second", INI_TEXT, offsetof(struct kms_options, second), .fallback = "",
	 .help = "Connector of a second screen, on the same card, that shows the same picture; empty: none."},
	{"mode", INI_TEXT, offsetof(struct kms_options, mode), .fallback = "",
	 .help = "For screens that name no modes or wrong ones: 1920x1080@60, or a modeline as cvt prints it."},
	{"force", INI_BOOL, offsetof(struct kms_options, force), .fallback = "no",
	 .help = "Use the connector even if it knows of no screen; without a mode: 1024x768@60."},
	{"buffers", INI_INT, offsetof(struct kms_options, buffers), .min = 2, .max = BUFFERS_MAX,
	 .fallback = "2",
	 .help = "Framebuffers: 2 for the least latency, 3 to miss fewer refreshes."},
	{"scaling", INI_CHOICE, offsetof(struct kms_options, scaling), .choices = scaling_choices,
	 .fallback = "auto",
	 .help = "Whether the graphics card may scale pictures to the screen, where it can."},
	{"range", INI_CHOICE, offsetof(struct kms_options, range), .choices = range_choices,
	 .fallback = "auto",
	 .help = "Code values that HDMI sends for black and white, 0 and 255 or 16 and 235, where the screen looks washed out or loses its shadows; auto: by the mode."},
	{"vt", INI_TEXT, offsetof(struct kms_options, vt), .fallback = "",
	 .help = "Text console to take, so that switching to another shows it: /dev/tty1, or auto for the present one; empty: none."},
	INI_KEYS_END,
};

/* ---- scaling ---- */

/* Tests by an atomic commit whether the hardware scales so. */
static bool ask_for_scaling(struct kms_screen *screen, const struct kms_fit *fit)
{
	struct kms_state trial = screen->ours;

	trial.plane_fb = screen->swap.buffers[screen->swap.shown].framebuffer;
	kms_screen_set_fit(&trial, fit);
	return !kms_state_commit(&screen->path, &screen->properties, &trial,
				 DRM_MODE_ATOMIC_TEST_ONLY);
}

static bool can_scale(struct kms_screen *screen, const struct kms_fit *fit, double squash)
{
	struct kms_verdict *verdict;

	for (int i = 0; i < VERDICTS; i++) {
		verdict = &screen->verdicts.entry[i];
		if (verdict->width == fit->width && verdict->height == fit->height &&
		    verdict->squash == squash)
			return verdict->accepted;
	}
	verdict = &screen->verdicts.entry[screen->verdicts.next++ % VERDICTS];
	*verdict = (struct kms_verdict){fit->width, fit->height, squash,
					ask_for_scaling(screen, fit)};
	log_debug("kms display: %s %s %dx%d to the screen", screen->path.device,
		  verdict->accepted ? "scales" : "does not scale", fit->width, fit->height);
	return verdict->accepted;
}

/* Buffers stay as large as the screen; the hardware enlarges a part of them. */
static int kms_fit(struct display *display, int width, int height, double squash)
{
	const struct kms_options *options = display->options;
	struct kms_screen *screen = display->state;
	struct kms_fit fit = {width, height, {0}};

	screen->fit = kms_screen_whole(screen);
	if (width < 1 || height < 1 || !(squash > 0) || width > display->width ||
	    height > display->height || display->hidden || display->off)
		return -ENOTSUP;
	fit.box = kms_fit_box(width, height, squash, display->width, display->height);
	if (fit.box.width == width && fit.box.height == height && width == display->width &&
	    height == display->height)
		return 0;
	/* A second screen has a box of its own for the whole picture. */
	if (options->scaling == KMS_SCALING_NEVER || options->second[0] ||
	    !can_scale(screen, &fit, squash))
		return -ENOTSUP;
	screen->fit = fit;
	return 0;
}

/* ---- the second screen ---- */

static uint32_t present_framebuffer(const struct kms_screen *screen)
{
	return screen->swap.buffers[screen->swap.shown == NONE ? 0 : screen->swap.shown]
		.framebuffer;
}

static void second_show(struct kms_screen *screen, const struct display *display)
{
	kms_second_show(&screen->second, display->options, &screen->path,
			present_framebuffer(screen));
}

/* ---- the console ---- */

/* Gives the screen up for another text console, until this one is switched back to. */
static void kms_go_away(struct display *display)
{
	struct kms_screen *screen = display->state;

	kms_second_hide(&screen->second);
	screen->swap.waiting = NONE;
	if (screen->swap.flipping == NONE)
		screen->swap.due_ns = 0;
	drmDropMaster(screen->path.card);
	kms_console_show_text(&screen->console);
	screen->master = false;
	screen->set = false;
	display->hidden = true;
}

static int take_flips(struct kms_screen *screen);
static int kms_look(struct kms_screen *screen, const struct display *display, bool probe,
		    struct fault *fault);

/* Shows the last buffer again. The mode set waits for a pending flip and then replaces its picture,
 * so the event of that flip must not change on_screen. */
static int show_again(struct kms_screen *screen, struct fault *fault)
{
	const int index = screen->swap.shown == NONE ? 0 : screen->swap.shown;
	int err = kms_screen_set_mode(screen, index, fault);

	if (!err)
		err = take_flips(screen);
	screen->swap.shown = index;
	return err;
}

/* Switches the screen off. The picture that was on it is forgotten, or it would be shown for a
 * moment when the screen is switched on. */
static int go_dark(struct kms_screen *screen, struct fault *fault)
{
	int err;

	kms_second_hide(&screen->second);
	err = kms_screen_set_dark(screen, fault);
	if (!err)
		err = take_flips(screen);
	screen->swap.flipping = screen->swap.waiting = NONE;
	screen->swap.due_ns = 0;
	screen->shown.kind = DISPLAY_NOTHING;
	for (int i = 0; i < screen->swap.count; i++)
		memset(screen->swap.buffers[i].map, 0, screen->swap.buffers[i].bytes);
	return err;
}

static int kms_power(struct display *display, bool on, struct fault *fault)
{
	struct kms_screen *screen = display->state;
	int err;

	if (display->hidden)
		return 0; /* when the console is back */
	if (!on)
		return go_dark(screen, fault);
	err = kms_look(screen, display, true, fault);
	if (!err)
		err = show_again(screen, fault);
	if (!err)
		second_show(screen, display);
	return err;
}

static int kms_come_back(struct display *display, struct fault *fault)
{
	struct kms_screen *screen = display->state;
	int err = kms_screen_become_master(screen, fault);

	if (!err && display->off) {
		display->hidden = false;
		return go_dark(screen, fault);
	}
	if (!err)
		err = kms_look(screen, display, true, fault);
	if (!err)
		err = show_again(screen, fault);
	if (err)
		return err;
	second_show(screen, display);
	display->hidden = false;
	screen->exposed = true;
	return 0;
}

static int switch_console(struct display *display, struct fault *fault)
{
	struct kms_screen *screen = display->state;
	int err = 0;

	switch (kms_console_next(&screen->console)) {
	case KMS_SWITCH_AWAY:
		if (!display->hidden)
			kms_go_away(display);
		kms_console_let_go(&screen->console);
		break;
	case KMS_SWITCH_BACK:
		kms_console_taken(&screen->console);
		if (display->hidden)
			err = kms_come_back(display, fault);
		break;
	case KMS_SWITCH_NONE:
		break;
	}
	return err;
}

/* Sets the mode; if another console is the active one, asks for a switch instead and waits
 * hidden. */
static int kms_light_up(struct display *display, struct fault *fault)
{
	struct kms_screen *screen = display->state;

	if (screen->console.tty < 0 || kms_console_is_active(&screen->console))
		return kms_screen_set_mode(screen, 0, fault);
	kms_go_away(display);
	kms_console_activate(&screen->console);
	return 0;
}

/* Number of stalled screens that threads still release. It outlives a display on purpose: until the
 * release is done this process itself holds the card, and a message must not blame another one. */
static atomic_int releasing;

static int kms_open(struct display *display, struct fault *fault)
{
	struct kms_screen *screen;
	const drmModeModeInfo *mode;
	int err;

	if (atomic_load(&releasing))
		return fault_say(
			fault, -ETIMEDOUT,
			"kms display: the card still waits for the frame that was not shown, and shows nothing before it gives up");
	screen = calloc(1, sizeof(*screen));
	if (!screen)
		return fault_say(fault, -ENOMEM, "kms display: not enough memory");
	display->state = screen;
	err = kms_screen_open(screen, &display->settings, display->options, &display->situation,
			      fault);
	if (!err)
		err = kms_light_up(display, fault);
	if (err)
		return err;
	mode = &screen->path.mode;
	display->width = mode->hdisplay;
	display->height = mode->vdisplay;
	display->rate_hz = kms_mode_rate(mode);
	display->mounted = (int)kms_panel_turn(&screen->path);
	screen->looked_ns = clock_now_ns();
	if (!display->hidden)
		second_show(screen, display);
	if (screen->path.computed)
		log_info_paced(
			"kms display: %s: %dx%d at %.2f Hz, a timing that the screen has not named",
			screen->path.connector_name, display->width, display->height,
			display->rate_hz);
	return 0;
}

static int kms_descriptor(struct display *display)
{
	return ((struct kms_screen *)display->state)->watch.set;
}

/* ---- frames ---- */

static int kms_acquire(struct display *display, struct display_buffer *buffer)
{
	struct kms_screen *screen = display->state;

	if (display->hidden || screen->swap.waiting != NONE)
		return -EAGAIN;
	for (int i = 0; i < screen->swap.count; i++) {
		if (i == screen->swap.shown || i == screen->swap.flipping)
			continue;
		screen->swap.buffers[i].fit = screen->fit;
		*buffer = (struct display_buffer){
			.pixels = screen->swap.buffers[i].map,
			.stride = screen->swap.buffers[i].stride,
			.width = screen->fit.width,
			.height = screen->fit.height,
			.index = i,
		};
		return 0;
	}
	return -EAGAIN;
}

/* Flips both screens at once, so that they show the same and none overtakes the other. A second one
 * that cannot any more does not stop the first. */
static int flip_all(struct kms_screen *screen, const struct kms_state *ours)
{
	struct kms_second *second = &screen->second;
	const struct kms_flip flips[2] = {
		{&screen->path, &screen->properties, ours},
		{&second->path, &second->properties, &second->ours},
	};
	int err;

	second->ours.plane_fb = ours->plane_fb;
	screen->flips_due = second->shown ? 2 : 1;
	err = kms_state_flip(flips, screen->flips_due, screen);
	if (!second->shown || !err || err == -EBUSY || err == -EACCES)
		return err;
	kms_second_hide(second);
	screen->flips_due = 1;
	return kms_state_flip(flips, 1, screen);
}

/* Queues the waiting frame in the kernel unless a flip is pending. After EBUSY it stays waiting and
 * is tried again until its deadline. */
static int kms_flip(struct kms_screen *screen)
{
	const int64_t now_ns = clock_now_ns();
	struct kms_state *ours = &screen->ours;
	const struct kms_buffer *buffer;
	int err;

	if (screen->swap.waiting == NONE || screen->swap.flipping != NONE)
		return 0;
	buffer = &screen->swap.buffers[screen->swap.waiting];
	ours->plane_fb = buffer->framebuffer;
	kms_screen_set_fit(ours, &buffer->fit);
	err = flip_all(screen, ours);
	if (err == -EBUSY) {
		if (!screen->swap.due_ns)
			screen->swap.due_ns = now_ns + FLIP_WITHIN_NS;
		kms_watch_soon(&screen->watch);
		return 0;
	}
	if (err)
		return err;
	screen->swap.flipping = screen->swap.waiting;
	screen->swap.waiting = NONE;
	screen->swap.due_ns = now_ns + FLIP_WITHIN_NS;
	return 0;
}

static int say_lost(struct kms_screen *screen, int err, struct fault *fault)
{
	return err == -EACCES ? kms_screen_held(screen, fault)
			      : kms_screen_refused(screen, err, "show a frame", fault);
}

static int kms_submit(struct display *display, struct display_buffer *buffer, int64_t token,
		      struct fault *fault)
{
	struct kms_screen *screen = display->state;
	int err;

	if (display->hidden)
		return 0; /* acquired before the console was switched away: dropped */
	screen->swap.buffers[buffer->index].token = token;
	screen->swap.waiting = buffer->index;
	err = kms_flip(screen);
	return err ? say_lost(screen, err, fault) : 0;
}

static void on_flip(int card, unsigned sequence, unsigned seconds, unsigned microseconds,
		    unsigned crtc, void *user)
{
	struct kms_screen *screen = user;

	(void)card;
	(void)sequence;
	if (screen->swap.flipping == NONE)
		return;
	if (!crtc || crtc == screen->path.crtc) /* 0: a kernel before 4.12 */
		screen->flip_ns = screen->timestamps ? (int64_t)seconds * NS_PER_S +
							       (int64_t)microseconds * 1000
						     : clock_now_ns();
	if (--screen->flips_due > 0)
		return;
	screen->swap.shown = screen->swap.flipping;
	screen->swap.flipping = NONE;
	screen->swap.due_ns = 0;
	screen->shown = (struct display_event){
		.kind = DISPLAY_SHOWN,
		.time_ns = screen->flip_ns,
		.token = screen->swap.buffers[screen->swap.shown].token,
	};
}

static int take_flips(struct kms_screen *screen)
{
	drmEventContext context = {
		.version = 3,
		.page_flip_handler2 = on_flip,
	};

	/* The card is non-blocking: without an event this gives EAGAIN. */
	if (drmHandleEvent(screen->path.card, &context) && errno != EAGAIN && errno != EINTR)
		return -errno;
	return 0;
}

/* Reads the connector. 0 if the screen is there, its link works and the same mode would be picked;
 * else -errno with a fault. probe: as for kms_connector_read(). */
static int kms_look(struct kms_screen *screen, const struct display *display, bool probe,
		    struct fault *fault)
{
	struct kms_connector *connector = &screen->connector;
	drmModeModeInfo mode;
	bool computed;
	int err;

	screen->looked_ns = clock_now_ns();
	err = kms_connector_read(screen->path.card, screen->path.connector, probe, connector);
	if (err && err != -E2BIG)
		return kms_screen_refused(screen, err == -ENOENT ? -ENODEV : err,
					  "find it any more", fault);
	if (err == -E2BIG) {
		connector->count = 1;
		connector->modes[0] = screen->path.mode;
	}
	err = kms_mode_pick(&display->settings, display->options, connector->connection,
			    connector->modes, connector->count, &mode, &computed);
	if (err == -ENOLINK)
		return fault_say(fault, err,
				 "kms display: the screen at %s was unplugged or is off",
				 screen->path.connector_name);
	if (err || !kms_mode_same(&mode, &screen->path.mode))
		return fault_say(fault, -ESTALE,
				 "kms display: the screen at %s has other modes now",
				 screen->path.connector_name);
	/* Flips go on without an error over a failed link, but the screen stays dark. */
	if (connector->link_failed)
		return fault_say(
			fault, -ESTALE,
			"kms display: the link to the screen at %s has failed and is to be set up anew",
			screen->path.connector_name);
	return 0;
}

/* After a hotplug message the screen itself is probed; every LOOK_EVERY_NS only the kernel's
 * knowledge is read. */
static int look_if_due(struct display *display, unsigned ready, struct fault *fault)
{
	struct kms_screen *screen = display->state;
	const bool told = ready & KMS_READY_HOTPLUG;
	const unsigned known = screen->connector.connection;
	int err;

	if (display->hidden || display->off ||
	    !(told || clock_now_ns() - screen->looked_ns >= LOOK_EVERY_NS))
		return 0;
	err = kms_look(screen, display, told, fault);
	/* The kernel knows the modes of a newly connected screen only after a probe. */
	if (!err && !told && known && screen->connector.connection != known)
		err = kms_look(screen, display, true, fault);
	if (!err)
		kms_second_look(&screen->second, display->options, &screen->path,
				present_framebuffer(screen), told);
	return err;
}

static int check_flip(struct kms_screen *screen, struct fault *fault)
{
	if (!screen->swap.due_ns || clock_now_ns() < screen->swap.due_ns)
		return 0;
	screen->swap.stalled = true;
	return fault_say(fault, -ETIMEDOUT,
			 "kms display: %s: a frame was not shown within a second",
			 screen->path.connector_name);
}

static void kms_tell(struct kms_screen *screen, struct display_event *event)
{
	if (screen->shown.kind != DISPLAY_NOTHING) {
		*event = screen->shown;
		screen->shown.kind = DISPLAY_NOTHING;
	} else if (screen->exposed) {
		*event = (struct display_event){
			.kind = DISPLAY_EXPOSED,
			.time_ns = clock_now_ns(),
		};
		screen->exposed = false;
	}
}

static int kms_dispatch(struct display *display, struct display_event *event, struct fault *fault)
{
	struct kms_screen *screen = display->state;
	const unsigned ready = kms_watch_take(&screen->watch);
	int err = 0;

	if (ready & KMS_READY_CARD)
		err = take_flips(screen);
	if (!err && ready & KMS_READY_GONE)
		err = -ENODEV;
	if (err)
		return say_lost(screen, err, fault);
	if (ready & KMS_READY_CONSOLE)
		err = switch_console(display, fault);
	if (!err && ready & (KMS_READY_HOTPLUG | KMS_READY_TICK))
		err = look_if_due(display, ready, fault);
	if (err)
		return err;
	err = kms_flip(screen);
	if (err)
		return say_lost(screen, err, fault);
	err = check_flip(screen, fault);
	if (err)
		return err;
	kms_tell(screen, event);
	return 0;
}

/* ---- close ---- */

/* Thread: releases a stalled screen, which may take more than ten seconds. */
static void *let_go_in_time(void *screen)
{
	kms_screen_release(screen);
	atomic_fetch_sub(&releasing, 1);
	return NULL;
}

static int kms_close(struct display *display, struct fault *fault)
{
	struct kms_screen *screen = display->state;
	pthread_t thread;
	int err;

	if (!screen)
		return 0;
	display->state = NULL;
	/* Any request to the card waits ten seconds and more for a flip that never comes. A thread
	 * waits for it, so that the program does not. */
	if (screen->swap.stalled) {
		atomic_fetch_add(&releasing, 1);
		if (!pthread_create(&thread, NULL, let_go_in_time, screen)) {
			pthread_detach(thread);
			return 0;
		}
		atomic_fetch_sub(&releasing, 1);
	}
	err = kms_screen_release(screen);
	return err ? fault_say(fault, err, "kms display: cannot give the screen back: %s",
			       strerror(-err))
		   : 0;
}

const struct display_ops display_kms = {
	.name = "kms",
	.description = "a screen without a desktop (DRM/KMS, atomic)",
	.keys = kms_keys,
	.options_size = sizeof(struct kms_options),
	.list = kms_list,
	.open = kms_open,
	.descriptor = kms_descriptor,
	.fit = kms_fit,
	.power = kms_power,
	.acquire = kms_acquire,
	.submit = kms_submit,
	.dispatch = kms_dispatch,
	.close = kms_close,
};
