/* SPDX-License-Identifier: MIT */
#include "app/kiosk/kiosk.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>

#include "app/kiosk/kiosk_parts.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"
#include "hal/device/camera.h"

/* Longest wait for the cameras before the first picture. Opening one may take 2 s
 * (hal/device/camera.h), and more on a busy machine. */
#define SETTLE_NS (10 * NS_PER_S)
/* The loop wakes every second. After a longer gap this program was stopped, and the silence of the
 * cameras in it means nothing. */
#define ABSENT_NS (2 * NS_PER_S)
/* After this time without a picture the next tick draws it again. */
#define STILL_NS (NS_PER_S / 2)

static int watch_all(struct kiosk *k, struct fault *fault)
{
	int err = 0;

	for (int i = 0; i < k->inputs.source_count && !err; i++)
		err = loop_watch(&k->loop, i, source_descriptor(&k->inputs.sources[i]), fault);
	if (!err && k->screen.display.state)
		err = loop_watch(&k->loop, SLOT_DISPLAY, display_descriptor(&k->screen.display),
				 fault);
	if (!err && k->controls.control)
		err = loop_watch(&k->loop, SLOT_CONTROL, control_descriptor(k->controls.control),
				 fault);
	for (int i = 0; i < k->controls.keypad_count && !err; i++) {
		if (k->controls.keypads[i].buttons.state)
			err = loop_watch(&k->loop, SLOT_BUTTONS + i,
					 buttons_descriptor(&k->controls.keypads[i].buttons),
					 fault);
	}
	return err;
}

/* A closed descriptor has to leave its slot before its number is used again. */
static int forget_if_closed(struct kiosk *k, int i, struct fault *fault)
{
	return source_is_open(&k->inputs.sources[i]) ? 0 : loop_watch(&k->loop, i, -1, fault);
}

static int take_source(struct kiosk *k, int i, int64_t now, struct fault *fault)
{
	struct source *source = &k->inputs.sources[i];
	struct fault reason = {.text = ""};
	bool first = !source->opening.tried;
	int err;

	source->kept = k->controls.frozen;
	err = source_take(source, now, &reason);

	/* Without depths people are told by their feet. */
	if (err && first && source != k->inputs.eyes.depth.source &&
	    camera_is_hopeless(source->opening.situation, err))
		return fault_say(fault, err, "camera %s: %s", source->settings.name, reason.text);
	if (err)
		source_complain(source, &reason);
	return forget_if_closed(k, i, fault);
}

static int tick_sources(struct kiosk *k, int64_t now, struct fault *fault)
{
	for (int i = 0; i < k->inputs.source_count; i++) {
		int err;

		source_watch(&k->inputs.sources[i], now);
		err = forget_if_closed(k, i, fault);
		if (err)
			return err;
		source_open(&k->inputs.sources[i]);
	}
	return 0;
}

/* Not with frames on demand: pictures in between would make runs differ. */
static bool stands_still(struct kiosk *k, int64_t now)
{
	const struct source *first = eyes_leader(&k->inputs.eyes);

	return now - k->picture.made_ns >= STILL_NS && !(first && first->camera.on_demand);
}

static void write_metrics(struct kiosk *k, int64_t now_ns, const struct pipeline_report *report)
{
	const struct display *display = &k->screen.display;
	const struct metrics_facts facts = {
		.stats = &k->stats,
		.report = report,
		.sources = k->inputs.sources,
		.source_count = k->inputs.source_count,
		.screen = kiosk_screen_situation(&k->screen),
		.screen_is_fine = display->state && !display->off && !display->hidden,
		.resting = k->rest.resting,
		.sysfs = SUPPLY_SYSFS,
	};

	if (metrics_write(&k->metrics, k->config->metrics.file, &facts, now_ns))
		k->stats.latency_peak_ns = 0;
}

static void write_stats(struct kiosk *k, int64_t now_ns)
{
	struct pipeline_report report;

	pipeline_find_lamps(k->picture.pipeline);
	report = pipeline_report(k->picture.pipeline);
	stats_line(&k->stats, now_ns, &report, k->inputs.sources, k->inputs.source_count);
	write_metrics(k, now_ns, &report);
}

/* Once a second. */
static int kiosk_tick(struct kiosk *k, struct fault *fault)
{
	int64_t now = clock_now_ns();
	int err = tick_sources(k, now, fault);

	if (!err)
		err = kiosk_control_open(k, false, fault);
	if (!err)
		err = kiosk_buttons_open(k, false, fault);
	if (!err && k->inputs.settled && !k->screen.display.state && !k->rest.resting)
		err = kiosk_screen_open(k, false, fault);
	if (err)
		return err;
	write_stats(k, now);
	log_tick();
	state_look(k->controls.state);
	kiosk_text(k);
	kiosk_snapshot_check(k);
	pipeline_try_again(k->picture.pipeline);
	k->picture.redraw |= !k->rest.resting && stands_still(k, now);
	if (k->inputs.settled && (k->rest.resting || kiosk_screen_is_excused(&k->screen))) {
		service_ready(&k->service);
		service_alive(&k->service, now);
	}
	return 0;
}

