/* SPDX-License-Identifier: MIT */
/* Outside of [screen] hours: the screen is switched off and the cameras are closed. */
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>

#include "app/kiosk/kiosk_parts.h"
#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

void kiosk_rest_begin(struct kiosk *k)
{
	char here[HOURS_MOMENT_MAX];

	k->rest.built = INLAY_BUILT;
	rest_take_hours(&k->rest, k->config->screen->hours);
	k->rest.resting = rest_is_due(&k->rest, time(NULL), clock_now_ns());
	if (k->rest.hours.count) {
		config_hours_moment(config_hours_minute(time(NULL)), here);
		log_info("[screen] hours: it is %s here", here);
	}
}

struct television {
	char cec[INI_PATH_MAX];
	bool on;
};

/* Runs on a thread of its own: an adapter that hangs takes longer than the service's watchdog
 * waits. */
static void *television_tell(void *context)
{
	struct television *television = context;
	struct fault why = {.text = ""};

	if (cec_switch(television->cec, television->on, &why))
		log_warning_once("[screen] cec: %s", why.text);
	free(television);
	return NULL;
}

static void switch_television(const char *cec, bool on)
{
	struct television *television = *cec ? malloc(sizeof(*television)) : NULL;
	pthread_t thread;

	if (!television)
		return;
	snprintf(television->cec, sizeof(television->cec), "%s", cec);
	television->on = on;
	if (pthread_create(&thread, NULL, television_tell, television))
		free(television);
	else
		pthread_detach(thread);
}

/* A screen that cannot be switched off, or is not to be, is drawn black. */
static int switch_screen(struct kiosk *k, bool on, struct fault *fault)
{
	const bool switches = on || k->config->screen->hours_off == HOURS_OFF_SIGNAL;
	struct fault reason = {.text = ""};
	int err = k->screen.display.state && switches
			  ? display_power(&k->screen.display, on, &reason)
			  : 0;

	switch_television(k->config->screen->cec, on);
	k->picture.redraw = true;
	k->screen.submitted = kiosk_shown(&k->screen); /* pictures on their way are lost */
	if (!err || err == -ENOTSUP)
		return 0;
	fault_say(fault, err, "%s", reason.text);
	return kiosk_screen_lost(k, err, fault);
}

/* A descriptor has to leave its slot before it is closed and its number is used again. */
static void rest_sources(struct kiosk *k, bool resting)
{
	for (int i = 0; i < k->inputs.source_count; i++) {
		if (resting)
			(void)loop_watch(&k->loop, i, -1, NULL);
		source_rest(&k->inputs.sources[i], resting);
		source_open(&k->inputs.sources[i]);
	}
}

static void say_rest(const struct kiosk *k)
{
	char next[HOURS_MOMENT_MAX];

	rest_next(&k->rest, time(NULL), next);
	if (k->rest.resting)
		log_info("at rest until %s: the screen is %s, the cameras are closed", next,
			 k->config->screen->hours_off == HOURS_OFF_BLACK ? "black" : "off");
	else if (k->rest.awake_until_ns > clock_now_ns())
		log_info("awake for %d minutes, as a button or a command asks", REST_WAKE_MINUTES);
	else
		log_info("awake%s%s", *next ? " until " : "", next);
}

int kiosk_rest_look(struct kiosk *k, bool first, struct fault *fault)
{
	const bool due = rest_is_due(&k->rest, time(NULL), clock_now_ns());

	k->rest.due = false;
	if (due == k->rest.resting && !first)
		return 0;
	k->rest.resting = due;
	say_rest(k);
	rest_sources(k, due);
	if (due)
		pipeline_forget_light(
			k->picture.pipeline); /* morning is not lit as the evening was */
	return switch_screen(k, !due, fault);
}
