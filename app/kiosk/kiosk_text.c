/* SPDX-License-Identifier: MIT */
/* What the kiosk says about itself: on the screen and to the system. */
#include <stdio.h>
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "app/view/words.h"

#define ROLE_MAX 64

/* "Fisheye and background": the views that look through a camera. */
static void role_of(const struct kiosk *k, const struct source *source, char role[ROLE_MAX])
{
	const struct eye *eyes[] = {&k->eyes.fisheye, &k->eyes.background, &k->eyes.scene};
	const char *used[3] = {NULL};
	int count = 0, length = 0;

	for (int i = 0; i < 3; i++) {
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

/* A camera that works may still send a picture that its views cannot use. */
static enum camera_situation situation_of(const struct kiosk *k, const struct source *source)
{
	const struct eye *eyes[] = {&k->eyes.fisheye, &k->eyes.background, &k->eyes.scene};

	for (int i = 0; i < 3; i++) {
		if (source->situation == CAMERA_FINE && eyes[i]->source == source && eyes[i]->unfit)
			return CAMERA_UNSUPPORTED_FORMAT;
	}
	return source->situation;
}

static int list_troubles(const struct kiosk *k, char (*texts)[OVERLAY_TEXT_MAX])
{
	int count = 0;

	for (int i = 0; i < k->source_count; i++) {
		const struct source *source = &k->sources[i];
		char role[ROLE_MAX] = "";

		role_of(k, source, role);
		if (words_camera(texts[count], OVERLAY_TEXT_MAX, role, source_device_name(source),
				 situation_of(k, source)) > 0)
			count++;
	}
	if (kiosk_pose_trouble(k, texts[count]) > 0)
		count++;
	return count;
}

int kiosk_pose_trouble(const struct kiosk *k, char text[OVERLAY_TEXT_MAX])
{
	const int pose = k->pipeline.missing;

	*text = '\0';
	return pose < 0
		       ? 0
		       : words_pose(text, OVERLAY_TEXT_MAX, pose, basis_pose_name(&k->basis, pose));
}

static void write_information(struct kiosk *k)
{
	const struct words_figures figures = {
		.lights_used = k->pipeline.selection.used_count,
		.lights = k->pipeline.selection.count,
		.threshold = k->choice.threshold.value,
		.percent = k->choice.threshold.percent,
		.error = stats_dropped_error(&k->pipeline),
		.frames_a_second = k->stats.last.fps,
		.latency_ms = k->stats.last.latency_mean_ms,
		.drops = stats_drops(k->sources, k->source_count),
		.clipped = k->pipeline.clipped,
		.recovered = k->pipeline.recovery.recovered,
		.at_bound = k->pipeline.recovery.at_bound,
	};
	char text[OVERLAY_TEXT_MAX];

	words_information(text, sizeof(text), &figures);
	overlay_information(&k->overlay, text);
}

void kiosk_text(struct kiosk *k)
{
	char texts[OVERLAY_TROUBLES_MAX][OVERLAY_TEXT_MAX];
	int count = list_troubles(k, texts);

	_Static_assert(CONFIG_CAMERAS_MAX + 1 <= OVERLAY_TROUBLES_MAX,
		       "a line for each camera and for the pose");
	overlay_troubles(&k->overlay, (const char(*)[OVERLAY_TEXT_MAX])texts,
			 k->config->screen->trouble ? count : 0);
	if (k->information)
		write_information(k);
	else
		overlay_information(&k->overlay, NULL);
	if (!k->display.state)
		service_status(&k->service, k->display_said.text);
	else
		service_status(&k->service, count ? texts[0] : "showing the picture");
}
