/* SPDX-License-Identifier: MIT */
/*
 * Keys of keyboards and of devices that look like one: remote controls, presenters, arcade
 * encoders, dials, and touch screens, whose tap is the key btn_touch. Reads evdev, so it needs no
 * desktop. It searches for devices again whenever /dev/input changes, so one that is plugged in
 * late or again is used.
 *
 * It grabs the devices (keyboard.grab): nothing typed at the kiosk reaches the console's shell, and
 * Ctrl+Alt+F2 does not switch consoles.
 */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/drivers.h"
#include "drivers/keyboard/keyboard.h"
#include "hal/base/log.h"
#include "hal/device/node_link.h"

#define FOLDER "/dev/input"
#define KEYBOARDS_MAX 16
#define FOLDER_WATCH                                                                               \
	KEYBOARDS_MAX /* epoll data of the inotify descriptor; keyboards have their index */

struct keyboard_options {
	char device[INI_TEXT_MAX];
	bool grab;
	char keys[ACTION_COUNT][INI_TEXT_MAX]; /* names, separated by blanks */
};

struct keyboard {
	int fd; /* -1: this entry is free */
	dev_t number;
	bool grabbed;
	struct keys keys;
};

struct keyboards {
	struct keymap map;
	int epoll;
	int folder; /* inotify */
	struct keyboard list[KEYBOARDS_MAX];
};

#define KEYS_OF(text, which, names)                                                                \
	{                                                                                          \
		.name = text, .type = INI_TEXT,                                                    \
		.offset = offsetof(struct keyboard_options, keys[which]), .fallback = (names),     \
		.help = "Keys, as in \"up kpplus\"; empty: none.",                                 \
	}

/* The window driver has the same keys, except for quit. */
static const struct ini_key keyboard_keys[] = {
	{"device", INI_TEXT, offsetof(struct keyboard_options, device), .fallback = "",
	 .help = "Path, link below /dev/input/by-id or name of a keyboard; empty: all there are."},
	{"grab", INI_BOOL, offsetof(struct keyboard_options, grab), .fallback = "yes",
	 .help = "Nobody else gets what is typed: not the console's shell either."},
	KEYS_OF("threshold_up", ACTION_THRESHOLD_UP, "up equal kpplus"),
	KEYS_OF("threshold_down", ACTION_THRESHOLD_DOWN, "down minus kpminus"),
	KEYS_OF("threshold_next", ACTION_THRESHOLD_NEXT, "t"),
	KEYS_OF("view_next", ACTION_VIEW_NEXT, "v"),
	KEYS_OF("pose_next", ACTION_POSE_NEXT, "p"),
	KEYS_OF("pose_prev", ACTION_POSE_PREV, "b"),
	KEYS_OF("object", ACTION_OBJECT, "o"),
	KEYS_OF("information", ACTION_INFORMATION, "i"),
	KEYS_OF("split_left", ACTION_SPLIT_LEFT, "left"),
	KEYS_OF("split_right", ACTION_SPLIT_RIGHT, "right"),
	KEYS_OF("freeze", ACTION_FREEZE, "f"),
	/* No key by default: neither a visitor nor a bar code scanner may end an installed
	 * kiosk. */
	KEYS_OF("quit", ACTION_QUIT, ""),
	INI_KEYS_END,
};

static int read_map(struct keymap *map, const struct keyboard_options *options, struct fault *fault)
{
	for (const struct ini_key *key = keyboard_keys; key->name; key++) {
		const size_t first = offsetof(struct keyboard_options, keys);
		char what[64];
		int err;

		if (key->offset < first)
			continue;
		snprintf(what, sizeof(what), "[buttons] keyboard.%s", key->name);
		err = keymap_add(map, (enum action)((key->offset - first) / INI_TEXT_MAX),
				 (const char *)options + key->offset, what, fault);
		if (err)
			return err;
	}
	return 0;
}

/* Whether the device is a touch screen that tells of fingers and has no key for a tap. */
static bool has_contacts(int fd)
{
	unsigned char keys[KEYS_BITS_BYTES] = {0}, axes[ABS_CNT / 8] = {0};

	return ioctl(fd, EVIOCGBIT(EV_KEY, sizeof(keys)), keys) >= 0 &&
	       ioctl(fd, EVIOCGBIT(EV_ABS, sizeof(axes)), axes) >= 0 &&
	       keys_bit(axes, ABS_MT_TRACKING_ID) && !keys_bit(keys, BTN_TOUCH);
}

