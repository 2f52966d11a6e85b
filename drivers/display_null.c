/* SPDX-License-Identifier: MIT */
/*
 * A screen without hardware, with the timing of a real one: two buffers, flips at a set rate. A
 * program that is too slow for a screen of this rate is too slow here too. For tests it can fail as
 * screens do; after it is opened again it works.
 */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/frame/frame.h"

#define NONE (-1)
#define RATE_HZ 60	  /* where [screen] asks for none: that of most screens */
#define STALL_NS NS_PER_S /* delay after which a refresh counts as lost */
#define HIDDEN_NS (NS_PER_S / 2)

struct null_options {
	int vanish_after, stall_after, hide_after;
};

struct null_screen {
	struct canvas buffers[2];
	int timer;     /* one-shot timerfd: the next flip */
	int on_screen; /* index of the buffer that is shown; NONE before the first flip */
	int queued;    /* index of the buffer that waits for its flip, or NONE */
	int64_t token;
	int64_t due_ns;
	int submitted;		     /* number of frames */
	int failure;		     /* -errno that the next refresh reports; 0: it succeeds */
	bool overtaken;		     /* a simulated console switch comes before the flip */
	int64_t start_ns, period_ns; /* of the refresh */
};

static const struct ini_key null_keys[] = {
	{"vanish_after", INI_INT, offsetof(struct null_options, vanish_after), .max = 2147483647,
	 .fallback = "0",
	 .help = "Frames after which it is pulled out, each time that it is opened; 0: never."},
	{"stall_after", INI_INT, offsetof(struct null_options, stall_after), .max = 2147483647,
	 .fallback = "0",
	 .help = "Frames after which a refresh never comes, each time that it is opened; 0: never."},
	{"hide_after", INI_INT, offsetof(struct null_options, hide_after), .max = 2147483647,
	 .fallback = "0",
	 .help = "Frames after which another console is switched to for half a second, each time that it is opened; 0: never. The frame under way is lost."},
	INI_KEYS_END,
};

static int null_open(struct display *display, struct fault *fault)
{
	const double rate = display->settings.rate_hz > 0 ? display->settings.rate_hz : RATE_HZ;
	struct null_screen *screen;
	int err;

	err = display_free_size(display, &display->width, &display->height, fault);
	if (err)
		return err;
	screen = calloc(1, sizeof(*screen));
	if (!screen)
		return fault_say(fault, -ENOMEM, "not enough memory for the null display");
	display->state = screen;
	display->rate_hz = rate;
	screen->on_screen = screen->queued = NONE;
	screen->start_ns = clock_now_ns();
	screen->period_ns = (int64_t)((double)NS_PER_S / rate);
	screen->timer = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
	if (screen->timer < 0) {
		err = -errno;
		return fault_say(fault, err, "null display: no timer: %s", strerror(-err));
	}
	for (int i = 0; i < 2; i++) {
		err = canvas_create(&screen->buffers[i], display->width, display->height);
		if (err)
			return fault_say(fault, err, "null display: no memory for %d x %d pixels",
					 display->width, display->height);
	}
	return 0;
}

static int null_descriptor(struct display *display)
{
	return ((struct null_screen *)display->state)->timer;
}

static int null_power(struct display *display, bool on, struct fault *fault)
{
	struct null_screen *screen = display->state;

	(void)fault;
	screen->queued = NONE;
	log_info("null display: switched %s", on ? "on" : "off");
	return 0;
}

static int null_acquire(struct display *display, struct display_buffer *buffer)
{
	struct null_screen *screen = display->state;
	const int index = screen->on_screen == 0 ? 1 : 0;
	const struct canvas *canvas = &screen->buffers[index];

	if (screen->queued != NONE || display->hidden)
		return -EAGAIN;
	*buffer = (struct display_buffer){
		.pixels = canvas->pixels,
		.stride = canvas->stride,
		.width = canvas->width,
		.height = canvas->height,
		.index = index,
	};
	return 0;
}

