/* SPDX-License-Identifier: MIT */
/* From what the cameras hold to a picture on the screen. */
#include <errno.h>
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

/* ---- time of each stage ---- */

struct stage_clock {
	int64_t start_ns, last_ns; /* of the picture; end of the last stage */
	int64_t ns[STAGE_COUNT];
};

static struct stage_clock stages_begin(void)
{
	const int64_t now_ns = clock_now_ns();

	return (struct stage_clock){.start_ns = now_ns, .last_ns = now_ns};
}

/* Adds the time since the last call to a stage. */
static void stage_end(struct stage_clock *clock, enum stage stage)
{
	const int64_t now_ns = clock_now_ns();

	clock->ns[stage] += now_ns - clock->last_ns;
	clock->last_ns = now_ns;
}

/* ---- cameras ---- */

bool kiosk_frames_are_due(struct kiosk *k)
{
	const struct source *first = eyes_leader(&k->eyes);

	if (!first || !source_has_news(first))
		return false;
	for (int i = 0; i < k->source_count; i++) {
		const struct source *source = &k->sources[i];

		if (source_is_open(source) && source->camera.on_demand && !source_has_news(source))
			return false;
	}
	return true;
}

/* What a picture was made of. */
struct taken {
	int64_t captured_ns; /* of the frame that set the pace; 0: of nothing new */
	bool lit;	     /* the fisheye's picture is a new one */
};

/* frames: all that is held; otherwise only where there is no picture without. */
static void decode_sources(struct kiosk *k, bool frames, struct taken *taken)
{
	const struct source *first = eyes_leader(&k->eyes);

	for (int i = 0; i < k->source_count; i++) {
		struct source *source = &k->sources[i];
		const bool wanting = source->canvas.width > 0 && !source_has_picture(source);

		if (!source_has_news(source) || (!frames && !wanting))
			continue;
		if (k->frozen && source_has_picture(source)) {
			source_drop(source);
			continue;
		}
		if (!source_decode(source, clock_now_ns()))
			continue;
		if (source == k->eyes.fisheye.source) {
			taken->lit = true;
			pipeline_expose(&k->pipeline,
					exposing_take(&k->exposing, source, clock_now_ns()),
					k->exposing.ratio);
		}
		if (source == first)
			taken->captured_ns = source->picture_ns;
	}
}

static int fit_eye(struct kiosk *k, struct eye *eye, struct fault *said, struct fault *fault)
{
	struct fault reason = {.text = ""};
	int err = eye_fit(eye, &reason);

	if (!err && eye == &k->eyes.background && eye_has_picture(eye) &&
	    show_needs(k->what)->composite) {
		err = pipeline_fits(&k->pipeline, eye->view.width, eye->view.height, &reason);
		eye->unfit = err != 0;
	}
	/* At the start the configuration is wrong; later the camera sends something else, and may
	 * come to its senses. */
	if (err && !k->begun)
		return fault_say(fault, err, "%s", reason.text);
	kiosk_complain(said, eye->section, err ? &reason : NULL);
	return 0;
}

static int fit_eyes(struct kiosk *k, struct fault *fault)
{
	int err = fit_eye(k, &k->eyes.fisheye, &k->unfit[0], fault);

	if (!err)
		err = fit_eye(k, &k->eyes.background, &k->unfit[1], fault);
	if (!err)
		err = fit_eye(k, &k->eyes.scene, &k->unfit[2], fault);
	return err;
}

static int measure(struct kiosk *k, struct fault *fault)
{
	const struct eye *eye = &k->eyes.fisheye;
	struct frame_reader reader;
	struct picture picture;

	if (eye->source->is_linear)
		return pipeline_light_linear(&k->pipeline, &eye->source->linear, &eye->view, fault);
	if (eye_read(eye, &reader))
		return pipeline_light_frame(&k->pipeline, &reader, fault);
	picture = eye_picture(eye);
	return pipeline_light_picture(&k->pipeline, &picture, fault);
}

