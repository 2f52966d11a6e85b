/* SPDX-License-Identifier: MIT */
/* Keyboards: names of keys, and what the kernel's events mean. tests/vm/test_keyboard.sh plugs
 * devices into the simulated machine. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/drivers.h"
#include "drivers/keyboard/keyboard.h"
#include "tests/support/test.h"

TEST("names")
{
	struct keymap map = {0};
	struct fault fault;

	assert_int_equal(keymap_add(&map, ACTION_THRESHOLD_UP, " up  kpplus\t", "x", &fault), 0);
	assert_int_equal(keymap_add(&map, ACTION_FREEZE, "", "x", &fault), 0);
	assert_int_equal(keymap_add(&map, ACTION_QUIT, "btn_trigger", "x", &fault), 0);
	assert_int_equal(map.actions[KEY_UP], ACTION_THRESHOLD_UP);
	assert_int_equal(map.actions[KEY_KPPLUS], ACTION_THRESHOLD_UP);
	assert_int_equal(map.actions[BTN_TRIGGER], ACTION_QUIT);
	assert_int_equal(map.actions[KEY_DOWN], ACTION_NONE);

	assert_int_equal(keymap_add(&map, ACTION_QUIT, "spcae", "keyboard.quit", &fault), -EINVAL);
	assert_string_equal(fault.text,
			    "keyboard.quit: unknown key \"spcae\", did you mean \"space\"?");
	assert_int_equal(keymap_add(&map, ACTION_QUIT, "q up", "keyboard.quit", &fault), -EINVAL);
	assert_string_equal(
		fault.text,
		"keyboard.quit: the key \"up\" is taken by threshold-up, expected one that is free");
}

/* The names are the kernel's: a wrong code in the table would be another key. */
TEST("codes")
{
	static const struct {
		const char *name;
		int code;
	} some[] = {
		{"esc", KEY_ESC},
		{"1", KEY_1},
		{"0", KEY_0},
		{"a", KEY_A},
		{"f1", KEY_F1},
		{"f24", KEY_F24},
		{"kp0", KEY_KP0},
		{"102nd", KEY_102ND},
		{"volumeup", KEY_VOLUMEUP},
		{"ok", KEY_OK},
		{"btn_0", BTN_0},
		{"btn_south", BTN_SOUTH},
		{"btn_touch", BTN_TOUCH},
		{"btn_left", BTN_LEFT},
		{"playpause", KEY_PLAYPAUSE},
	};

	for (size_t i = 0; i < sizeof(some) / sizeof(*some); i++)
		assert_int_equal(keymap_code(some[i].name), some[i].code);
	assert_int_equal(keymap_code("UP"), -1);
	assert_int_equal(keymap_code(""), -1);
}

/* Each default names keys, and no key twice. Every action has one except threshold-set, pose, wake
 * and quit: keys typed at a kiosk must not end it. */
TEST("defaults")
{
	unsigned char *options = calloc(1, buttons_keyboard.options_size);
	struct keymap map = {0};
	int actions = 0;

	assert_non_null(options);
	ini_defaults(buttons_keyboard.keys, options);
	for (const struct ini_key *key = buttons_keyboard.keys; key->name; key++) {
		struct fault fault;

		if (!strcmp(key->name, "device") || !strcmp(key->name, "grab"))
			continue;
		actions++;
		if (keymap_add(&map, (enum action)actions, (char *)options + key->offset, key->name,
			       &fault))
			fail_msg("%s", fault.text);
		assert_int_equal(!options[key->offset], !strcmp(key->name, "quit"));
	}
	/* ACTION_NONE, the three actions that need a value, learn and forget, and wake, as any key
	 * does, have no key */
	assert_int_equal(actions, ACTION_COUNT - 7);
	free(options);
}

static struct keymap steps;

static int make_map(void **state)
{
	(void)state;
	steps = (struct keymap){0};
	return keymap_add(&steps, ACTION_THRESHOLD_UP, "up", "x", NULL) ||
	       keymap_add(&steps, ACTION_VIEW_NEXT, "v", "x", NULL);
}

