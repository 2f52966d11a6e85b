/* SPDX-License-Identifier: MIT */
/* The screen: opening it, losing it, its events. */
#include <errno.h>

#include "app/kiosk/kiosk_parts.h"
#include "drivers/drivers.h"
#include "hal/base/clock.h"

int kiosk_screen_open(struct kiosk *k, bool first, struct fault *fault)
{
	struct config_screen *wanted = k->config->screen;
	struct display_settings settings = wanted->settings;
	int driver = config_driver_index(k->config, CONFIG_DISPLAY, wanted->driver);
	struct kiosk_screen *screen = &k->screen;
	struct fault reason = {.text = ""};
	int err;

	show_size(k->controls.view, &k->inputs.eyes, k->picture.basis, &settings.picture_width,
		  &settings.picture_height);
	err = display_open(&screen->display, display_drivers[driver], &settings,
			   config_options(k->config, CONFIG_DISPLAY, wanted, driver), &reason);
	/* Two kiosks would wait for each other's end for ever. */
	if (err && first &&
	    (!display_may_return(screen->display.situation) ||
	     screen->display.situation == DISPLAY_BUSY))
		return fault_say(fault, err, "%s", reason.text);
	kiosk_complain(&screen->said, "screen", err ? &reason : NULL);
	screen->fit = (struct show_fit){.width = 0};
	screen->fitted = false;
	k->picture.redraw |= !err && !first;
	return 0;
}

static int close_screen(struct kiosk *k, struct fault *fault)
{
	struct kiosk_screen *screen = &k->screen;
	int err = loop_watch(&k->loop, SLOT_DISPLAY, -1, fault);

	(void)display_close(&screen->display, NULL); /* its error has been reported */
	screen->shown_before += screen->display.shown;
	screen->display.shown = 0;
	screen->submitted = screen->shown_before; /* pictures on their way are lost */
	return err;
}

int kiosk_screen_lost(struct kiosk *k, int err, struct fault *fault)
{
	struct kiosk_screen *screen = &k->screen;
	struct fault reason = *fault;
	/* A screen whose mode has changed is opened again at once; with the next tick if it had
	 * shown nothing, or one that always changes would keep the kiosk busy. */
	bool at_once = err == -ESTALE && screen->display.shown > 0;

	if (err != -ESTALE && !display_may_return(screen->display.situation))
		return err;
	kiosk_complain(&screen->said, "screen", &reason);
	err = close_screen(k, fault);
	if (err || !at_once)
		return err;
	return kiosk_screen_open(k, false, fault);
}

static void picture_shown(struct kiosk *k, const struct display_event *event)
{
	const struct source *first = eyes_leader(&k->inputs.eyes);
	double slower_hz = k->screen.display.rate_hz;

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
		int err = display_dispatch(&k->screen.display, &event, fault);

		if (err)
			return kiosk_screen_lost(k, err, fault);
		switch (event.kind) {
		case DISPLAY_SHOWN:
			picture_shown(k, &event);
			break;
		case DISPLAY_CLOSED:
			k->stop = true;
			break;
		case DISPLAY_EXPOSED:
			k->screen.submitted =
				kiosk_shown(&k->screen); /* pictures on their way are lost */
			k->picture.redraw = true;
			break;
		case DISPLAY_ACTION:
			if (rest_press(&k->rest, clock_now_ns()))
				break;
			kiosk_act(k,
				  &(struct button_press){
					  .action = (enum action)event.action,
					  .value = k->controls.choice.threshold.value,
					  .percent = k->controls.choice.threshold.percent},
				  NULL);
			break;
		default:
			return 0;
		}
	}
}

void kiosk_screen_fit(struct kiosk *k)
{
	struct kiosk_screen *screen = &k->screen;

	/* With scale = none the screen keeps its own size. */
	struct show_fit fit = {screen->display.width, screen->display.height, 1};

	if (screen->display.hidden || screen->display.off)
		return; /* it would refuse, and is asked once only */
	if (k->config->screen->scale == SCALE_FIT)
		fit = show_fit(k->controls.view, &k->inputs.eyes, k->picture.basis);
	if (fit.width == screen->fit.width && fit.height == screen->fit.height &&
	    fit.squash == screen->fit.squash)
		return;
	screen->fit = fit;
	screen->fitted = display_fit(&screen->display, fit.width, fit.height, fit.squash) == 0;
}

uint64_t kiosk_shown(const struct kiosk_screen *screen)
{
	return screen->shown_before + screen->display.shown;
}

const char *kiosk_screen_situation(const struct kiosk_screen *screen)
{
	return screen->display.off ? "off" : display_situation_names[screen->display.situation];
}

bool kiosk_screen_is_excused(const struct kiosk_screen *screen)
{
	const enum display_situation situation = screen->display.situation;

	if (screen->display.state)
		return screen->display.hidden || screen->display.off;
	return situation == DISPLAY_NO_DEVICE || situation == DISPLAY_NO_SCREEN ||
	       situation == DISPLAY_BUSY;
}
