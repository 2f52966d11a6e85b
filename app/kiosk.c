#include "app/kiosk.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "app/kiosk_parts.h"
#include "hal/clock.h"
#include "hal/log.h"

/* ---- making a picture ---- */

/* The camera whose frames set the pace: the background's, or what there is without it. */
static struct source *leader(struct kiosk *k)
{
	struct source *candidates[] = {k->eyes.background.source, k->eyes.fisheye.source,
				       k->eyes.scene.source};

	for (int i = 0; i < 3; i++) {
		if (candidates[i] && source_is_open(candidates[i]))
			return candidates[i];
	}
	return NULL;
}

static bool frames_are_due(struct kiosk *k)
{
	const struct source *first = leader(k);

	if (!first || !source_has_news(first))
		return false;
	for (int i = 0; i < k->source_count; i++) {
		const struct source *source = &k->sources[i];

		if (source_is_open(source) && source->camera.on_demand && !source_has_news(source))
			return false;
	}
	return true;
}

/* Takes in what the cameras hold. lit: the fisheye's picture is a new one. */
static void decode_sources(struct kiosk *k, bool *lit)
{
	for (int i = 0; i < k->source_count; i++) {
		struct source *source = &k->sources[i];

		if (!source_has_news(source))
			continue;
		if (k->frozen && source_has_picture(source))
			source_drop(source);
		else if (source_decode(source) && source == k->eyes.fisheye.source)
			*lit = true;
	}
}

static int measure_light(struct kiosk *k, struct fault *fault)
{
	const struct eye *eye = &k->eyes.fisheye;
	struct picture picture;

	if (eye->source->is_linear)
		return pipeline_light_linear(&k->pipeline, &eye->source->linear, &eye->view, fault);
	picture = eye_picture(eye);
	return pipeline_light_picture(&k->pipeline, &picture, fault);
}

static int fit_eyes(struct kiosk *k, struct fault *fault)
{
	int err = eye_fit(&k->eyes.fisheye, fault);

	if (!err)
		err = eye_fit(&k->eyes.background, fault);
	if (!err)
		err = eye_fit(&k->eyes.scene, fault);
	return err;
}

static int draw(struct kiosk *k, const struct display_buffer *screen, struct fault *fault)
{
	const struct show_request request = {
		.what = k->what,
		.scale = (enum config_scale)k->config->screen->scale,
		.split = k->config->screen->split,
		.squash = 1,
	};
	struct pipeline_choice choice = k->choice;
	int err;

	/* An object without light would be a black hole in the picture: it waits for the fisheye.
	 */
	choice.object = choice.object && k->pipeline.lit;
	err = pipeline_choose(&k->pipeline, &choice, fault);
	if (err)
		return err;
	return show_draw(&k->show, &request, &k->pipeline, &k->eyes, screen, fault);
}

/* Once, when it works. */
static void announce(const struct kiosk *k)
{
	const struct basis_info_chunk *info = &k->basis.info;

	log_info("%s screen of %dx%d; basis of %ux%u, %u lights, %u pose%s",
		 k->config->screen->driver, k->display.width, k->display.height, info->width,
		 info->height, info->lights, info->poses, info->poses == 1 ? "" : "s");
}

/* A picture for the screen, if there is a buffer to draw in. frames: of what the cameras hold;
 * otherwise of what they gave before, so that cameras which go in step stay so. */
static int make_picture(struct kiosk *k, bool frames, struct fault *fault)
{
	struct display_buffer screen;
	int64_t start, decoded, sampled, stage_ns[STAGE_COUNT];
	const struct source *first = leader(k);
	bool lit = false;
	int err = display_acquire(&k->display, &screen);

	if (err == -EAGAIN)
		return 0;
	if (err)
		return fault_say(fault, err, "the screen is gone: %s", strerror(-err));
	start = clock_now_ns();
	if (frames)
		decode_sources(k, &lit);
	decoded = clock_now_ns();
	k->pipeline.sample_ns = k->pipeline.composite_ns = 0;
	err = fit_eyes(k, fault);
	if (!err && lit)
		err = measure_light(k, fault);
	if (err)
		return err;
	sampled = clock_now_ns();
	err = draw(k, &screen, fault);
	if (err)
		return err;
	err = display_submit(&k->display, &screen, first ? first->picture_ns : start, fault);
	if (err)
		return err;
	stage_ns[STAGE_DECODE] = decoded - start;
	stage_ns[STAGE_SAMPLE] = k->pipeline.sample_ns;
	stage_ns[STAGE_COMPOSITE] = k->pipeline.composite_ns;
	stage_ns[STAGE_SHOW] = clock_now_ns() - sampled - k->pipeline.composite_ns;
	stats_made(&k->stats, stage_ns);
	k->redraw = false;
	if (!k->submitted++)
		announce(k);
	return 0;
}

/* ---- events ---- */

static double within_codes(double level)
{
	return level < 0 ? 0 : level > 255 ? 255 : level;
}

/* Views that have nothing to show are passed over. */
static void next_view(struct kiosk *k)
{
	do
		k->what = (enum config_show)((k->what + 1) % SHOW_COUNT);
	while (k->what == SHOW_SCENE && !k->eyes.scene.source);
}