/* Returns the time of the first refresh after now. */
static int64_t next_refresh_ns(const struct null_screen *screen, int64_t now_ns)
{
	return now_ns + screen->period_ns - (now_ns - screen->start_ns) % screen->period_ns;
}

/* Makes the descriptor readable at due_ns. */
static int null_set_timer(const struct null_screen *screen, int64_t due_ns, struct fault *fault)
{
	const struct itimerspec when = {
		.it_value.tv_sec = (time_t)(due_ns / NS_PER_S),
		.it_value.tv_nsec = (long)(due_ns % NS_PER_S),
	};
	int err;

	if (!timerfd_settime(screen->timer, TFD_TIMER_ABSTIME, &when, NULL))
		return 0;
	err = -errno;
	return fault_say(fault, err, "null display: timer: %s", strerror(-err));
}

static int null_submit(struct display *display, struct display_buffer *buffer, int64_t token,
		       struct fault *fault)
{
	const struct null_options *options = display->options;
	struct null_screen *screen = display->state;
	int err;

	screen->due_ns = next_refresh_ns(screen, clock_now_ns());
	screen->submitted++;
	if (options->vanish_after && screen->submitted > options->vanish_after) {
		screen->failure = -ENOLINK;
	} else if (options->stall_after && screen->submitted > options->stall_after) {
		screen->failure = -ETIMEDOUT;
		screen->due_ns += STALL_NS;
	}
	screen->overtaken = options->hide_after && screen->submitted == options->hide_after + 1;
	err = null_set_timer(screen, screen->due_ns, fault);
	if (err)
		return err;
	screen->queued = buffer->index;
	screen->token = token;
	return 0;
}

/* Simulates a switch to another console: the queued frame is lost. */
static int null_hide(struct display *display, struct fault *fault)
{
	struct null_screen *screen = display->state;

	screen->overtaken = false;
	screen->queued = NONE;
	display->hidden = true;
	return null_set_timer(screen, clock_now_ns() + HIDDEN_NS, fault);
}

static int null_dispatch(struct display *display, struct display_event *event, struct fault *fault)
{
	struct null_screen *screen = display->state;
	uint64_t expired;

	if (read(screen->timer, &expired, sizeof(expired)) < 0) {
		const int err = -errno;

		return err == -EAGAIN ? 0 : fault_say(fault, err, "null display: timer");
	}
	if (screen->failure)
		return fault_say(fault, screen->failure, "null display: %s",
				 screen->failure == -ENOLINK
					 ? "pulled out, as null.vanish_after says"
					 : "stalled, as null.stall_after says");
	if (screen->overtaken)
		return null_hide(display, fault);
	if (display->hidden) {
		display->hidden = false;
		event->kind = DISPLAY_EXPOSED;
		event->time_ns = clock_now_ns();
		return 0;
	}
	if (screen->queued == NONE)
		return 0;
	event->kind = DISPLAY_SHOWN;
	event->time_ns = screen->due_ns;
	event->token = screen->token;
	screen->on_screen = screen->queued;
	screen->queued = NONE;
	return 0;
}

static int null_close(struct display *display, struct fault *fault)
{
	struct null_screen *screen = display->state;

	(void)fault;
	if (!screen)
		return 0;
	if (screen->timer >= 0)
		close(screen->timer);
	for (int i = 0; i < 2; i++)
		canvas_free(&screen->buffers[i]);
	free(screen);
	display->state = NULL;
	return 0;
}

const struct display_ops display_null = {
	.name = "null",
	.description = "no screen: frames are shown to nobody, at a set rate",
	.keys = null_keys,
	.options_size = sizeof(struct null_options),
	.open = null_open,
	.descriptor = null_descriptor,
	.power = null_power,
	.acquire = null_acquire,
	.submit = null_submit,
	.dispatch = null_dispatch,
	.close = null_close,
};