/* Whether the device has a key or a dial with an action. */
static bool has_keys(int fd, const struct keymap *map)
{
	unsigned char bits[KEYS_BITS_BYTES] = {0}, axes[REL_CNT / 8] = {0};

	if (ioctl(fd, EVIOCGBIT(EV_KEY, sizeof(bits)), bits) < 0)
		return false;
	if (map->actions[BTN_TOUCH] != ACTION_NONE && has_contacts(fd))
		return true;
	for (unsigned code = 0; code < KEY_CNT; code++)
		if (map->actions[code] != ACTION_NONE && keys_bit(bits, code))
			return true;
	(void)ioctl(fd, EVIOCGBIT(EV_REL, sizeof(axes)), axes);
	for (unsigned axis = 0; axis < REL_CNT; axis++)
		if (keys_bit(axes, axis) && (map->actions[KEYMAP_TURN(axis, 1)] != ACTION_NONE ||
					     map->actions[KEYMAP_TURN(axis, -1)] != ACTION_NONE))
			return true;
	return false;
}

/* Whether the configuration means this device: by its name, its path, or a link to it. */
static bool is_wanted(int fd, dev_t number, const char *device)
{
	char name[INI_TEXT_MAX] = "";
	struct stat named;

	if (!device[0])
		return true;
	if (ioctl(fd, EVIOCGNAME(sizeof(name) - 1), name) >= 0 && !strcmp(name, device))
		return true;
	return stat(device, &named) == 0 && S_ISCHR(named.st_mode) && named.st_rdev == number;
}

/* Grabs the device unless a key is down: otherwise the console would never see its release. The
 * kernel is not asked which keys are down, because EVIOCGKEY removes pending events. */
static void grab_when_idle(struct keyboard *keyboard)
{
	if (!keys_are_idle(&keyboard->keys))
		return;
	if (ioctl(keyboard->fd, EVIOCGRAB, 1) && errno == EBUSY)
		log_warning("keyboard: another program has grabbed one; its keys do not come here");
	keyboard->grabbed = true;
}

static int keyboard_adopt(struct keyboards *keyboards, int fd, dev_t number)
{
	unsigned char down[KEYS_BITS_BYTES] = {0};

	for (int i = 0; i < KEYBOARDS_MAX; i++) {
		struct epoll_event event = {.events = EPOLLIN, .data.u32 = (uint32_t)i};

		if (keyboards->list[i].fd >= 0)
			continue;
		if (ioctl(fd, EVIOCGKEY(sizeof(down)), down) < 0 ||
		    epoll_ctl(keyboards->epoll, EPOLL_CTL_ADD, fd, &event))
			return -errno;
		keyboards->list[i] = (struct keyboard){.fd = fd, .number = number};
		keys_start(&keyboards->list[i].keys, down);
		keyboards->list[i].keys.contacts = has_contacts(fd);
		return 0;
	}
	return -ENOSPC;
}

static bool is_known(const struct keyboards *keyboards, dev_t number)
{
	for (int i = 0; i < KEYBOARDS_MAX; i++)
		if (keyboards->list[i].fd >= 0 && keyboards->list[i].number == number)
			return true;
	return false;
}

/* Uses the device if it is wanted. 0; -errno: it is wanted but cannot be used. */
static int keyboard_consider(struct keyboards *keyboards, const struct keyboard_options *options,
			     const char *path)
{
	struct stat node;
	int fd, err;

	if (stat(path, &node) || !S_ISCHR(node.st_mode) || is_known(keyboards, node.st_rdev))
		return 0;
	fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	if (fd < 0)
		return -errno;
	if (!is_wanted(fd, node.st_rdev, options->device) || !has_keys(fd, &keyboards->map)) {
		close(fd);
		return 0;
	}
	err = keyboard_adopt(keyboards, fd, node.st_rdev);
	if (err)
		close(fd);
	return err;
}

static void keyboard_drop(struct keyboard *keyboard)
{
	close(keyboard->fd); /* also removes it from epoll and ends the grab */
	keyboard->fd = -1;
}

/* Drops lost devices before the search: a new device may have the number of a lost one. */
static void drop_gone(struct keyboards *keyboards)
{
	for (int i = 0; i < KEYBOARDS_MAX; i++) {
		struct pollfd p = {.fd = keyboards->list[i].fd};

		if (p.fd >= 0 && poll(&p, 1, 0) == 1 && p.revents & (POLLHUP | POLLERR))
			keyboard_drop(&keyboards->list[i]);
	}
}

