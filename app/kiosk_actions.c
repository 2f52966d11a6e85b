/* Buttons: where they come from, and what each does. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "app/kiosk_parts.h"
#include "drivers/drivers.h"

#define LEVEL_MAX 255.0
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

void kiosk_act(struct kiosk *k, enum action action, double value)
{
	double step = k->config->lights.threshold_step;
	double threshold = k->choice.threshold;

	switch (action) {
	case ACTION_THRESHOLD_UP:
		k->choice.threshold = within(threshold + step, LEVEL_MAX);
		break;
	case ACTION_THRESHOLD_DOWN:
		k->choice.threshold = within(threshold - step, LEVEL_MAX);
		break;
	case ACTION_THRESHOLD_NEXT:
		k->choice.threshold = threshold + step > LEVEL_MAX ? 0 : threshold + step;
		break;
	case ACTION_THRESHOLD_SET:
		k->choice.threshold = within(value, LEVEL_MAX);
		break;
	case ACTION_VIEW_NEXT:
		next_view(k);
		break;
	case ACTION_POSE_NEXT:
		k->choice.pose = (k->choice.pose + 1) % (int)k->basis.info.poses;
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
		return;
	}
	k->redraw = true;
	kiosk_keep_state(k);
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
		kiosk_act(k, press.action, press.value);
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