static enum action keyboard_take(struct keys *keys, unsigned type, unsigned code, int value)
{
	const struct input_event event = {
		.type = (unsigned short)type,
		.code = (unsigned short)code,
		.value = value,
	};

	return keys_take(keys, &steps, &event);
}

TEST("presses")
{
	struct keys keys = {0};

	assert_int_equal(keyboard_take(&keys, EV_MSC, MSC_SCAN, 47), ACTION_NONE);
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_V, 1), ACTION_VIEW_NEXT);
	assert_int_equal(keyboard_take(&keys, EV_SYN, SYN_REPORT, 0), ACTION_NONE);
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_UP, 1), ACTION_THRESHOLD_UP);
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_V, 2),
			 ACTION_NONE); /* a toggle does not repeat */
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_UP, 2), ACTION_THRESHOLD_UP);
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_UP, 0), ACTION_NONE);
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_V, 0), ACTION_NONE);
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_A, 1), ACTION_NONE);
	assert_int_equal(keyboard_take(&keys, EV_KEY, 0xffff, 1), ACTION_NONE);
	assert_int_equal(keyboard_take(&keys, EV_REL, KEY_V, 1), ACTION_NONE);
	assert_false(keys.ask);
}

/* A touch screen as the kernel reports it: two fingers come and go, which is one tap; then
 * another. */
TEST("a tap is a press")
{
	static const struct {
		unsigned type, code;
		int value, taps; /* so far */
	} events[] = {
		{EV_ABS, ABS_MT_SLOT, 0, 0},
		{EV_ABS, ABS_MT_TRACKING_ID, 45, 0},
		{EV_ABS, ABS_MT_POSITION_X, 700, 0},
		{EV_KEY, BTN_TOUCH, 1, 1},
		{EV_ABS, ABS_X, 700, 1},
		{EV_SYN, SYN_REPORT, 0, 1},
		{EV_ABS, ABS_MT_SLOT, 1, 1},
		{EV_ABS, ABS_MT_TRACKING_ID, 46, 1},
		{EV_SYN, SYN_REPORT, 0, 1},
		{EV_ABS, ABS_MT_TRACKING_ID, -1, 1},
		{EV_ABS, ABS_MT_SLOT, 0, 1},
		{EV_ABS, ABS_MT_TRACKING_ID, -1, 1},
		{EV_KEY, BTN_TOUCH, 0, 1},
		{EV_SYN, SYN_REPORT, 0, 1},
		{EV_ABS, ABS_MT_TRACKING_ID, 47, 1},
		{EV_KEY, BTN_TOUCH, 1, 2},
		{EV_SYN, SYN_REPORT, 0, 2},
		{EV_KEY, BTN_TOUCH, 0, 2},
	};
	const unsigned char none[KEYS_BITS_BYTES] = {0};
	struct keys keys;
	int taps = 0;

	assert_int_equal(keymap_add(&steps, ACTION_POSE_NEXT, "btn_touch", "x", NULL), 0);
	keys_start(&keys, none);
	for (size_t i = 0; i < sizeof(events) / sizeof(*events); i++) {
		taps += keyboard_take(&keys, events[i].type, events[i].code, events[i].value) ==
			ACTION_POSE_NEXT;
		if (taps != events[i].taps)
			fail_msg("after event %zu: %d taps", i, taps);
	}
}

