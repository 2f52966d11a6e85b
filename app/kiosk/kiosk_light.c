/* SPDX-License-Identifier: MIT */
/* From the frames that the cameras hold to pictures, and from the fisheye's picture to light. */
#include <errno.h>

#include "app/kiosk/kiosk_parts.h"
#include "hal/base/clock.h"

/* ---- frames to pictures ---- */

bool kiosk_frames_are_due(const struct kiosk_inputs *in)
{
	const struct source *leader = eyes_leader(&in->eyes);

	if (!leader || !source_has_news(leader))
		return false;
	for (int i = 0; i < in->source_count; i++) {
		const struct source *source = &in->sources[i];

		if (source_is_open(source) && source->camera.on_demand && !source_has_news(source))
			return false;
	}
	return true;
}

struct kiosk_news kiosk_take_frames(struct kiosk_inputs *in, struct pipeline *pipeline, bool frames,
				    bool frozen)
{
	const struct source *leader = eyes_leader(&in->eyes);
	struct kiosk_news news = {.captured_ns = 0};

	for (int i = 0; i < in->source_count; i++) {
		struct source *source = &in->sources[i];
		const bool wanting = source->canvas.width > 0 && !source_has_picture(source);

		if (!source_has_news(source) || (!frames && !wanting))
			continue;
		if (frozen && source_has_picture(source)) {
			source_drop(source);
			continue;
		}
		if (!source_decode(source, clock_now_ns()))
			continue;
		if (source == in->eyes.fisheye.source) {
			news.fisheye = true;
			pipeline_expose(pipeline,
					exposing_take(&in->exposing, source, clock_now_ns()),
					in->exposing.ratio);
		}
		if (source == leader)
			news.captured_ns = source->picture_ns;
	}
	return news;
}

/* ---- views of the pictures ---- */

/* A view that does not fit is said, on the screen too: the camera may send something else later,
 * and cameras that were exchanged are seen at once. strict: it is an error, which that fault tells;
 * else NULL. */
static int say_fit(const struct eye *eye, int err, const struct fault *reason, struct fault *said,
		   struct fault *strict)
{
	if (err && strict)
		return fault_say(strict, err, "%s", reason->text);
	kiosk_complain(said, eye->section, err ? reason : NULL);
	return 0;
}

static int fit_eye(struct eye *eye, struct fault *said, struct fault *strict)
{
	struct fault reason = {.text = ""};
	int err = eye_fit(eye, &reason);

	return say_fit(eye, err, &reason, said, strict);
}

/* A background that is composited has to have the basis's size. */
static int fit_background(const struct kiosk_picture *picture, struct eye *eye, bool composited,
			  struct fault *said, struct fault *strict)
{
	struct fault reason = {.text = ""};
	int err = eye_fit(eye, &reason);

	if (!err && composited && eye_has_picture(eye)) {
		err = pipeline_fits(picture->pipeline, eye->view.width, eye->view.height, &reason);
		eye->unfit = err != 0;
	}
	return say_fit(eye, err, &reason, said, strict);
}

int kiosk_fit_eyes(struct kiosk_inputs *in, const struct kiosk_picture *picture, bool composited,
		   struct fault *strict)
{
	int err = fit_eye(&in->eyes.fisheye, &in->unfit[0], strict);

	if (!err)
		err = fit_background(picture, &in->eyes.background, composited, &in->unfit[1],
				     strict);
	if (!err)
		err = fit_eye(&in->eyes.scene, &in->unfit[2], strict);
	if (!err)
		err = fit_eye(&in->eyes.depth, &in->unfit[3], NULL); /* people have feet, too */
	return err;
}

/* ---- light ---- */

static int measure_fisheye(const struct eye *fisheye, struct pipeline *pipeline,
			   struct fault *fault)
{
	struct frame_reader reader;
	struct picture picture;

	if (fisheye->source->is_linear)
		return pipeline_light_linear(pipeline, &fisheye->source->linear, &fisheye->view,
					     fault);
	if (eye_read(fisheye, &reader))
		return pipeline_light_frame(pipeline, &reader, fault);
	picture = eye_picture(fisheye);
	return pipeline_light_picture(pipeline, &picture, fault);
}

/* Light that the fisheye clips may be seen on the ground of the background's picture. */
static void recover_from_ground(const struct eye *background, struct pipeline *pipeline)
{
	struct frame_reader reader;

	if (!pipeline_has_patch(pipeline) || !eye_has_picture(background))
		return;
	reader = eye_reader(background);
	pipeline_recover(pipeline, &reader);
}

/* Whether the pictures that light is measured in can be believed: the fisheye's, and the
 * background's where its ground tells of the light. Cameras that take several exposures do not
 * meter. */
static bool have_settled(const struct kiosk_inputs *in, const struct pipeline *pipeline)
{
	const struct eye *background = &in->eyes.background;
	const bool metering = in->exposing.count < 2;

	return eye_has_settled(&in->eyes.fisheye, metering) &&
	       (!pipeline_has_patch(pipeline) || !eye_has_picture(background) ||
		background->source == in->eyes.fisheye.source || eye_has_settled(background, true));
}

int kiosk_measure_light(struct kiosk_inputs *in, const struct kiosk_picture *picture,
			struct fault *fault)
{
	const struct eye *fisheye = &in->eyes.fisheye;
	struct fault reason = {.text = ""};
	int err;

	if (!eye_has_picture(fisheye))
		return 0;
	/* Frames on demand wait for it, so that runs do not differ. */
	err = pipeline_light_prepare(picture->pipeline, fisheye->view.width, fisheye->view.height,
				     fisheye->source->camera.on_demand, &reason);
	in->light_awaited = err == -EAGAIN;
	if (in->light_awaited || (!err && !have_settled(in, picture->pipeline)))
		return 0;
	if (!err)
		err = measure_fisheye(fisheye, picture->pipeline, &reason);
	if (!err || err == -ESTALE)
		exposing_judge(&in->exposing, fisheye->source,
			       pipeline_report(picture->pipeline).level, !err);
	if (err == -ESTALE)
		return 0;
	if (!err) {
		recover_from_ground(&in->eyes.background, picture->pipeline);
		pipeline_follow(picture->pipeline, fisheye->source->stamp_ns);
	}
	if (err && !picture->begun)
		return fault_say(fault, err, "%s", reason.text);
	kiosk_complain(&in->light_said, "light", err ? &reason : NULL);
	return 0;
}