/* What the fisheye clips may be seen on the ground. */
static void recover(struct kiosk *k)
{
	const struct eye *eye = &k->eyes.background;
	struct frame_reader reader;
	struct picture picture;

	if (!k->pipeline.ground || !eye_has_picture(eye))
		return;
	if (!eye_read(eye, &reader)) {
		picture = eye_picture(eye);
		reader = frame_reader_of(&picture);
	}
	pipeline_recover(&k->pipeline, &reader);
}

/* A sky that cannot be measured leaves the light as it was, and so does a picture whose exposure is
 * not known. */
static int measure_light(struct kiosk *k, struct fault *fault)
{
	struct fault reason = {.text = ""};
	int err;

	if (!eye_has_picture(&k->eyes.fisheye))
		return 0;
	err = measure(k, &reason);
	if (!err || err == -ESTALE)
		exposing_judge(&k->exposing, k->eyes.fisheye.source, k->pipeline.level, !err);
	if (err == -ESTALE)
		return 0;
	if (!err) {
		recover(k);
		pipeline_follow(&k->pipeline, k->eyes.fisheye.source->stamp_ns);
	}
	if (err && !k->begun)
		return fault_say(fault, err, "%s", reason.text);
	kiosk_complain(&k->light_said, "light", err ? &reason : NULL);
	return 0;
}

/* A frozen picture is old because somebody wants it so. */
static bool is_blank(const struct kiosk *k, int64_t now)
{
	const struct source *source = k->eyes.background.source;
	int64_t fresh = source && source->fresh_ns ? source->fresh_ns : k->start_ns;
	double limit = k->config->screen->blank_after_s;

	return limit > 0 && !k->frozen && (double)(now - fresh) > limit * (double)NS_PER_S;
}

/* A timeline goes by the time at which frames were captured, so that the object moves with what is
 * behind it. Its first frame is where it begins. */
static void follow_timeline(struct kiosk *k)
{
	const struct source *leader = eyes_leader(&k->eyes);
	struct timeline_place at;

	if (!leader)
		return;
	k->stamp_ns = leader->stamp_ns;
	if (!k->timed) {
		k->timed = true;
		kiosk_take_pose(k, k->choice.pose);
	}
	if (k->timeline.kind == TIMELINE_NONE)
		return;
	at = timeline_at(&k->timeline, k->stamp_ns);
	k->choice.pose = at.pose;
	k->choice.next = at.next;
	k->choice.share = k->config->poses.fade && at.next != at.pose ? at.share : 0;
}

/* Each pose once, and once more when it is there: a timeline comes by all of them again and again.
 */
static void complain_of_pose(struct kiosk *k)
{
	const struct pipeline *p = &k->pipeline;

	if (p->missing >= 0 && !k->pose_said[p->missing]) {
		log_warning("pose %d: %s; what was shown before stays", p->missing,
			    p->trouble.text);
		k->pose_said[p->missing] = true;
	}
	if (k->pose_said[p->choice.pose]) {
		log_info("pose %d: fine again", p->choice.pose);
		k->pose_said[p->choice.pose] = false;
	}
}

/* Which light and which pose the picture is made of. */
static int choose_picture(struct kiosk *k, struct fault *fault)
{
	const struct source *leader = eyes_leader(&k->eyes);
	struct pipeline_choice choice = k->choice;
	int err;

	/* An object without light would be a black hole in the picture: it waits for the fisheye.
	 */
	choice.object = choice.object && k->pipeline.lit;
	/* There is nothing to be late for without a camera's pace. */
	choice.hold = leader && leader->situation == CAMERA_FINE && !leader->camera.on_demand;
	err = pipeline_choose(&k->pipeline, &choice, fault);
	if (!err)
		complain_of_pose(k);
	return err;
}

/* ---- composite and screen ---- */

static struct show_picture picture_of(const struct eye *eye, bool needed)
{
	if (!needed || !eye_has_picture(eye))
		return (struct show_picture){.squash = 1};
	return (struct show_picture){eye_picture(eye), eye->view.squash};
}

static struct show_pictures pictures_for(const struct kiosk *k, enum config_show what)
{
	const struct show_needs *needs = show_needs(what);
	const struct eye *background = &k->eyes.background;
	struct show_pictures pictures = {
		.fisheye = picture_of(&k->eyes.fisheye, needs->fisheye),
		.background = picture_of(background, needs->background),
		.scene = picture_of(&k->eyes.scene, needs->scene),
	};