/* A touch screen without a key: each finger that comes is a tap, unless another is down. */
TEST("a contact is a press")
{
	const unsigned char none[KEYS_BITS_BYTES] = {0};
	struct keys keys;

	keys_start(&keys, none);
	assert_int_equal(keyboard_take(&keys, EV_ABS, ABS_MT_TRACKING_ID, 0), ACTION_NONE);
	keys.contacts = true;
	for (int finger = 0; finger < 3; finger++) {
		assert_int_equal(keyboard_take(&keys, EV_ABS, ABS_MT_TRACKING_ID, finger),
				 ACTION_POSE_NEXT);
		assert_int_equal(keyboard_take(&keys, EV_ABS, ABS_MT_POSITION_X, 9), ACTION_NONE);
		assert_int_equal(keyboard_take(&keys, EV_ABS, ABS_MT_TRACKING_ID, 9), ACTION_NONE);
		assert_int_equal(keyboard_take(&keys, EV_ABS, ABS_MT_TRACKING_ID, -1), ACTION_NONE);
	}
	assert_true(keys_are_idle(&keys));
}

/* A dial is a rotary encoder behind the kernel's driver: each step is a press, none is held. */
TEST("a step of a dial is a press")
{
	const unsigned char none[KEYS_BITS_BYTES] = {0};
	struct keymap map = {0};
	struct keys keys;
	const struct input_event right = {.type = EV_REL, .code = REL_DIAL, .value = 1},
				 left = {.type = EV_REL, .code = REL_DIAL, .value = -1},
				 wheel = {.type = EV_REL, .code = REL_WHEEL, .value = -2};

	assert_int_equal(keymap_add(&map, ACTION_POSE_NEXT, "dial_right", "x", NULL), 0);
	assert_int_equal(keymap_add(&map, ACTION_POSE_PREV, "dial_left wheel_down", "x", NULL), 0);
	keys_start(&keys, none);
	for (int i = 0; i < 2; i++) {
		assert_int_equal(keys_take(&keys, &map, &right), ACTION_POSE_NEXT);
		assert_int_equal(keys_take(&keys, &map, &left), ACTION_POSE_PREV);
		assert_int_equal(keys_take(&keys, &map, &wheel), ACTION_POSE_PREV);
	}
	assert_true(keys_are_idle(&keys));
}

TEST("down at the start")
{
	unsigned char now[KEYS_BITS_BYTES] = {0};
	struct keys keys;

	keys_start(&keys, now);
	assert_true(keys_are_idle(&keys));
	now[KEY_UP / 8] = 1U << (KEY_UP % 8);
	keys_start(&keys, now);
	assert_false(keys_are_idle(&keys));
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_UP, 2), ACTION_NONE);
	assert_int_equal(keys_ask(&keys, &steps, now), ACTION_NONE); /* still the same press */
	assert_false(keys_are_idle(&keys));
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_V, 1), ACTION_VIEW_NEXT);
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_UP, 0), ACTION_NONE);
	assert_false(keys_are_idle(&keys));
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_V, 0), ACTION_NONE);
	assert_true(keys_are_idle(&keys));
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_UP, 1), ACTION_THRESHOLD_UP);
	assert_false(keys_are_idle(&keys));
}

/* While V is held, the kernel drops events, among them its release and a press of the arrow. */
TEST("dropped")
{
	unsigned char now[KEYS_BITS_BYTES] = {0};
	struct keys keys = {0};

	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_V, 1), ACTION_VIEW_NEXT);
	assert_int_equal(keyboard_take(&keys, EV_SYN, SYN_DROPPED, 0), ACTION_NONE);
	/* An event that is not to be trusted. */
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_V, 1), ACTION_NONE);
	assert_false(keys.ask);
	assert_int_equal(keyboard_take(&keys, EV_SYN, SYN_REPORT, 0), ACTION_NONE);
	assert_true(keys.ask);
	now[KEY_UP / 8] = 1U << (KEY_UP % 8);
	assert_int_equal(keys_ask(&keys, &steps, now), ACTION_THRESHOLD_UP);
	assert_false(keys.ask);
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_UP, 2), ACTION_THRESHOLD_UP);
	assert_int_equal(keyboard_take(&keys, EV_KEY, KEY_V, 1), ACTION_VIEW_NEXT);
	assert_int_equal(keys_ask(&keys, &steps, now), ACTION_NONE); /* no new event */
}

TEST_GROUP(make_map, NULL);
