/* SPDX-License-Identifier: MIT */
/* Buttons: opening and reading their drivers, and what each button does. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "drivers/drivers.h"
#include "hal/base/clock.h"
#include "hal/base/log.h"

#define LEVEL_MAX 255.0
#define PERCENT_MAX 100.0
#define SPLIT_STEP 0.02 /* share of the picture's width */

static double clamp_level(double value, double high)
{
	return value < 0 ? 0 : value > high ? high : value;
}

struct state_values kiosk_chosen(const struct kiosk_controls *controls)
{
	return (struct state_values){controls->choice.threshold, controls->view,
				     controls->choice.pose};
}

void kiosk_keep_state(const struct kiosk_controls *controls)
{
	const struct state_values values = kiosk_chosen(controls);

	state_keep(controls->state, &values);
}

/* Skips the scene where no camera looks at it, and the guide, which is for setting up. */
static void next_view(struct kiosk_controls *controls, const struct eyes *eyes)
{
	do
		controls->view = (enum config_show)((controls->view + 1) % SHOW_COUNT);
	while (controls->view == SHOW_GUIDE ||
	       (controls->view == SHOW_SCENE && !eyes->scene.source));
}

/* 0; -EINVAL: there is no such view, or no camera for it. */
static int take_view(struct kiosk_controls *controls, const struct eyes *eyes, const char *name,
		     struct fault *fault)
{
	char names[160] = "";

	for (int i = 0; i < SHOW_COUNT; i++) {
		const size_t used = strlen(names);

		if (i == SHOW_SCENE && !eyes->scene.source)
			continue;
		if (strcmp(config_show_names[i], name) == 0) {
			controls->view = (enum config_show)i;
			return 0;
		}
		snprintf(names + used, sizeof(names) - used, "%s%s", used ? ", " : "",
			 config_show_names[i]);
	}
	return fault_say(fault, -EINVAL, "no view \"%s\", expected one of %s", name, names);
}

static void turn_switch(bool *is_on, enum turn turn)
{
	*is_on = turn == TURN_OVER ? !*is_on : turn == TURN_ON;
}

/* step: in the threshold's own unit, grey levels or percent. */
static void move_threshold(struct ini_level *threshold, enum action action, double step)
{
	const double most = threshold->percent ? PERCENT_MAX : LEVEL_MAX;
	const double up = threshold->value + step;

	if (action == ACTION_THRESHOLD_NEXT)
		threshold->value = up > most ? 0 : up;
	else
		threshold->value = clamp_level(
			action == ACTION_THRESHOLD_UP ? up : threshold->value - step, most);
}

void kiosk_take_pose(struct kiosk *k, int pose)
{
	struct kiosk_controls *controls = &k->controls;

	controls->choice.pose = pose;
	controls->choice.share = 0;
	timeline_begin(&controls->timeline, &k->config->poses, (int)k->picture.basis->info.poses,
		       pose, controls->stamp_ns);
}

static void step_pose(struct kiosk *k, int step)
{
	const int poses = (int)k->picture.basis->info.poses;

	kiosk_take_pose(k, (k->controls.choice.pose + poses + step) % poses);
}

