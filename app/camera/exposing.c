/* SPDX-License-Identifier: MIT */
#include "app/camera/eye.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "hal/base/clock.h"
#include "hal/base/log.h"

/* turns of all exposures after which wrong ones are counted */
#define TURNS_JUDGED 8

void exposing_start(struct exposing *e, const struct config_fisheye *config)
{
	*e = (struct exposing){.config = config, .count = config_exposures(config)};
	for (int k = 0; k < e->count; k++) {
		e->used[k] = config->exposures[k];
		e->ratio[k] = config->exposures[k] / config->exposures[0];
	}
}

static void schedule_begin(struct exposing *e, int delay)
{
	exposure_schedule_begin(&e->schedule, e->count, delay);
	e->judged = e->unfit = 0;
}

static int ask_exposure(struct exposing *e, struct source *source, int exposure,
			struct fault *fault)
{
	double used = e->config->exposures[exposure];
	char value[40];
	int err;

	snprintf(value, sizeof(value), "%.10g", used);
	err = source_control(source, e->config->exposure_control, value, &used, fault);
	if (!err)
		e->used[exposure] = used;
	return err;
}

/* Refuses a camera whose steps are so wide that two exposures are one. */
static int compare_taken(struct exposing *e, struct fault *fault)
{
	const double *wanted = e->config->exposures, *used = e->used;

	for (int k = 1; k < e->count; k++) {
		if (!(used[k] > 0 && used[k] < used[k - 1]))
			return fault_say(fault, -ERANGE,
					 "it makes %g of an exposure of %g, and %g of %g",
					 used[k - 1], wanted[k - 1], used[k], wanted[k]);
	}
	for (int k = 1; k < e->count; k++)
		e->ratio[k] = used[k] / used[0];
	return 0;
}

/* Stays at one exposure. Logs each trouble once, not at every opening. */
static void give_up(struct exposing *e, struct source *source, const char *why)
{
	struct fault fault = {.text = ""}, ignored = {.text = ""};

	fault_say(&fault, -EIO, "%s: it stays at one exposure", why);
	if (strcmp(fault.text, e->said.text) != 0)
		log_warning("camera %s: %s", source->settings.name, fault.text);
	e->said = fault;
	e->single = true;
	/* A camera that has never obeyed shows one exposure all the time, without delay. */
	exposure_schedule_begin(&e->schedule, 1, e->asked ? EXPOSURE_DELAY_MAX : 0);
	if (e->asked)
		(void)ask_exposure(e, source, 0, &ignored);
	exposure_schedule_asked(&e->schedule, 0, -1);
}

/* Estimates how many frames the camera has captured since the picture: its age beyond the shortest
 * one so far, in frames. */
static int frames_ahead(struct exposing *e, const struct source *source, int64_t now_ns)
{
	const double rate_hz = source->camera.rate_hz;
	const int64_t waited_ns = now_ns - source->picture_ns;

	if (source->camera.on_demand || rate_hz <= 0 || waited_ns < 0)
		return 0;
	if (!e->least_ns || waited_ns < e->least_ns)
		e->least_ns = waited_ns;
	return (int)((double)(waited_ns - e->least_ns) * rate_hz / (double)NS_PER_S);
}

static void ask_next(struct exposing *e, struct source *source, int64_t now_ns)
{
	const int next = exposure_schedule_next(&e->schedule);
	const int ahead = frames_ahead(e, source, now_ns);
	struct fault fault = {.text = ""};
	int err;

	if (next < 0)
		return;
	err = ask_exposure(e, source, next, &fault);
	e->asked |= !err;
	if (!err)
		err = compare_taken(e, &fault);
	if (err) {
		give_up(e, source, fault.text);
		return;
	}
	exposure_schedule_asked(&e->schedule, next, ahead);
}

int exposing_take(struct exposing *e, struct source *source, int64_t now_ns)
{
	if (e->count < 2)
		return 0;
	if (e->opening != source->opening.count) {
		e->opening = source->opening.count;
		e->asked = e->single = false;
		e->least_ns = 0;
		schedule_begin(e, config_exposure_delay(e->config));
	}
	e->exposure = exposure_schedule_take(&e->schedule, source->sequence);
	if (source_is_open(source) && !e->single)
		ask_next(e, source, now_ns);
	if (e->single && !e->asked)
		e->exposure = 0;
	return e->exposure;
}

void exposing_judge(struct exposing *e, struct source *source, double level, bool fits)
{
	const bool measuring = e->count > 1 && !e->single && e->schedule.delay < 0;

	if (measuring && exposure_schedule_measure(&e->schedule, level))
		give_up(e, source, "its exposures are not seen in its pictures");
	else if (measuring && e->schedule.delay >= 0)
		log_info_paced("camera %s: another exposure is seen after %d frames",
			       source->settings.name, e->schedule.delay);
	if (measuring || e->count < 2 || e->single || e->exposure < 0)
		return;
	e->judged++;
	e->unfit += !fits;
	if (e->judged < TURNS_JUDGED * e->count)
		return;
	if (e->unfit * 3 >= e->judged) {
		log_info_paced(
			"camera %s: %d of %d pictures have another exposure than they should; how long it takes is measured",
			source->settings.name, e->unfit, e->judged);
		schedule_begin(e, -1);
	}
	e->judged = e->unfit = 0;
}
