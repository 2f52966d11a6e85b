/* SPDX-License-Identifier: MIT */
#include "drivers/keyboard/keyboard.h"

#include <errno.h>
#include <linux/input-event-codes.h>
#include <stdio.h>
#include <string.h>

_Static_assert(KEYMAP_CODES == KEY_CNT + 2 * REL_CNT && KEYMAP_TURN(0, 1) == KEY_CNT,
	       "a place for each code");

static const struct {
	const char *name;
	int code;
} keys[] = {
#define KEY(name, symbol)                                                                          \
	{                                                                                          \
		name, KEY_##symbol                                                                 \
	}
#define BUTTON(name, symbol)                                                                       \
	{                                                                                          \
		"btn_" name, BTN_##symbol                                                          \
	}
	// clang-format off
	KEY("esc", ESC), KEY("1", 1), KEY("2", 2), KEY("3", 3), KEY("4", 4), KEY("5", 5),
	KEY("6", 6), KEY("7", 7), KEY("8", 8), KEY("9", 9), KEY("0", 0), KEY("minus", MINUS),
	KEY("equal", EQUAL), KEY("backspace", BACKSPACE), KEY("tab", TAB), KEY("q", Q),
	KEY("w", W), KEY("e", E), KEY("r", R), KEY("t", T), KEY("y", Y), KEY("u", U), KEY("i", I),
	KEY("o", O), KEY("p", P), KEY("leftbrace", LEFTBRACE), KEY("rightbrace", RIGHTBRACE),
	KEY("enter", ENTER), KEY("leftctrl", LEFTCTRL), KEY("a", A), KEY("s", S), KEY("d", D),
	KEY("f", F), KEY("g", G), KEY("h", H), KEY("j", J), KEY("k", K), KEY("l", L),
	KEY("semicolon", SEMICOLON), KEY("apostrophe", APOSTROPHE), KEY("grave", GRAVE),
	KEY("leftshift", LEFTSHIFT), KEY("backslash", BACKSLASH), KEY("z", Z), KEY("x", X),
	KEY("c", C), KEY("v", V), KEY("b", B), KEY("n", N), KEY("m", M), KEY("comma", COMMA),
	KEY("dot", DOT), KEY("slash", SLASH), KEY("rightshift", RIGHTSHIFT),
	KEY("kpasterisk", KPASTERISK), KEY("leftalt", LEFTALT), KEY("space", SPACE),
	KEY("capslock", CAPSLOCK), KEY("f1", F1), KEY("f2", F2), KEY("f3", F3), KEY("f4", F4),
	KEY("f5", F5), KEY("f6", F6), KEY("f7", F7), KEY("f8", F8), KEY("f9", F9), KEY("f10", F10),
	KEY("f11", F11), KEY("f12", F12), KEY("numlock", NUMLOCK), KEY("scrolllock", SCROLLLOCK),
	KEY("kp0", KP0), KEY("kp1", KP1), KEY("kp2", KP2), KEY("kp3", KP3), KEY("kp4", KP4),
	KEY("kp5", KP5), KEY("kp6", KP6), KEY("kp7", KP7), KEY("kp8", KP8), KEY("kp9", KP9),
	KEY("kpminus", KPMINUS), KEY("kpplus", KPPLUS), KEY("kpdot", KPDOT),
	KEY("kpenter", KPENTER), KEY("kpslash", KPSLASH), KEY("kpequal", KPEQUAL),
	KEY("kpcomma", KPCOMMA), KEY("102nd", 102ND), KEY("rightctrl", RIGHTCTRL),
	KEY("sysrq", SYSRQ), KEY("rightalt", RIGHTALT), KEY("home", HOME), KEY("up", UP),
	KEY("pageup", PAGEUP), KEY("left", LEFT), KEY("right", RIGHT), KEY("end", END),
	KEY("down", DOWN), KEY("pagedown", PAGEDOWN), KEY("insert", INSERT), KEY("delete", DELETE),
	KEY("pause", PAUSE), KEY("leftmeta", LEFTMETA), KEY("rightmeta", RIGHTMETA),
	KEY("compose", COMPOSE), KEY("f13", F13), KEY("f14", F14), KEY("f15", F15),
	KEY("f16", F16), KEY("f17", F17), KEY("f18", F18), KEY("f19", F19), KEY("f20", F20),
	KEY("f21", F21), KEY("f22", F22), KEY("f23", F23), KEY("f24", F24), KEY("mute", MUTE),
	KEY("volumedown", VOLUMEDOWN), KEY("volumeup", VOLUMEUP), KEY("power", POWER),
	KEY("sleep", SLEEP), KEY("stop", STOP), KEY("again", AGAIN), KEY("undo", UNDO),
	KEY("copy", COPY), KEY("open", OPEN), KEY("paste", PASTE), KEY("find", FIND),
	KEY("cut", CUT), KEY("help", HELP), KEY("menu", MENU), KEY("back", BACK),
	KEY("forward", FORWARD), KEY("playpause", PLAYPAUSE), KEY("stopcd", STOPCD),
	KEY("previoussong", PREVIOUSSONG), KEY("nextsong", NEXTSONG), KEY("play", PLAY),
	KEY("record", RECORD), KEY("rewind", REWIND), KEY("fastforward", FASTFORWARD),
	KEY("refresh", REFRESH), KEY("camera", CAMERA), KEY("brightnessup", BRIGHTNESSUP),
	KEY("brightnessdown", BRIGHTNESSDOWN), KEY("search", SEARCH), KEY("homepage", HOMEPAGE),
	KEY("mail", MAIL), KEY("prog1", PROG1), KEY("prog2", PROG2), KEY("prog3", PROG3),
	KEY("prog4", PROG4), KEY("scrollup", SCROLLUP), KEY("scrolldown", SCROLLDOWN),
	KEY("ok", OK), KEY("select", SELECT), KEY("info", INFO), KEY("channelup", CHANNELUP),
	KEY("channeldown", CHANNELDOWN), KEY("red", RED), KEY("green", GREEN),
	KEY("yellow", YELLOW), KEY("blue", BLUE), KEY("exit", EXIT), KEY("next", NEXT),
	KEY("previous", PREVIOUS), KEY("zoom", ZOOM), KEY("zoomin", ZOOMIN),
	KEY("zoomout", ZOOMOUT),
	BUTTON("0", 0), BUTTON("1", 1), BUTTON("2", 2), BUTTON("3", 3), BUTTON("4", 4),
	BUTTON("5", 5), BUTTON("6", 6), BUTTON("7", 7), BUTTON("8", 8), BUTTON("9", 9),
	BUTTON("trigger", TRIGGER), BUTTON("thumb", THUMB), BUTTON("thumb2", THUMB2),
	BUTTON("top", TOP), BUTTON("top2", TOP2), BUTTON("pinkie", PINKIE), BUTTON("base", BASE),
	BUTTON("base2", BASE2), BUTTON("base3", BASE3), BUTTON("base4", BASE4),
	BUTTON("base5", BASE5), BUTTON("base6", BASE6), BUTTON("dead", DEAD),
	BUTTON("south", SOUTH), BUTTON("east", EAST), BUTTON("north", NORTH), BUTTON("west", WEST),
	BUTTON("c", C), BUTTON("z", Z), BUTTON("tl", TL), BUTTON("tr", TR), BUTTON("tl2", TL2),
	BUTTON("tr2", TR2), BUTTON("select", SELECT), BUTTON("start", START), BUTTON("mode", MODE),
	BUTTON("touch", TOUCH), BUTTON("left", LEFT), BUTTON("right", RIGHT),
	BUTTON("middle", MIDDLE), BUTTON("thumbl", THUMBL), BUTTON("thumbr", THUMBR), BUTTON("dpad_up", DPAD_UP),
	BUTTON("dpad_down", DPAD_DOWN), BUTTON("dpad_left", DPAD_LEFT),
	BUTTON("dpad_right", DPAD_RIGHT), BUTTON("trigger_happy1", TRIGGER_HAPPY1),
	BUTTON("trigger_happy2", TRIGGER_HAPPY2), BUTTON("trigger_happy3", TRIGGER_HAPPY3),
	BUTTON("trigger_happy4", TRIGGER_HAPPY4),
	{"dial_right", KEYMAP_TURN(REL_DIAL, 1)}, {"dial_left", KEYMAP_TURN(REL_DIAL, -1)},
	{"wheel_up", KEYMAP_TURN(REL_WHEEL, 1)}, {"wheel_down", KEYMAP_TURN(REL_WHEEL, -1)},
// clang-format on
#undef KEY
#undef BUTTON
};

