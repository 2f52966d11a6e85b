/* SPDX-License-Identifier: MIT */
/* Buttons: where they come from, and what each does. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "app/kiosk/kiosk_parts.h"
#include "drivers/drivers.h"
#include "hal/base/log.h"

#define LEVEL_MAX 255.0
#define PERCENT_MAX 100.0
#define SPLIT_STEP 0.02 /* of the width */

static double within(double value, double high)
{
	return value < 0 ? 0 : value > high ? high : value;
}

void kiosk_keep_state(struct kiosk *k)
{
	const struct state_values values = {k->choice.threshold, k->what, k->choice.pose};

	state_keep(k->state, &values);
}

/* Views that have nothing to show are passed over. */
static void next_view(struct kiosk *k)
{
	do
		k->what = (enum config_show)((k->what + 1) % SHOW_COUNT);
	while (k->what == SHOW_SCENE && !k->eyes.scene.source);
}

/* By a step of the threshold's own unit. */
static void move_threshold(struct ini_level *threshold, enum action action, double step)
{
	const double most = threshold->percent ? PERCENT_MAX : LEVEL_MAX;
	const double up = threshold->value + step;

	if (action == ACTION_THRESHOLD_NEXT)
		threshold->value = up > most ? 0 : up;
	else
		threshold->value =
			within(action == ACTION_THRESHOLD_UP ? up : threshold->value - step, most);
}

void kiosk_take_pose(struct kiosk *k, int pose)
{
	k->choice.pose = pose;
	k->choice.share = 0;
	timeline_begin(&k->timeline, &k->config->poses, (int)k->basis.info.poses, pose,
		       k->stamp_ns);
}

static void step_pose(struct kiosk *k, int step)
{
	const int poses = (int)k->basis.info.poses;

	kiosk_take_pose(k, (k->choice.pose + poses + step) % poses);
}

int kiosk_act(struct kiosk *k, const struct button_press *press, struct fault *fault)
{
	int pose;

	switch (press->action) {
	case ACTION_THRESHOLD_UP:
	case ACTION_THRESHOLD_DOWN:
	case ACTION_THRESHOLD_NEXT:
		move_threshold(&k->choice.threshold, press->action,
			       k->config->lights.threshold_step);
		break;
	case ACTION_THRESHOLD_SET:
		k->choice.threshold = (struct ini_level){press->value, press->percent};
		break;
	case ACTION_VIEW_NEXT:
		next_view(k);
		break;
	case ACTION_POSE_NEXT:
		step_pose(k, 1);
		break;
	case ACTION_POSE_PREV:
		step_pose(k, -1);
		break;
	case ACTION_POSE_SET:
		pose = basis_find_pose(&k->basis, press->name, fault);
		if (pose < 0)
			return pose;
		kiosk_take_pose(k, pose);
		break;
	case ACTION_OBJECT:
		k->choice.object = !k->choice.object;
		break;
	case ACTION_INFORMATION:
		k->information = !k->information;
		kiosk_text(k);
		break;
	case ACTION_SPLIT_LEFT:
		k->split = within(k->split - SPLIT_STEP, 1);
		break;
	case ACTION_SPLIT_RIGHT:
		k->split = within(k->split + SPLIT_STEP, 1);
		break;
	case ACTION_FREEZE:
		k->frozen = !k->frozen;
		break;
	case ACTION_QUIT:
		k->stop = true;
		break;
	default:
		return 0;
	}
	k->redraw = true;
	kiosk_keep_state(k);
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
	/* Leaving a slot cannot fail. */
	(void)loop_watch(&k->loop, SLOT_BUTTONS + (int)(keypad - k->keypads), -1, NULL);
	buttons_close(&keypad->buttons);
}

void kiosk_buttons_read(struct kiosk *k, struct keypad *keypad)
{
	struct button_press press;
	struct fault reason = {.text = ""};
	char name[80];
	int err;

	while ((err = buttons_read(&keypad->buttons, &press, &reason)) == 0)
		if (kiosk_act(k, &press, &reason))
			log_warning("%s", reason.text);
	if (err == -EAGAIN)
		return;
	name_keypad(keypad, name);
	kiosk_complain(&keypad->said, name, &reason);
	close_keypad(k, keypad);
}

void kiosk_buttons_close(struct kiosk *k)
{
	for (int i = 0; i < k->keypad_count; i++)
		close_keypad(k, &k->keypads[i]);
	k->keypad_count = 0;
}

/* Which there are to be. */
static void list_keypads(struct kiosk *k)
{
	int drivers[CONFIG_DRIVERS_MAX];

	if (k->keypad_count)
		return;
	k->keypad_count = config_buttons_used(k->config, drivers);
	for (int i = 0; i < k->keypad_count; i++)
		k->keypads[i] = (struct keypad){.driver = drivers[i]};
}

int kiosk_buttons_open(struct kiosk *k, bool first, struct fault *fault)
{
	int err = 0;

	list_keypads(k);
	for (int i = 0; i < k->keypad_count && !err; i++)
		err = open_keypad(k, &k->keypads[i], first, fault);
	return err;
}
