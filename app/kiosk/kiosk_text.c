/* SPDX-License-Identifier: MIT */
/* What the kiosk says about itself, on the screen and to the service manager. */
#include <stdio.h>
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "app/view/words.h"
#include "hal/base/log.h"
#include "hal/people/people.h"

#define ROLE_MAX 64

/* Names the views that look through a camera: "Fisheye and background". */
static void role_of(const struct eyes *e, const struct source *source, char role[ROLE_MAX])
{
	const struct eye *eyes[EYES];
	const char *used[EYES] = {NULL};
	int count = 0, length = 0;

	eyes_list(e, eyes);
	for (int i = 0; i < EYES; i++) {
		if (eyes[i]->source == source)
			used[count++] = eyes[i]->section;
	}
	for (int i = 0; i < count; i++)
		length += snprintf(role + length, ROLE_MAX - (size_t)length, "%s%s",
				   i == 0	    ? ""
				   : i == count - 1 ? " and "
						    : ", ",
				   used[i]);
	if (*role >= 'a' && *role <= 'z')
		*role = (char)(*role - 'a' + 'A');
}

/* A camera that works may still send a picture that does not fit its views. */
static enum camera_situation situation_of(const struct kiosk_inputs *in,
					  const struct source *source, const char **why)
{
	const struct eye *eyes[EYES];

	*why = source->opening.why.text;
	eyes_list(&in->eyes, eyes);
	for (int i = 0; i < EYES; i++) {
		if (source->opening.situation != CAMERA_FINE || eyes[i]->source != source ||
		    !eyes[i]->unfit)
			continue;
		*why = in->unfit[i].text;
		return CAMERA_UNSUPPORTED_FORMAT;
	}
	return source->opening.situation;
}

static int list_troubles(const struct kiosk_inputs *in, const struct kiosk_picture *picture,
			 char (*texts)[OVERLAY_TEXT_MAX])
{
	int count = 0;

	for (int i = 0; i < in->source_count; i++) {
		const struct source *source = &in->sources[i];
		char role[ROLE_MAX] = "";
		const char *why;
		const enum camera_situation situation = situation_of(in, source, &why);

		role_of(&in->eyes, source, role);
		if (words_camera(texts[count], OVERLAY_TEXT_MAX, role, source_device_name(source),
				 situation, why) > 0)
			count++;
	}
	if (kiosk_pose_trouble(picture, texts[count]) > 0)
		count++;
	return count;
}

int kiosk_pose_trouble(const struct kiosk_picture *picture, char text[OVERLAY_TEXT_MAX])
{
	const int pose = pipeline_report(picture->pipeline).missing;

	*text = '\0';
	return pose < 0 ? 0
			: words_pose(text, OVERLAY_TEXT_MAX, pose,
				     basis_pose_name(picture->basis, pose));
}

static void write_information(struct kiosk *k)
{
	const struct pipeline_report report = pipeline_report(k->picture.pipeline);
	const struct words_figures figures = {
		.lights_used = report.lights_used,
		.lights = report.lights,
		.threshold = k->controls.choice.threshold.value,
		.percent = k->controls.choice.threshold.percent,
		.error = report.dropped_error,
		.frames_a_second = k->stats.last.fps,
		.latency_ms = k->stats.last.latency_mean_ms,
		.drops = stats_drops(k->inputs.sources, k->inputs.source_count),
		.clipped = report.clipped,
		.recovered = report.recovered,
		.at_bound = report.at_bound,
		.lamp = report.lamp.there,
		.lamp_deg = {report.lamp.azimuth_deg, report.lamp.height_deg},
		.missing_lamp = report.missing_lamp[0],
		.unnamed_azimuth_deg = report.told.azimuth_deg,
		.unnamed_height_deg = report.told.height_deg,
		.unnamed_off = LAMPS_TOLD_OFF * report.told.share,
		.people = report.people.on,
		.learned = report.people.learned,
		.in_front = report.people.in_front,
		.unsure = report.people.sure < PEOPLE_SURE_LEAST,
		.moved_px = {report.people.moved_px[0], report.people.moved_px[1]},
		.depth = k->inputs.eyes.depth.source != NULL,
		.by_depth = k->inputs.depth_used,
	};
	char text[OVERLAY_TEXT_MAX];

	words_information(text, sizeof(text), &figures);
	overlay_information(&k->picture.overlay, text);
}

/* Where there is a depth camera, logs what tells who is in front whenever that has changed. */
static void say_depth(struct kiosk_inputs *in, const struct pipeline *pipeline)
{
	const int now = in->depth_used ? DEPTH_SAID_USED : DEPTH_SAID_UNUSED;

	if (!in->eyes.depth.source || !pipeline_report(pipeline).people.begun ||
	    now == (int)in->depth_said)
		return;
	in->depth_said = now;
	log_info_paced("people: who is in front is told by %s",
		       in->depth_used
			       ? "depth"
			       : "their feet, as no depth has come within 0.2 s of the picture");
}

/* Where the background's camera was moved by too much. Returns how many lines it has written. */
static int say_moved(struct kiosk *k, char text[OVERLAY_TEXT_MAX])
{
	const struct pipeline_people_seen people = pipeline_report(k->picture.pipeline).people;
	struct fault trouble = {.text = ""};

	if (people.lost) {
		words_moved(text, OVERLAY_TEXT_MAX, people.moved_px);
		snprintf(trouble.text, sizeof(trouble.text), "%s", text);
	}
	kiosk_complain(&k->inputs.moved_said, "people", people.lost ? &trouble : NULL);
	return people.lost;
}

void kiosk_text(struct kiosk *k)
{
	char texts[OVERLAY_TROUBLES_MAX][OVERLAY_TEXT_MAX];
	int count = list_troubles(&k->inputs, &k->picture, texts);

	_Static_assert(CONFIG_CAMERAS_MAX + 3 <= OVERLAY_TROUBLES_MAX,
		       "a line for each camera, for the pose, for the light and a moved camera");
	count += kiosk_doubt(k, texts[count]);
	count += say_moved(k, texts[count]);
	say_depth(&k->inputs, k->picture.pipeline);
	overlay_troubles(&k->picture.overlay, (const char(*)[OVERLAY_TEXT_MAX])texts,
			 k->config->screen->trouble ? count : 0);
	if (k->controls.information)
		write_information(k);
	else
		overlay_information(&k->picture.overlay, NULL);
	if (k->rest.resting)
		service_status(&k->service, "at rest, outside of [screen] hours");
	else if (!k->screen.display.state)
		service_status(&k->service, k->screen.said.text);
	else
		service_status(&k->service, count ? texts[0] : "showing the picture");
}
