/* SPDX-License-Identifier: MIT */
/* Commands from other programs, by the control socket. */
#include <errno.h>
#include <stdio.h>

#include "app/kiosk/kiosk_parts.h"

/* Errors that do not pass: another kiosk listens there, there is no such group, the name is too
 * long or another file's. */
static bool is_mistake(int err)
{
	return err == -EADDRINUSE || err == -EINVAL || err == -ENAMETOOLONG || err == -EEXIST;
}

int kiosk_control_open(struct kiosk *k, bool first, struct fault *fault)
{
	const struct config_control *control = &k->config->control;
	struct fault reason = {.text = ""};
	int err;

	if (k->controls.control || !*control->socket)
		return 0;
	err = control_open(&k->controls.control, control->socket, control->group, &reason);
	if (first && is_mistake(err))
		return fault_say(fault, err, "%s", reason.text);
	kiosk_complain(&k->controls.control_said, "control", err ? &reason : NULL);
	return 0;
}

void kiosk_control_close(struct kiosk *k)
{
	(void)loop_watch(&k->loop, SLOT_CONTROL, -1, NULL);
	control_close(k->controls.control);
	k->controls.control = NULL;
}

static const char *word_of(const struct supply *supply, bool now, bool before)
{
	if (!supply->told)
		return "null";
	return now ? "\"now\"" : before ? "\"before\"" : "\"no\"";
}

/* Writes what is chosen at present, and the statistics of the last second. */
static const char *answer_status(struct kiosk *k)
{
	struct kiosk_controls *controls = &k->controls;
	const struct supply supply = supply_read(SUPPLY_SYSFS);
	const struct pipeline_report report = pipeline_report(k->picture.pipeline);
	char figures[STATS_TEXT_MAX], trouble[OVERLAY_TEXT_MAX], next[HOURS_MOMENT_MAX],
		here[HOURS_MOMENT_MAX];

	stats_text(&k->stats, &report, &controls->choice.threshold, k->inputs.sources,
		   k->inputs.source_count, figures);
	kiosk_pose_trouble(&k->picture, trouble);
	rest_next(&k->rest, time(NULL), next);
	config_hours_moment(config_hours_minute(time(NULL)), here);
	snprintf(
		controls->status, sizeof(controls->status),
		"{\"version\":\"%s\",\"view\":\"%s\",\"pose\":%d,\"pose_name\":\"%s\","
		"\"pose_shown\":%d,\"pose_trouble\":\"%s\",\"object\":%s,\"frozen\":%s,"
		"\"split\":%.2f,\"information\":%s,\"screen\":\"%s\",\"rest\":%s,\"hours_next\":\"%s\",\"local_time\":\"%s\",\"undervoltage\":%s,\"throttled\":%s,%s}",
		INLAY_VERSION, config_show_names[controls->view], controls->choice.pose,
		basis_pose_name(k->picture.basis, controls->choice.pose), report.pose, trouble,
		controls->choice.object ? "true" : "false", controls->frozen ? "true" : "false",
		controls->split, controls->information ? "true" : "false",
		kiosk_screen_situation(&k->screen), k->rest.resting ? "true" : "false", next, here,
		word_of(&supply, supply.undervoltage, supply.undervoltage_before),
		word_of(&supply, supply.throttled, supply.throttled_before), figures);
	return controls->status;
}

/* A command is done at rest, too, but nobody sees it: a program that sends some by night must not
 * light up the screen. */
static const char *answer_action(struct kiosk *k, const struct button_press *press,
				 char answer[FAULT_TEXT_MAX + 16])
{
	struct fault fault = {.text = ""};

	if (!kiosk_act(k, press, &fault))
		return k->rest.resting && !k->rest.due ? "ok, but the screen is at rest" : "ok";
	snprintf(answer, FAULT_TEXT_MAX + 16, "error: %s", fault.text);
	return answer;
}

void kiosk_control_read(struct kiosk *k)
{
	struct control_request request;
	char answer[FAULT_TEXT_MAX + 16];

	for (;;) {
		control_next(k->controls.control, &request);
		switch (request.kind) {
		case CONTROL_ACTION:
			control_answer(k->controls.control,
				       answer_action(k, &request.press, answer));
			break;
		case CONTROL_STATUS:
			control_answer(k->controls.control, answer_status(k));
			break;
		case CONTROL_SNAPSHOT:
			kiosk_snapshot_ask(k);
			break;
		default:
			return;
		}
	}
}
