/* SPDX-License-Identifier: MIT */
/* Commands from other programs. */
#include <errno.h>
#include <stdio.h>

#include "app/kiosk/kiosk_parts.h"

/* What waiting does not mend: another kiosk there, no such group, a name that is too long or
 * another file's. */
static bool is_mistake(int err)
{
	return err == -EADDRINUSE || err == -EINVAL || err == -ENAMETOOLONG || err == -EEXIST;
}

int kiosk_control_open(struct kiosk *k, bool first, struct fault *fault)
{
	const struct config_control *control = &k->config->control;
	struct fault reason = {.text = ""};
	int err;

	if (k->control || !*control->socket)
		return 0;
	err = control_open(&k->control, control->socket, control->group, &reason);
	if (first && is_mistake(err))
		return fault_say(fault, err, "%s", reason.text);
	kiosk_complain(&k->control_said, "control", err ? &reason : NULL);
	return 0;
}

void kiosk_control_close(struct kiosk *k)
{
	(void)loop_watch(&k->loop, SLOT_CONTROL, -1, NULL);
	control_close(k->control);
	k->control = NULL;
}

/* What buttons change, and the statistics of the last second. */
static const char *status(struct kiosk *k)
{
	char figures[STATS_TEXT_MAX], trouble[OVERLAY_TEXT_MAX];

	stats_text(&k->stats, &k->pipeline, &k->choice.threshold, k->sources, k->source_count,
		   figures);
	kiosk_pose_trouble(k, trouble);
	snprintf(k->status, sizeof(k->status),
		 "{\"version\":\"%s\",\"view\":\"%s\",\"pose\":%d,\"pose_name\":\"%s\","
		 "\"pose_shown\":%d,\"pose_trouble\":\"%s\",\"object\":%s,\"frozen\":%s,"
		 "\"split\":%.2f,\"information\":%s,\"screen\":\"%s\",%s}",
		 INLAY_VERSION, config_show_names[k->what], k->choice.pose,
		 basis_pose_name(&k->basis, k->choice.pose), k->pipeline.choice.pose, trouble,
		 k->choice.object ? "true" : "false", k->frozen ? "true" : "false", k->split,
		 k->information ? "true" : "false", display_situation_names[k->display.situation],
		 figures);
	return k->status;
}

static const char *act(struct kiosk *k, const struct button_press *press,
		       char answer[FAULT_TEXT_MAX + 16])
{
	struct fault fault = {.text = ""};

	if (!kiosk_act(k, press, &fault))
		return "ok";
	snprintf(answer, FAULT_TEXT_MAX + 16, "error: %s", fault.text);
	return answer;
}

void kiosk_control_read(struct kiosk *k)
{
	struct control_request request;
	char answer[FAULT_TEXT_MAX + 16];

	for (;;) {
		control_next(k->control, &request);
		switch (request.kind) {
		case CONTROL_ACTION:
			control_answer(k->control, act(k, &request.press, answer));
			break;
		case CONTROL_STATUS:
			control_answer(k->control, status(k));
			break;
		default:
			return;
		}
	}
}