#define KEY_COUNT (sizeof(keys) / sizeof(*keys))

int keymap_code(const char *name)
{
	for (size_t i = 0; i < KEY_COUNT; i++)
		if (!strcmp(name, keys[i].name))
			return keys[i].code;
	return -1;
}

static int unknown_key(const char *name, const char *what, struct fault *fault)
{
	const char *names[KEY_COUNT], *near;

	for (size_t i = 0; i < KEY_COUNT; i++)
		names[i] = keys[i].name;
	near = ini_nearest(name, names, KEY_COUNT);
	return fault_say(fault, -EINVAL, "%s: unknown key \"%.40s\"%s%s%s", what, name,
			 near ? ", did you mean \"" : ", expected one like up, f5 or kpplus",
			 near ? near : "", near ? "\"?" : "");
}

int keymap_add(struct keymap *map, enum action action, const char *names, const char *what,
	       struct fault *fault)
{
	char list[INI_TEXT_MAX];
	char *rest = NULL;

	snprintf(list, sizeof(list), "%s", names);
	for (char *name = strtok_r(list, " \t", &rest); name; name = strtok_r(NULL, " \t", &rest)) {
		const int code = keymap_code(name);

		if (code < 0)
			return unknown_key(name, what, fault);
		if (map->actions[code] != ACTION_NONE)
			return fault_say(
				fault, -EINVAL,
				"%s: the key \"%s\" is taken by %s, expected one that is free",
				what, name, action_names[map->actions[code]]);
		map->actions[code] = (unsigned char)action;
	}
	return 0;
}
