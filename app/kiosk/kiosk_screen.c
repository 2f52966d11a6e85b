/* SPDX-License-Identifier: MIT */
/* The screen, which may be missing, go and come back. */
#include <errno.h>

#include "app/kiosk/kiosk_parts.h"
#include "drivers/drivers.h"
#include "hal/base/clock.h"

int kiosk_screen_open(struct kiosk *k, bool first, struct fault *fault)
{
	struct config_screen *screen = k->config->screen;
	struct display_settings settings = screen->settings;
	int driver = config_driver_index(k->config, CONFIG_DISPLAY, screen->driver);
	struct fault reason = {.text = ""};
	int err;

	show_size(k->what, &k->eyes, &k->basis, &settings.picture_width, &settings.picture_height);
	err = display_open(&k->display, display_drivers[driver], &settings,
			   config_options(k->config, CONFIG_DISPLAY, screen, driver), &reason);
	/* Two kiosks would wait for each other's end. */
	if (err && first &&
	    (!display_may_return(k->display.situation) || k->display.situation == DISPLAY_BUSY))
		return fault_say(fault, err, "%s", reason.text);
	kiosk_complain(&k->display_said, "screen", err ? &reason : NULL);
	k->fit = (struct show_fit){.width = 0};
	k->fitted = false;
	k->redraw |= !err && !first;
	return 0;
}

static int close_screen(struct kiosk *k, struct fault *fault)
{
	int err = loop_watch(&k->loop, SLOT_DISPLAY, -1, fault);

	(void)display_close(&k->display, NULL); /* what it did not finish is said already */
	k->shown_before += k->display.shown;
	k->display.shown = 0;
	k->submitted = k->shown_before; /* what was under way never arrives */
	return err;
}

int kiosk_screen_lost(struct kiosk *k, int err, struct fault *fault)
{
	struct fault reason = *fault;
	/* A screen that changes before it has shown anything is given a second. */
	bool at_once = err == -ESTALE && k->display.shown > 0;

	if (err != -ESTALE && !display_may_return(k->display.situation))
		return err;
	kiosk_complain(&k->display_said, "screen", &reason);
	err = close_screen(k, fault);
	if (err || !at_once)
		return err;
	return kiosk_screen_open(k, false, fault);
}

static void shown(struct kiosk *k, const struct display_event *event)
{
	const struct source *first = eyes_leader(&k->eyes);
	double slower_hz = k->display.rate_hz;

	if (first && first->camera.rate_hz > 0 &&
	    (slower_hz <= 0 || first->camera.rate_hz < slower_hz))
		slower_hz = first->camera.rate_hz;
	stats_shown(&k->stats, event->token, event->time_ns,
		    slower_hz > 0 ? (int64_t)((double)NS_PER_S / slower_hz) : 0);
	service_ready(&k->service);
	service_alive(&k->service, clock_now_ns());
}

int kiosk_screen_events(struct kiosk *k, struct fault *fault)
{
	struct display_event event;

	for (;;) {
		int err = display_dispatch(&k->display, &event, fault);

		if (err)
			return kiosk_screen_lost(k, err, fault);
		switch (event.kind) {
		case DISPLAY_SHOWN:
			shown(k, &event);
			break;
		case DISPLAY_CLOSED:
			k->stop = true;
			break;
		case DISPLAY_EXPOSED:
			k->submitted = kiosk_shown(k); /* what was under way never arrives */
			k->redraw = true;
			break;
		case DISPLAY_ACTION:
			kiosk_act(k,
				  &(struct button_press){.action = (enum action)event.action,
							 .value = k->choice.threshold.value,
							 .percent = k->choice.threshold.percent},
				  NULL);
			break;
		default:
			return 0;
		}
	}
}

void kiosk_screen_fit(struct kiosk *k)
{
	/* Pixel by pixel the screen keeps its own size. */
	struct show_fit fit = {k->display.width, k->display.height, 1};

	if (k->display.hidden)
		return; /* it would say no, and is asked once */
	if (k->config->screen->scale == SCALE_FIT)
		fit = show_fit(k->what, &k->eyes, &k->basis);
	if (fit.width == k->fit.width && fit.height == k->fit.height && fit.squash == k->fit.squash)
		return;
	k->fit = fit;
	k->fitted = display_fit(&k->display, fit.width, fit.height, fit.squash) == 0;
}

uint64_t kiosk_shown(const struct kiosk *k)
{
	return k->shown_before + k->display.shown;
}

bool kiosk_screen_is_excused(const struct kiosk *k)
{
	if (k->display.state)
		return k->display.hidden;
	return k->display.situation == DISPLAY_NO_DEVICE ||
	       k->display.situation == DISPLAY_NO_SCREEN || k->display.situation == DISPLAY_BUSY;
}