	if (eye_has_picture(background))
		pictures.composite = (struct show_composite){.width = background->view.width,
							     .height = background->view.height,
							     .squash = background->view.squash};
	if (k->pipeline.lit)
		pictures.marks = (struct show_marks){&k->pipeline.dome, &k->pipeline.lens,
						     k->pipeline.selection.used};
	return pictures;
}

/* The background is read from the camera's own memory while the compositor goes over it, unless a
 * view has had it converted whole. */
static int composite(struct kiosk *k, const struct show_composite *to, struct fault *fault)
{
	const struct eye *eye = &k->eyes.background;
	struct frame_reader reader;
	struct backdrop backdrop;
	struct picture picture;

	if (eye_read(eye, &reader)) {
		backdrop = (struct backdrop){.width = eye->view.width,
					     .height = eye->view.height,
					     .make = frame_reader_make,
					     .context = &reader};
	} else {
		picture = eye_picture(eye);
		backdrop = backdrop_of(&picture);
	}
	return pipeline_composite(&k->pipeline, &backdrop, to->pixels, to->stride, fault);
}

/* Composites, and places the view's pictures. */
static int draw_screen(struct kiosk *k, const struct display_buffer *screen,
		       struct stage_clock *stages, struct fault *fault)
{
	const struct show_request request = {
		.what = is_blank(k, stages->start_ns) ? SHOW_OFF : k->what,
		.scale = (enum config_scale)k->config->screen->scale,
		.split = k->split,
		.squash = k->fitted ? k->fit.squash : 1,
		.overlay = &k->overlay,
		.pool = k->pipeline.pool,
	};
	struct show_pictures pictures = pictures_for(k, request.what);
	int err = show_room(&k->show, &request, &pictures.composite, screen, fault);

	stage_end(stages, STAGE_SHOW);
	if (!err && pictures.composite.pixels)
		err = composite(k, &pictures.composite, fault);
	stage_end(stages, STAGE_COMPOSITE);
	return err ? err : show_draw(&k->show, &request, &pictures, screen, fault);
}

/* Once, when it works. */
static void announce(const struct kiosk *k)
{
	const struct basis_info_chunk *info = &k->basis.info;

	log_info("%s screen of %dx%d; basis of %ux%u, %u lights, %u pose%s",
		 k->config->screen->driver, k->display.width, k->display.height, info->width,
		 info->height, info->lights, info->poses, info->poses == 1 ? "" : "s");
}

int kiosk_make_picture(struct kiosk *k, bool frames, struct fault *fault)
{
	struct display_buffer screen;
	struct taken taken = {.captured_ns = 0};
	struct stage_clock stages;
	int err;

	kiosk_screen_fit(k);
	err = display_acquire(&k->display, &screen);
	if (err == -EAGAIN)
		return 0;
	if (err) {
		fault_say(fault, err, "the screen is gone: %s", strerror(-err));
		return kiosk_screen_lost(k, err, fault);
	}
	stages = stages_begin();
	decode_sources(k, frames, &taken);
	err = fit_eyes(k, fault);
	stage_end(&stages, STAGE_DECODE);
	if (!err && taken.lit)
		err = measure_light(k, fault);
	if (err)
		return err;
	stage_end(&stages, STAGE_SAMPLE);
	if (taken.captured_ns)
		follow_timeline(k);
	err = choose_picture(k, fault);
	if (!err)
		err = draw_screen(k, &screen, &stages, fault);
	if (err)
		return err;
	err = display_submit(&k->display, &screen, taken.captured_ns, fault);
	if (err)
		return kiosk_screen_lost(k, err, fault);
	stage_end(&stages, STAGE_SHOW);
	k->made_ns = stages.last_ns;
	stats_made(&k->stats, taken.captured_ns, stages.ns);
	k->redraw = false;
	k->submitted++;
	if (!k->begun)
		announce(k);
	k->begun = true;
	return 0;
}