static int count_keyboards(const struct keyboards *keyboards)
{
	int count = 0;

	for (int i = 0; i < KEYBOARDS_MAX; i++)
		count += keyboards->list[i].fd >= 0;
	return count;
}

static int is_event(const struct dirent *entry)
{
	return !strncmp(entry->d_name, "event", 5);
}

/* Drops lost devices and opens new ones. A missing or refused device is an error only if there is
 * no other. */
static int keyboard_search(struct keyboards *keyboards, const struct keyboard_options *options,
			   struct fault *fault)
{
	DIR *folder = opendir(FOLDER);
	int err = folder ? 0 : -errno, refused = 0;

	drop_gone(keyboards);
	if (err)
		return fault_say(fault, -ENODEV, "keyboard: there is no keyboard: %s: %s", FOLDER,
				 strerror(-err));
	for (struct dirent *entry; (entry = readdir(folder));) {
		char path[sizeof(FOLDER) + sizeof(entry->d_name) + 1];

		if (!is_event(entry))
			continue;
		snprintf(path, sizeof(path), FOLDER "/%s", entry->d_name);
		err = keyboard_consider(keyboards, options, path);
		if (err)
			refused = err;
	}
	closedir(folder);
	for (int i = 0; i < KEYBOARDS_MAX; i++)
		if (options->grab && keyboards->list[i].fd >= 0 && !keyboards->list[i].grabbed)
			grab_when_idle(&keyboards->list[i]);
	if (count_keyboards(keyboards))
		return 0;
	if (refused)
		return fault_say(fault, refused, "keyboard: cannot read any in %s: %s%s", FOLDER,
				 strerror(-refused),
				 refused == -EACCES ? " (is this user in the group \"input\"?)"
						    : "");
	if (options->device[0])
		return fault_say(fault, -ENODEV,
				 "keyboard: \"%s\" is not connected (inlay devices lists them)",
				 options->device);
	return 0; /* a keyboard may be plugged in later */
}

static int open_waiting(struct keyboards *keyboards, struct fault *fault)
{
	/* IN_ATTRIB: udev gives a new node to its group a moment after creating it. */
	const uint32_t changes = IN_CREATE | IN_ATTRIB | IN_DELETE | IN_ONLYDIR;
	struct epoll_event event = {.events = EPOLLIN, .data.u32 = FOLDER_WATCH};
	int err = 0;

	keyboards->epoll = epoll_create1(EPOLL_CLOEXEC);
	if (keyboards->epoll < 0) {
		err = -errno;
		return fault_say(fault, err, "keyboard: epoll: %s", strerror(-err));
	}
	keyboards->folder = inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
	if (keyboards->folder < 0 || inotify_add_watch(keyboards->folder, FOLDER, changes) < 0 ||
	    epoll_ctl(keyboards->epoll, EPOLL_CTL_ADD, keyboards->folder, &event))
		err = -errno;
	if (err == -ENOENT)
		return fault_say(fault, -ENODEV, "keyboard: there is no keyboard: no " FOLDER);
	return err ? fault_say(fault, err, "keyboard: cannot watch %s: %s", FOLDER, strerror(-err))
		   : 0;
}

static int keyboard_open(struct buttons *buttons, struct fault *fault)
{
	struct keyboards *keyboards = calloc(1, sizeof(*keyboards));
	int err;

	if (!keyboards)
		return fault_say(fault, -ENOMEM, "keyboard: not enough memory");
	keyboards->epoll = -1;
	keyboards->folder = -1;
	for (int i = 0; i < KEYBOARDS_MAX; i++)
		keyboards->list[i].fd = -1;
	buttons->state = keyboards;
	err = read_map(&keyboards->map, buttons->options, fault);
	if (!err)
		err = open_waiting(keyboards, fault);
	if (!err)
		err = keyboard_search(keyboards, buttons->options, fault);
	return err;
}

static int keyboard_descriptor(struct buttons *buttons)
{
	return ((struct keyboards *)buttons->state)->epoll;
}

/* Reads one event; further ones keep the descriptor readable. */
static enum action keyboard_take_event(struct keyboards *keyboards, struct keyboard *keyboard,
				       bool grab)
{
	struct input_event event;
	unsigned char down[KEYS_BITS_BYTES] = {0};
	enum action action;

	if (read(keyboard->fd, &event, sizeof(event)) != sizeof(event))
		return ACTION_NONE; /* keyboard_search() drops a lost device */
	action = keys_take(&keyboard->keys, &keyboards->map, &event);
	if (keyboard->keys.ask && ioctl(keyboard->fd, EVIOCGKEY(sizeof(down)), down) >= 0)
		action = keys_ask(&keyboard->keys, &keyboards->map, down);
	if (grab && !keyboard->grabbed && event.type == EV_SYN)
		grab_when_idle(keyboard);
	return action;
}