static int handle_events(struct kiosk *k, struct fault *fault)
{
	int64_t now = clock_now_ns();
	int err = 0;

	for (int i = 0; i < k->inputs.source_count; i++) {
		if (now - k->inputs.heard_ns >= ABSENT_NS)
			source_excuse(&k->inputs.sources[i], now);
	}
	k->inputs.heard_ns = now;
	for (int i = 0; i < k->inputs.source_count && !err; i++) {
		if (loop_ready(&k->loop, i))
			err = take_source(k, i, now, fault);
	}
	for (int i = 0; i < k->controls.keypad_count; i++) {
		if (loop_ready(&k->loop, SLOT_BUTTONS + i))
			kiosk_buttons_read(k, &k->controls.keypads[i]);
	}
	if (loop_ready(&k->loop, SLOT_CONTROL))
		kiosk_control_read(k);
	if (!err && loop_ready(&k->loop, SLOT_DISPLAY))
		err = kiosk_screen_events(k, fault);
	if (!err && k->loop.reload)
		kiosk_reload(k);
	if (!err && loop_ready(&k->loop, SLOT_READING))
		kiosk_reload_take(k);
	if (!err && k->loop.tick)
		err = kiosk_tick(k, fault);
	if (!err && k->inputs.settled && (k->loop.tick || k->rest.due))
		err = kiosk_rest_look(k, false, fault);
	return err;
}

/* Opens the screen once each camera has been tried, so that the first picture holds all of them and
 * a screen without a size of its own takes theirs. A run of so many frames waits for as long as
 * that takes: its pictures must not depend on how busy the machine is. */
static int kiosk_settle(struct kiosk *k, struct fault *fault)
{
	const bool waits = k->settings->frames || clock_now_ns() - k->start_ns < SETTLE_NS;
	int err;

	for (int i = 0; i < k->inputs.source_count && !k->rest.resting; i++) {
		if (!k->inputs.sources[i].opening.tried && waits)
			return 0;
	}
	k->inputs.settled = true;
	k->picture.redraw = !eyes_leader(&k->inputs.eyes);
	kiosk_text(k);
	err = kiosk_screen_open(k, true, fault);
	return !err && (k->rest.resting || *k->config->screen->cec)
		       ? kiosk_rest_look(k, true, fault)
		       : err;
}

static bool all_submitted(const struct kiosk *k)
{
	return k->settings->frames && k->screen.submitted >= k->settings->frames;
}

static bool is_over(const struct kiosk *k)
{
	return k->stop || k->loop.stop ||
	       (k->settings->frames && kiosk_shown(&k->screen) >= k->settings->frames);
}

static int go_round(struct kiosk *k, struct fault *fault)
{
	bool frames;
	int err = watch_all(k, fault);

	if (!err)
		err = loop_wait(&k->loop, fault);
	if (!err)
		err = handle_events(k, fault);
	if (!err && !k->inputs.settled)
		err = kiosk_settle(k, fault);
	if (err || is_over(k) || all_submitted(k) || !k->screen.display.state)
		return err;
	frames = kiosk_frames_are_due(&k->inputs);
	return frames || k->picture.redraw ? kiosk_make_picture(k, frames, fault) : 0;
}

static int kiosk_turn(struct kiosk *k, struct fault *fault)
{
	int err = 0;

	loop_start(&k->loop);
	k->start_ns = k->inputs.heard_ns = k->picture.made_ns = clock_now_ns();
	stats_start(&k->stats, k->start_ns);
	while (!err && !is_over(k))
		err = go_round(k, fault);
	if (!err && k->stats.line_frames)
		write_stats(k, clock_now_ns());
	return err;
}

int kiosk_run(const struct kiosk_settings *settings, struct fault *fault)
{
	struct kiosk *k = calloc(1, sizeof(*k));
	int err, close_err;

	if (!k)
		return fault_say(fault, -ENOMEM, "not enough memory");
	k->settings = settings;
	k->config = settings->config;
	/* Signals that must not end the kiosk: a write of statistics into a closed pipe, and two
	 * that mean nothing here. */
	signal(SIGPIPE, SIG_IGN);
	signal(SIGUSR1, SIG_IGN);
	signal(SIGUSR2, SIG_IGN);
	err = kiosk_open(k, fault);
	if (!err)
		err = kiosk_turn(k, fault);
	service_stopping(&k->service);
	close_err = kiosk_close(k, err ? NULL : fault);
	free(k);
	return err ? err : close_err;
}
