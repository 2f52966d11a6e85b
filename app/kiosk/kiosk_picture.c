/* SPDX-License-Identifier: MIT */
/* From light and background to a picture on the screen, with the time of each stage. */
#include <errno.h>
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

#define DEPTH_APART_NS (NS_PER_S / 5) /* from the background's picture; else depths are not used */

/* ---- time of each stage ---- */

struct stage_clock {
	int64_t start_ns, last_ns; /* when the picture was begun; when the last stage ended */
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

/* ---- what is shown ---- */

/* [screen] blank_after: the background's picture is too old to be shown. A frozen picture is old on
 * purpose. */
static bool is_screen_blank(const struct kiosk *k, int64_t now)
{
	const struct source *source = k->inputs.eyes.background.source;
	int64_t fresh = source && source->fresh_ns ? source->fresh_ns : k->start_ns;
	double limit = k->config->screen->blank_after_s;

	return limit > 0 && !k->controls.frozen && (double)(now - fresh) > limit * (double)NS_PER_S;
}

/* Chooses the poses of the timeline. It follows the time at which frames are captured, so that the
 * object moves with the background, and begins with the first frame. */
static void follow_timeline(struct kiosk *k)
{
	const struct source *leader = eyes_leader(&k->inputs.eyes);
	struct timeline_place at;

	if (!leader)
		return;
	k->controls.stamp_ns = leader->stamp_ns;
	if (!k->controls.timed) {
		k->controls.timed = true;
		kiosk_take_pose(k, k->controls.choice.pose);
	}
	if (k->controls.timeline.kind == TIMELINE_NONE)
		return;
	at = timeline_at(&k->controls.timeline, k->controls.stamp_ns);
	k->controls.choice.pose = at.pose;
	k->controls.choice.next = at.next;
	k->controls.choice.share = k->config->poses.fade && at.next != at.pose ? at.share : 0;
}

/* Logs a missing pose once until it is there, because a timeline comes back to each pose again and
 * again. */
static void complain_of_pose(struct kiosk_picture *picture)
{
	const int missing = pipeline_report(picture->pipeline).missing;
	const int shown = pipeline_report(picture->pipeline).pose;

	if (missing >= 0 && !picture->pose_said[missing]) {
		log_warning("pose %d: %s; what was shown before stays", missing,
			    pipeline_trouble(picture->pipeline));
		picture->pose_said[missing] = true;
	}
	if (picture->pose_said[shown]) {
		log_info("pose %d: fine again", shown);
		picture->pose_said[shown] = false;
	}
}

/* Chooses light and pose of the picture. */
static int choose_picture(struct kiosk *k, struct fault *fault)
{
	const struct source *leader = eyes_leader(&k->inputs.eyes);
	struct pipeline_choice choice = k->controls.choice;
	int err;

	/* Without light the object would be black: it is left out until the fisheye has a
	 * picture. */
	choice.object = choice.object && pipeline_report(k->picture.pipeline).lit;
	/* While a camera sets the pace, no picture waits for a pose to be loaded. */
	choice.hold = leader && leader->opening.situation == CAMERA_FINE &&
		      !leader->camera.on_demand;
	err = pipeline_choose(k->picture.pipeline, &choice, fault);
	if (!err)
		complain_of_pose(&k->picture);
	return err;
}

/* ---- composite and screen ---- */

static struct show_picture eye_shown(const struct eye *eye, bool needed)
{
	if (!needed || !eye_has_picture(eye))
		return (struct show_picture){.squash = 1};
	return (struct show_picture){eye_picture(eye), eye->view.squash};
}

/* What SHOW_GUIDE draws; the camera is read again for each of its pictures, as the basis may
 * change. */
static struct show_guide guide_for(const struct config *config, struct kiosk_picture *picture)
{
	const int pose = pipeline_report(picture->pipeline).pose;
	struct show_guide guide = {.coverage = picture->basis->poses[pose].coverage,
				   .lamps = {&config->lamps,
					     (const char(*)[CONFIG_NAME_MAX])config->lamp_name,
					     pipeline_missing_lamps(picture->pipeline)}};

	if (!tsai_read_text(picture->basis->camera, &picture->camera, NULL))
		guide.camera = &picture->camera;
	return guide;
}

static struct show_pictures pictures_for(const struct eyes *eyes, const struct pipeline *pipeline,
					 enum config_show view)
{
	const struct show_needs *needs = show_needs(view);
	const struct view *background = &eyes->background.view;
	struct show_pictures pictures = {
		.fisheye = eye_shown(&eyes->fisheye, needs->fisheye),
		.background = eye_shown(&eyes->background, needs->background),
		.scene = eye_shown(&eyes->scene, needs->scene),
	};

	if (eye_has_picture(&eyes->background))
		pictures.composite = (struct show_composite){background->width, background->height,
							     .squash = background->squash};
	if (pipeline_report(pipeline).lit)
		pictures.marks =
			(struct show_marks){pipeline_dome(pipeline), pipeline_lens(pipeline),
					    pipeline_used(pipeline), pipeline_radiance(pipeline)};
	return pictures;
}

/* Whether depths were captured with the background's picture. Frames on demand are in step. */
static bool are_of_now(const struct source *depth, const struct source *background)
{
	const int64_t apart_ns = depth->picture_ns - background->picture_ns;

	return depth->camera.on_demand ||
	       (apart_ns >= -DEPTH_APART_NS && apart_ns <= DEPTH_APART_NS);
}

/* Looks for people and noise in the background, which is converted whole for it. */
static void look_at_background(struct kiosk_inputs *in, const struct config *config,
			       struct pipeline *pipeline)
{
	const struct eye *background = &in->eyes.background, *depth = &in->eyes.depth;
	struct picture picture;
	struct depth_map map;

