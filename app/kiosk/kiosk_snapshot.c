/* SPDX-License-Identifier: MIT */
/*
 * What the screen shows, for clients of the control socket. The next picture is drawn in memory and
 * copied to the screen, because the screen's own memory must not be read: it costs a copy, and the
 * video goes on.
 */
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "hal/base/clock.h"

/* Longest wait for a picture; inlay control waits for longer. */
#define WAIT_NS (3 * NS_PER_S)

/* Why there is nothing to take a picture of; NULL: there is. */
static const char *no_picture(const struct kiosk *k)
{
	const struct display *display = &k->screen.display;

	if (k->rest.resting)
		return "the screen is at rest";
	if (!display->state && *k->screen.said.text)
		return k->screen.said.text;
	if (!display->state)
		return "it is not open yet";
	return display->hidden ? "another console has it" : display->off ? "it is off" : NULL;
}

static void refuse_all(struct kiosk *k, const char *before, const char *why)
{
	char answer[FAULT_TEXT_MAX + 64];

	snprintf(answer, sizeof(answer), "error: %s%s", before, why);
	control_answer_waiting(k->controls.control, answer, NULL);
}

void kiosk_snapshot_check(struct kiosk *k)
{
	const char *why = no_picture(k);
	const int64_t now_ns = clock_now_ns();
	int64_t since_ns;

	if (!k->controls.control)
		return;
	since_ns = control_look(k->controls.control, now_ns);
	if (since_ns == INT64_MAX)
		return;
	if (why)
		refuse_all(k, k->rest.resting ? "" : "the kiosk has no screen: ", why);
	else if (now_ns - since_ns >= WAIT_NS)
		refuse_all(k, "", "the kiosk draws no pictures at present");
}

void kiosk_snapshot_ask(struct kiosk *k)
{
	const struct source *leader = eyes_leader(&k->inputs.eyes);

	if (control_is_full(k->controls.control)) {
		control_answer(k->controls.control,
			       "error: pictures are still on their way to other clients");
		return;
	}
	control_postpone(k->controls.control);
	kiosk_snapshot_check(k);
	/* frames on demand come by themselves, and pictures in between would make runs differ */
	k->picture.redraw |= !(leader && leader->camera.on_demand);
}

struct snapshot *kiosk_snapshot_begin(struct kiosk *k, const struct display_buffer *screen,
				      struct display_buffer *aside)
{
	struct snapshot *snapshot = NULL;
	struct fault fault = {.text = ""};

	*aside = *screen;
	if (!k->controls.control || !control_has_waiting(k->controls.control))
		return NULL;
	if (snapshot_create(&snapshot, screen->width, screen->height, &fault)) {
		refuse_all(k, "", fault.text);
		return NULL;
	}
	aside->pixels = snapshot->pixels;
	aside->stride = snapshot->stride;
	return snapshot;
}

void kiosk_snapshot_end(struct kiosk *k, struct snapshot *snapshot,
			const struct display_buffer *screen, const struct fault *failed)
{
	char line[SNAPSHOT_LINE_MAX];

	for (int y = 0; y < screen->height && !failed; y++)
		memcpy(screen->pixels + (size_t)y * screen->stride,
		       snapshot->pixels + (size_t)y * snapshot->stride, 4 * (size_t)screen->width);
	if (failed) {
		refuse_all(k, "the picture cannot be drawn: ", failed->text);
	} else {
		snapshot_finish(snapshot, line);
		control_answer_waiting(k->controls.control, line, snapshot);
	}
	snapshot_release(snapshot);
}