int kiosk_act(struct kiosk *k, const struct button_press *press, struct fault *fault)
{
	struct kiosk_controls *controls = &k->controls;
	int pose, err;

	switch (press->action) {
	case ACTION_THRESHOLD_UP:
	case ACTION_THRESHOLD_DOWN:
	case ACTION_THRESHOLD_NEXT:
		move_threshold(&controls->choice.threshold, press->action,
			       k->config->lights.threshold_step);
		break;
	case ACTION_THRESHOLD_SET:
		controls->choice.threshold = (struct ini_level){press->value, press->percent};
		break;
	case ACTION_VIEW_NEXT:
		next_view(controls, &k->inputs.eyes);
		break;
	case ACTION_VIEW_SET:
		err = take_view(controls, &k->inputs.eyes, press->name, fault);
		if (err)
			return err;
		break;
	case ACTION_POSE_NEXT:
		step_pose(k, 1);
		break;
	case ACTION_POSE_PREV:
		step_pose(k, -1);
		break;
	case ACTION_POSE_SET:
		pose = basis_find_pose(k->picture.basis, press->name, fault);
		if (pose < 0)
			return pose;
		kiosk_take_pose(k, pose);
		break;
	case ACTION_OBJECT:
		turn_switch(&controls->choice.object, press->turn);
		break;
	case ACTION_INFORMATION:
		turn_switch(&controls->information, press->turn);
		kiosk_text(k);
		break;
	case ACTION_SPLIT_LEFT:
		controls->split = clamp_level(controls->split - SPLIT_STEP, 1);
		break;
	case ACTION_SPLIT_RIGHT:
		controls->split = clamp_level(controls->split + SPLIT_STEP, 1);
		break;
	case ACTION_FREEZE:
		turn_switch(&controls->frozen, press->turn);
		break;
	case ACTION_WAKE:
		(void)rest_press(&k->rest, clock_now_ns());
		break;
	case ACTION_LEARN:
	case ACTION_FORGET:
		if (!pipeline_report(k->picture.pipeline).people.on)
			return fault_say(fault, -EINVAL,
					 "nobody is looked for, expected [people] occlude = yes");
		if (press->action == ACTION_LEARN) {
			pipeline_learn(k->picture.pipeline);
			learned_soon(controls->learned);
		} else {
			pipeline_forget(k->picture.pipeline);
			learned_forget(controls->learned);
		}
		break;
	case ACTION_QUIT:
		k->stop = true;
		break;
	default:
		return 0;
	}
	k->picture.redraw = true;
	kiosk_keep_state(controls);
	return 0;
}

/* ---- buttons ---- */

static void name_keypad(const struct keypad *keypad, char name[80])
{
	snprintf(name, 80, "buttons %.64s", buttons_drivers[keypad->driver]->name);
}

static int open_keypad(struct kiosk *k, struct keypad *keypad, bool first, struct fault *fault)
{
	struct fault reason = {.text = ""};
	char name[80];
	int err;

	if (keypad->buttons.state)
		return 0;
	err = buttons_open(
		&keypad->buttons, buttons_drivers[keypad->driver],
		config_options(k->config, CONFIG_BUTTONS, k->config->buttons, keypad->driver),
		&reason);
	if (err == -EINVAL && first)
		return fault_say(fault, err, "%s", reason.text);
	name_keypad(keypad, name);
	kiosk_complain(&keypad->said, name, err ? &reason : NULL);
	return 0;
}

static void close_keypad(struct kiosk *k, struct keypad *keypad)
{
	/* Emptying a slot cannot fail. */
	(void)loop_watch(&k->loop, SLOT_BUTTONS + (int)(keypad - k->controls.keypads), -1, NULL);
	buttons_close(&keypad->buttons);
}

void kiosk_buttons_read(struct kiosk *k, struct keypad *keypad)
{
	struct button_press press;
	struct fault reason = {.text = ""};
	char name[80];
	int err;

	while ((err = buttons_read(&keypad->buttons, &press, &reason)) == 0)
		if (!rest_press(&k->rest, clock_now_ns()) && kiosk_act(k, &press, &reason))
			log_warning("%s", reason.text);
	if (err == -EAGAIN)
		return;
	name_keypad(keypad, name);
	kiosk_complain(&keypad->said, name, &reason);
	close_keypad(k, keypad);
}

void kiosk_buttons_close(struct kiosk *k)
{
	struct kiosk_controls *controls = &k->controls;

	for (int i = 0; i < controls->keypad_count; i++)
		close_keypad(k, &controls->keypads[i]);
	controls->keypad_count = 0;
}

/* Lists the drivers that [buttons] names, unless they are listed. */
static void list_keypads(struct kiosk *k)
{
	struct kiosk_controls *controls = &k->controls;
	int drivers[CONFIG_DRIVERS_MAX];

	if (controls->keypad_count)
		return;
	controls->keypad_count = config_buttons_used(k->config, drivers);
	for (int i = 0; i < controls->keypad_count; i++)
		controls->keypads[i] = (struct keypad){.driver = drivers[i]};
}

int kiosk_buttons_open(struct kiosk *k, bool first, struct fault *fault)
{
	struct kiosk_controls *controls = &k->controls;
	int err = 0;

	list_keypads(k);
	for (int i = 0; i < controls->keypad_count && !err; i++)
		err = open_keypad(k, &controls->keypads[i], first, fault);
	return err;
}