static int keyboard_read(struct buttons *buttons, struct button_press *press, struct fault *fault)
{
	struct keyboards *keyboards = buttons->state;
	const struct keyboard_options *options = buttons->options;
	struct epoll_event ready;

	while (press->action == ACTION_NONE && epoll_wait(keyboards->epoll, &ready, 1, 0) == 1) {
		const uint32_t i = ready.data.u32;
		const bool gone = ready.events & (EPOLLHUP | EPOLLERR);
		char changes[4096];
		int err;

		/* The changes are discarded: the whole folder is read again. */
		if (i == FOLDER_WATCH && read(keyboards->folder, changes, sizeof(changes)) < 0 &&
		    errno != EAGAIN) {
			err = -errno;
			return fault_say(fault, err, "keyboard: cannot watch %s: %s", FOLDER,
					 strerror(-err));
		}
		if (i == FOLDER_WATCH || gone) {
			err = keyboard_search(keyboards, options, fault);
			if (err)
				return err;
		} else {
			press->action = keyboard_take_event(keyboards, &keyboards->list[i],
							    options->grab);
		}
	}
	return press->action == ACTION_NONE ? -EAGAIN : 0;
}

static void keyboard_close(struct buttons *buttons)
{
	struct keyboards *keyboards = buttons->state;

	if (!keyboards)
		return;
	for (int i = 0; i < KEYBOARDS_MAX; i++)
		if (keyboards->list[i].fd >= 0)
			keyboard_drop(&keyboards->list[i]);
	if (keyboards->folder >= 0)
		close(keyboards->folder);
	if (keyboards->epoll >= 0)
		close(keyboards->epoll);
	free(keyboards);
	buttons->state = NULL;
}

/* Lists a device that has a key with an action by default; lids and power buttons have none. */
static void list_device(const char *path, const struct keymap *map,
			void (*found)(void *context, const char *line), void *context)
{
	char name[INI_TEXT_MAX] = "", link[INI_PATH_MAX], text[2 * INI_PATH_MAX + INI_TEXT_MAX];
	const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);

	if (fd < 0) {
		snprintf(text, sizeof(text), "%s: %s%s", path, strerror(errno),
			 errno == EACCES ? " (is this user in the group \"input\"?)" : "");
		found(context, text);
		return;
	}
	if (ioctl(fd, EVIOCGNAME(sizeof(name) - 1), name) >= 0 && has_keys(fd, map)) {
		(void)node_link(FOLDER "/by-id", path, link, sizeof(link));
		snprintf(text, sizeof(text), "%s [%s]%s%s", path, name, link[0] ? ", " : "", link);
		found(context, text);
	}
	close(fd);
}

static int keyboard_list(void (*found)(void *context, const char *line), void *context)
{
	struct keyboard_options *options = calloc(1, sizeof(*options));
	struct keymap map = {0};
	struct dirent **entries;
	int count, err;

	if (!options)
		return -ENOMEM;
	ini_defaults(keyboard_keys, options);
	err = read_map(&map, options, NULL);
	/* A screen's touch has no action by default, and is listed all the same. */
	map.actions[keymap_code("btn_touch")] = ACTION_VIEW_NEXT;
	free(options);
	count = err ? 0 : scandir(FOLDER, &entries, is_event, versionsort);
	if (count < 0)
		return errno == ENOENT ? 0 : -errno;
	for (int i = 0; i < count; i++) {
		char path[sizeof(FOLDER) + sizeof(entries[i]->d_name) + 1];

		snprintf(path, sizeof(path), FOLDER "/%s", entries[i]->d_name);
		list_device(path, &map, found, context);
		free(entries[i]);
	}
	if (!err)
		free(entries);
	return err;
}

const struct buttons_ops buttons_keyboard = {
	.name = "keyboard",
	.description = "keys of a keyboard, remote control or arcade encoder, dials, taps (evdev)",
	.keys = keyboard_keys,
	.options_size = sizeof(struct keyboard_options),
	.list = keyboard_list,
	.open = keyboard_open,
	.descriptor = keyboard_descriptor,
	.read = keyboard_read,
	.close = keyboard_close,
};
