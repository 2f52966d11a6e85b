/* SPDX-License-Identifier: MIT */
/*
 * What the screen shows, for clients of the control socket. The next picture is drawn in memory and
 * copied to the screen, because the screen's own memory must not be read: it costs a copy, and the video
 * goes on.
 */
#include <string.h>

#include "app/kiosk/kiosk_parts.h"

/* Why there is nothing to take a picture of; NULL: there is. */
static const char *no_screen(const struct kiosk *k)
{
	const struct display *display = &k->screen.display;

	if (!display->state && *k->screen.said.text)
		return k->screen.said.text;
	if (!display->state)
		return "it is not open yet";
	return display->hidden ? "another console has it" : NULL;
}

static void refuse_all(struct kiosk *k, const char *before, const char *why)
{
	char answer[FAULT_TEXT_MAX + 64];

	snprintf(answer, sizeof(answer), "error: %s%s", before, why);
	control_answer_waiting(k->controls.control, answer, -1);
}

void kiosk_snapshot_check(struct kiosk *k)
{
	const char *why = no_screen(k);

	if (k->controls.control && control_has_waiting(k->controls.control) && why)
		refuse_all(k, "the kiosk has no screen: ", why);
}

void kiosk_snapshot_ask(struct kiosk *k)
{
	const struct source *leader = eyes_leader(&k->inputs.eyes);

	control_postpone(k->controls.control);
	kiosk_snapshot_check(k);
	/* frames on demand come by themselves, and pictures in between would make runs differ */
	k->picture.redraw |= !(leader && leader->camera.on_demand);
}

bool kiosk_snapshot_begin(struct kiosk *k, struct snapshot *snapshot,
			  const struct display_buffer *screen, struct display_buffer *aside)
{
	struct fault fault = {.text = ""};

	*aside = *screen;
	if (!k->controls.control || !control_has_waiting(k->controls.control))
		return false;
	if (snapshot_create(snapshot, screen->width, screen->height, &fault)) {
		snapshot_close(snapshot);
		refuse_all(k, "", fault.text);
		return false;
	}
	aside->pixels = snapshot->pixels;
	aside->stride = snapshot->stride;
	return true;
}

void kiosk_snapshot_end(struct kiosk *k, struct snapshot *snapshot,
			const struct display_buffer *screen)
{
	struct fault fault = {.text = ""};
	char line[SNAPSHOT_LINE_MAX];

	for (int y = 0; y < screen->height; y++)
		memcpy(screen->pixels + (size_t)y * screen->stride,
		       snapshot->pixels + (size_t)y * snapshot->stride, 4 * (size_t)screen->width);
	if (snapshot_seal(snapshot, line, &fault))
		refuse_all(k, "", fault.text);
	else
		control_answer_waiting(k->controls.control, line, snapshot->fd);
	snapshot_close(snapshot);
}