static void act(struct kiosk *k, enum action action, double value)
{
	double step = k->config->lights.threshold_step;

	switch (action) {
	case ACTION_THRESHOLD_UP:
		k->choice.threshold = within_codes(k->choice.threshold + step);
		break;
	case ACTION_THRESHOLD_DOWN:
		k->choice.threshold = within_codes(k->choice.threshold - step);
		break;
	case ACTION_THRESHOLD_SET:
		k->choice.threshold = within_codes(value);
		break;
	case ACTION_VIEW_NEXT:
		next_view(k);
		break;
	case ACTION_POSE_NEXT:
		k->choice.pose = (k->choice.pose + 1) % (int)k->basis.info.poses;
		break;
	case ACTION_OBJECT:
		k->choice.object = !k->choice.object;
		break;
	case ACTION_FREEZE:
		k->frozen = !k->frozen;
		break;
	case ACTION_QUIT:
		k->stop = true;
		break;
	default:
		return;
	}
	k->redraw = true;
}

static void handle_buttons(struct kiosk *k)
{
	struct button_press press;
	struct fault reason = {.text = ""};
	int err;

	while ((err = buttons_read(&k->buttons, &press, &reason)) == 0)
		act(k, press.action, press.value);
	if (err == -EAGAIN)
		return;
	log_warning("buttons: %s: %s; going on without", k->config->buttons->driver, reason.text);
	buttons_close(&k->buttons);
}

static int handle_display(struct kiosk *k, struct fault *fault)
{
	struct display_event event;
	int err;

	for (;;) {
		err = display_dispatch(&k->display, &event, fault);
		if (err || event.kind == DISPLAY_NOTHING)
			return err;
		if (event.kind == DISPLAY_SHOWN)
			stats_shown(&k->stats, event.time_ns - event.token);
		else if (event.kind == DISPLAY_CLOSED)
			k->stop = true;
		else
			act(k, (enum action)event.action, k->choice.threshold);
	}
}

static int watch_all(struct kiosk *k, struct fault *fault)
{
	int err = 0;

	for (int i = 0; i < k->source_count && !err; i++)
		err = loop_watch(&k->loop, i, source_descriptor(&k->sources[i]), fault);
	if (!err)
		err = loop_watch(&k->loop, SLOT_DISPLAY, display_descriptor(&k->display), fault);
	if (!err)
		err = loop_watch(&k->loop, SLOT_BUTTONS,
				 k->buttons.state ? buttons_descriptor(&k->buttons) : -1, fault);
	return err;
}

/* Once a second. */
static int tick(struct kiosk *k, struct fault *fault)
{
	int64_t now = clock_now_ns();

	for (int i = 0; i < k->source_count; i++) {
		struct source *source = &k->sources[i];
		struct fault reason = {.text = ""};
		int err;

		source_watch(source, now);
		if (source_is_open(source))
			continue;
		/* Its descriptor's number may come back with the new one. */
		err = loop_watch(&k->loop, i, -1, fault);
		if (err)
			return err;
		err = source_open(source, &reason);
		if (err)
			source_complain(source, &reason);
	}
	stats_line(&k->stats, now, &k->pipeline, k->sources, k->source_count);
	return 0;
}

static int handle_events(struct kiosk *k, struct fault *fault)
{
	int64_t now = clock_now_ns();
	int err = 0;

	for (int i = 0; i < k->source_count; i++) {
		if (loop_ready(&k->loop, i))
			source_take(&k->sources[i], now);
	}
	if (k->buttons.state && loop_ready(&k->loop, SLOT_BUTTONS))
		handle_buttons(k);
	if (loop_ready(&k->loop, SLOT_DISPLAY))
		err = handle_display(k, fault);
	if (!err && k->loop.tick)
		err = tick(k, fault);
	return err;
}

static bool all_submitted(const struct kiosk *k)
{
	return k->settings->frames && k->submitted >= k->settings->frames;
}

static bool is_over(const struct kiosk *k)
{
	return k->stop || k->loop.stop ||
	       (k->settings->frames && k->display.shown >= k->settings->frames);
}

static int turn(struct kiosk *k, struct fault *fault)
{
	bool frames;
	int err = 0;

	loop_start(&k->loop);
	stats_start(&k->stats, clock_now_ns());
	while (!err && !is_over(k)) {
		err = watch_all(k, fault);
		if (!err)
			err = loop_wait(&k->loop, fault);
		if (!err)
			err = handle_events(k, fault);
		if (err || is_over(k) || all_submitted(k))
			continue;
		frames = frames_are_due(k);
		if (frames || k->redraw)
			err = make_picture(k, frames, fault);
	}
	if (!err && k->stats.line_frames)
		stats_line(&k->stats, clock_now_ns(), &k->pipeline, k->sources, k->source_count);
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
	signal(SIGPIPE,
	       SIG_IGN); /* statistics into a pipe that was closed must not end the kiosk */
	err = kiosk_open(k, fault);
	if (!err)
		err = turn(k, fault);
	close_err = kiosk_close(k, err ? NULL : fault);
	free(k);
	return err ? err : close_err;
}