	if (!pipeline_looks(pipeline) || !eye_has_picture(background))
		return;
	in->depth_used = eye_depth(depth, config->depth.unit_mm / 1000, &map) &&
			 are_of_now(depth->source, background->source);
	picture = eye_picture(background);
	pipeline_look(pipeline, &picture, in->depth_used ? &map : NULL,
		      background->source->stamp_ns);
}

/* The compositor reads the background from the camera's own memory, unless a view has had it
 * converted whole. */
static int composite_background(const struct eye *background, struct pipeline *pipeline,
				const struct show_composite *to, struct fault *fault)
{
	struct frame_reader reader;
	struct backdrop backdrop;
	struct picture picture;

	if (eye_read(background, &reader)) {
		backdrop = (struct backdrop){.width = background->view.width,
					     .height = background->view.height,
					     .make = frame_reader_make,
					     .context = &reader};
	} else {
		picture = eye_picture(background);
		backdrop = backdrop_of(&picture);
	}
	return pipeline_composite(pipeline, &backdrop, to->pixels, to->stride, fault);
}

/* Composites, and draws the view with the composite in it. */
static int draw_screen(struct kiosk *k, const struct display_buffer *screen,
		       struct stage_clock *stages, struct fault *fault)
{
	const struct show_request request = {
		.view = k->rest.resting || is_screen_blank(k, stages->start_ns) ? SHOW_OFF
										: k->controls.view,
		.scale = (enum config_scale)k->config->screen->scale,
		.split = k->controls.split,
		.squash = k->screen.fitted ? k->screen.fit.squash : 1,
		.overlay = k->rest.resting ? NULL : &k->picture.overlay,
		.pool = pipeline_pool(k->picture.pipeline),
	};
	struct show_pictures pictures = pictures_for(&k->inputs.eyes, k->picture.pipeline,
						     request.view);
	int err = show_room(&k->picture.show, &request, &pictures.composite, screen, fault);

	if (request.view == SHOW_GUIDE)
		pictures.guide = guide_for(k->config, &k->picture);

	stage_end(stages, STAGE_SHOW);
	if (!err && pictures.composite.pixels)
		look_at_background(&k->inputs, k->config, k->picture.pipeline);
	stage_end(stages, STAGE_PEOPLE);
	if (!err && pictures.composite.pixels)
		err = composite_background(&k->inputs.eyes.background, k->picture.pipeline,
					   &pictures.composite, fault);
	stage_end(stages, STAGE_COMPOSITE);
	return err ? err : show_draw(&k->picture.show, &request, &pictures, screen, fault);
}

/* Logs the sizes, with the first picture. */
static void announce_screen(const struct kiosk *k)
{
	const struct basis_info_chunk *info = &k->picture.basis->info;

	log_info("%s screen of %dx%d; basis of %ux%u, %u lights, %u pose%s%s",
		 k->config->screen->driver, k->screen.display.width, k->screen.display.height,
		 info->width, info->height, info->lights, info->poses, info->poses == 1 ? "" : "s",
		 basis_is_preview(k->picture.basis) ? ", a preview" : "");
}

/* Draws the screen, in memory first where a client waits for what it shows. */
static int draw_shown(struct kiosk *k, const struct display_buffer *screen,
		      struct stage_clock *stages, struct fault *fault)
{
	struct display_buffer aside;
	struct snapshot *snapshot = kiosk_snapshot_begin(k, screen, &aside);
	const int err = draw_screen(k, &aside, stages, fault);

	if (snapshot)
		kiosk_snapshot_end(k, snapshot, screen, err ? fault : NULL);
	return err;
}

int kiosk_make_picture(struct kiosk *k, bool frames, struct fault *fault)
{
	struct display_buffer screen;
	struct kiosk_news news;
	struct stage_clock stages;
	int err;

	kiosk_screen_fit(k);
	err = display_acquire(&k->screen.display, &screen);
	if (err == -EAGAIN)
		return 0;
	if (err) {
		fault_say(fault, err, "the screen is gone: %s", strerror(-err));
		return kiosk_screen_lost(k, err, fault);
	}
	stages = stages_begin();
	news = kiosk_take_frames(&k->inputs, k->picture.pipeline, frames, k->controls.frozen);
	/* A run of a number of pictures fails here: black pictures would pass for its result. */
	err = kiosk_fit_eyes(&k->inputs, &k->picture, show_needs(k->controls.view)->composite,
			     k->settings->frames && !k->picture.begun ? fault : NULL);
	stage_end(&stages, STAGE_DECODE);
	if (!err && (news.fisheye || k->inputs.light_awaited))
		err = kiosk_measure_light(&k->inputs, &k->picture, fault);
	if (err)
		return err;
	if (news.fisheye)
		kiosk_look_for_doubt(k);
	stage_end(&stages, STAGE_SAMPLE);
	if (news.captured_ns)
		follow_timeline(k);
	err = choose_picture(k, fault);
	if (!err)
		err = draw_shown(k, &screen, &stages, fault);
	if (err)
		return err;
	err = display_submit(&k->screen.display, &screen, news.captured_ns, fault);
	if (err)
		return kiosk_screen_lost(k, err, fault);
	stage_end(&stages, STAGE_SHOW);
	k->picture.made_ns = stages.last_ns;
	stats_made(&k->stats, news.captured_ns, stages.ns,
		   pipeline_report(k->picture.pipeline).look_ns);
	learned_keep(k->controls.learned, k->picture.pipeline);
	k->picture.redraw = false;
	k->screen.submitted++;
	if (!k->picture.begun)
		announce_screen(k);
	k->picture.begun = true;
	return 0;
}
