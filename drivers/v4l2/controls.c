/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "hal/base/log.h"
#include "hal/ini/ini.h"

enum { KNOWN_MAX = 256 };

void v4l2_control_name(const char *said, char name[V4L2_CONTROL_NAME_MAX])
{
	size_t used = 0;

	for (; *said && used < V4L2_CONTROL_NAME_MAX - 1; said++) {
		const unsigned char c = (unsigned char)*said;

		if (isalnum(c))
			name[used++] = (char)tolower(c);
		else if (used > 0 && name[used - 1] != '_')
			name[used++] = '_';
	}
	while (used > 0 && name[used - 1] == '_')
		used--;
	name[used] = '\0';
}

int v4l2_controls_read(struct v4l2_settings *settings, const char *text, struct fault *fault)
{
	struct camera_control said;
	int got;

	*settings = (struct v4l2_settings){.count = 0};
	while ((got = camera_controls_next(&text, &said, fault)) > 0) {
		if (settings->count == V4L2_CONTROLS_MAX)
			return fault_say(fault, -EINVAL, "controls: more than %d",
					 V4L2_CONTROLS_MAX);
		settings->list[settings->count++].said = said;
	}
	return got;
}

/* ---- the device's controls ---- */

static bool is_number(const struct v4l2_query_ext_ctrl *control)
{
	switch (control->type) {
	case V4L2_CTRL_TYPE_INTEGER:
	case V4L2_CTRL_TYPE_BOOLEAN:
	case V4L2_CTRL_TYPE_MENU:
	case V4L2_CTRL_TYPE_BUTTON:
	case V4L2_CTRL_TYPE_INTEGER64:
	case V4L2_CTRL_TYPE_BITMASK:
	case V4L2_CTRL_TYPE_INTEGER_MENU:
		return control->elems <= 1 && !(control->flags & V4L2_CTRL_FLAG_DISABLED);
	default:
		return false;
	}
}

bool v4l2_next_control(int fd, struct v4l2_query_ext_ctrl *control)
{
	uint32_t id = control->id;

	for (;;) {
		*control = (struct v4l2_query_ext_ctrl){.id = id | V4L2_CTRL_FLAG_NEXT_CTRL};
		if (device_ioctl(fd, VIDIOC_QUERY_EXT_CTRL, control))
			return false;
		if (is_number(control))
			return true;
		id = control->id;
	}
}

bool v4l2_menu_entry(int fd, const struct v4l2_query_ext_ctrl *control, int64_t index,
		     char text[V4L2_CONTROL_NAME_MAX])
{
	struct v4l2_querymenu menu = {.id = control->id, .index = (uint32_t)index};

	if (device_ioctl(fd, VIDIOC_QUERYMENU, &menu))
		return false;
	if (control->type == V4L2_CTRL_TYPE_INTEGER_MENU)
		snprintf(text, V4L2_CONTROL_NAME_MAX, "%lld", (long long)menu.value);
	else
		v4l2_control_name((const char *)menu.name, text);
	return true;
}

int v4l2_get_control(int fd, const struct v4l2_query_ext_ctrl *control, int64_t *value)
{
	struct v4l2_ext_control one = {.id = control->id};
	struct v4l2_ext_controls all = {
		.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 1, .controls = &one};
	int err = device_ioctl(fd, VIDIOC_G_EXT_CTRLS, &all);

	if (err)
		return err;
	*value = control->type == V4L2_CTRL_TYPE_INTEGER64 ? one.value64
		 : control->type == V4L2_CTRL_TYPE_BITMASK ? (int64_t)(uint32_t)one.value
							   : one.value;
	return 0;
}

static int set_control(int fd, const struct v4l2_query_ext_ctrl *control, int64_t value)
{
	struct v4l2_ext_control one = {.id = control->id};
	struct v4l2_ext_controls all = {
		.which = V4L2_CTRL_WHICH_CUR_VAL, .count = 1, .controls = &one};

	if (control->type == V4L2_CTRL_TYPE_INTEGER64)
		one.value64 = value;
	else
		one.value = (int32_t)value;
	return device_ioctl(fd, VIDIOC_S_EXT_CTRLS, &all);
}

/* ---- settings of the configuration ---- */

static int say_unknown(const char *name, char (*known)[V4L2_CONTROL_NAME_MAX], size_t count,
		       struct fault *fault)
{
	const char *names[KNOWN_MAX], *nearest;

	for (size_t i = 0; i < count; i++)
		names[i] = known[i];
	nearest = ini_nearest(name, names, count);
	return fault_say(fault, -EINVAL,
			 "the camera has no control \"%s\"%s%s%s; `inlay devices` lists them", name,
			 nearest ? ", perhaps \"" : "", nearest ? nearest : "",
			 nearest ? "\"" : "");
}

/* Linux 6.0 gave these controls other names; what their old names resemble are other controls. */
static const char *other_name(const char *name)
{
	static const char *const renamed[][2] = {
		{"exposure_auto", "auto_exposure"},
		{"exposure_absolute", "exposure_time_absolute"},
		{"exposure_auto_priority", "exposure_dynamic_framerate"},
		{"white_balance_temperature_auto", "white_balance_automatic"},
		{"focus_auto", "focus_automatic_continuous"},
	};

	for (size_t i = 0; i < sizeof(renamed) / sizeof(renamed[0]); i++)
		for (int k = 0; k < 2; k++)
			if (strcmp(name, renamed[i][k]) == 0)
				return renamed[i][1 - k];
	return "";
}

static int find_control(int fd, struct v4l2_setting *setting, struct fault *fault)
{
	char known[KNOWN_MAX][V4L2_CONTROL_NAME_MAX], wanted[V4L2_CONTROL_NAME_MAX];
	struct v4l2_query_ext_ctrl control = {.id = 0};
	size_t count = 0;

	v4l2_control_name(setting->said.name, wanted);
	while (count < KNOWN_MAX && v4l2_next_control(fd, &control)) {
		v4l2_control_name(control.name, known[count]);
		if (strcmp(known[count], wanted) == 0 ||
		    strcmp(known[count], other_name(wanted)) == 0) {
			setting->control = control;
			return 0;
		}
		count++;
	}
	return say_unknown(setting->said.name, known, count, fault);
}

static bool read_whole_number(const char *text, int64_t *value)
{
	char *end;

	errno = 0;
	*value = strtoll(text, &end, 0);
	return end != text && !*end && errno == 0;
}

/* Reads a menu's entry by name or by index. In an integer menu the names are numbers, so an index
 * is not accepted. */
static bool read_entry(int fd, const struct v4l2_query_ext_ctrl *control, const char *text,
		       int64_t *value)
{
	char entry[V4L2_CONTROL_NAME_MAX];

	for (int64_t i = control->minimum; i <= control->maximum; i++)
		if (v4l2_menu_entry(fd, control, i, entry) && v4l2_same_name(entry, text)) {
			*value = i;
			return true;
		}
	return control->type == V4L2_CTRL_TYPE_MENU && read_whole_number(text, value);
}

static int read_value(int fd, struct v4l2_setting *s, struct fault *fault)
{
	const struct v4l2_query_ext_ctrl *c = &s->control;
	bool truth;

	switch (c->type) {
	case V4L2_CTRL_TYPE_BUTTON:
		s->wanted = 1;
		return 0;
	case V4L2_CTRL_TYPE_BOOLEAN:
		if (ini_truth_read(s->said.value, &truth)) {
			s->wanted = truth;
			return 0;
		}
		return fault_say(fault, -EINVAL, "%s is \"%s\", expected yes or no", s->said.name,
				 s->said.value);
	case V4L2_CTRL_TYPE_MENU:
	case V4L2_CTRL_TYPE_INTEGER_MENU:
		if (read_entry(fd, c, s->said.value, &s->wanted))
			return 0;
		return fault_say(fault, -EINVAL,
				 "%s has no entry \"%s\"; `inlay devices` lists them", s->said.name,
				 s->said.value);
	default:
		if (read_whole_number(s->said.value, &s->wanted))
			return 0;
		return fault_say(
			fault, -EINVAL, "%s is \"%s\", expected a whole number from %lld to %lld",
			s->said.name, s->said.value, (long long)c->minimum, (long long)c->maximum);
	}
}

static const char *refusal_reason(const struct v4l2_query_ext_ctrl *control, int err)
{
	if (control->flags & V4L2_CTRL_FLAG_READ_ONLY)
		return "it can only be read";
	switch (-err) {
	case ERANGE:
		return "the value is out of its range";
	case EBUSY:
		return "it cannot be changed now";
	case EACCES:
		return "it cannot be set, perhaps because its automatic is on: switch that off before it";
	default:
		return strerror(-err);
	}
}

/* Logs each difference once: exposures that are taken in turn set the same values all the time. A
 * control without effect reads as the value that its automatic has chosen. */
static void say_other(const char *path, const struct v4l2_setting *s)
{
	if (s->control.flags & V4L2_CTRL_FLAG_INACTIVE)
		log_warning_once(
			"%s: controls: %s=%s was set, but it has no effect now: is its automatic on?",
			path, s->said.name, s->said.value);
	else
		log_warning_once("%s: controls: %s=%s was set, but the camera says %lld", path,
				 s->said.name, s->said.value, (long long)s->taken);
}

static int set_and_read_back(int fd, const char *path, struct v4l2_setting *s, struct fault *fault)
{
	int err = set_control(fd, &s->control, s->wanted);

	if (err)
		return fault_say(fault, err, "%s=%s is refused: %s (range %lld to %lld)",
				 s->said.name, s->said.value, refusal_reason(&s->control, err),
				 (long long)s->control.minimum, (long long)s->control.maximum);
	s->taken = s->wanted;
	if (s->control.type == V4L2_CTRL_TYPE_BUTTON ||
	    s->control.flags & V4L2_CTRL_FLAG_WRITE_ONLY ||
	    v4l2_get_control(fd, &s->control, &s->taken))
		return 0;
	if (s->taken != s->wanted)
		say_other(path, s);
	return 0;
}

/* A refused control is not tried again until the next opening, where it is not logged again. */
static void setting_give_up(const char *path, struct v4l2_setting *s, const struct fault *fault)
{
	log_warning_once("%s: controls: %s", path, fault->text);
	s->control.id = 0;
}

void v4l2_controls_apply(int fd, const char *path, struct v4l2_settings *settings)
{
	for (int i = 0; i < settings->count; i++) {
		struct v4l2_setting *s = &settings->list[i];
		struct fault fault;

		if (find_control(fd, s, &fault) || read_value(fd, s, &fault) ||
		    set_and_read_back(fd, path, s, &fault))
			setting_give_up(path, s, &fault);
	}
}

void v4l2_controls_confirm(int fd, const char *path, struct v4l2_settings *settings)
{
	for (int i = 0; i < settings->count; i++) {
		struct v4l2_setting *s = &settings->list[i];
		struct fault fault;
		int64_t now;

		if (s->control.id == 0 || s->control.type == V4L2_CTRL_TYPE_BUTTON ||
		    v4l2_get_control(fd, &s->control, &now) || now == s->taken)
			continue;
		if (set_and_read_back(fd, path, s, &fault))
			setting_give_up(path, s, &fault);
	}
}

/* Drivers silently clamp a number that is out of range, so the range is checked here. */
static int check_range(const struct v4l2_setting *s, struct fault *fault)
{
	const struct v4l2_query_ext_ctrl *c = &s->control;

	if (c->type == V4L2_CTRL_TYPE_BUTTON || c->type == V4L2_CTRL_TYPE_BITMASK ||
	    (s->wanted >= c->minimum && s->wanted <= c->maximum))
		return 0;
	return fault_say(fault, -ERANGE, "%s is %s, expected %lld to %lld", s->said.name,
			 s->said.value, (long long)c->minimum, (long long)c->maximum);
}

/* Whether the device uses another number. Indices of menus are not rounded. */
static bool is_rounded(const struct v4l2_setting *s)
{
	return s->taken != s->wanted && !(s->control.flags & V4L2_CTRL_FLAG_INACTIVE) &&
	       (s->control.type == V4L2_CTRL_TYPE_INTEGER ||
		s->control.type == V4L2_CTRL_TYPE_INTEGER64);
}

int v4l2_control_change(int fd, const char *path, const char *name, const char *value,
			double *taken, struct fault *fault)
{
	struct v4l2_setting s = {.control = {.id = 0}};
	struct fault why;
	int err;

	if (strlen(name) >= sizeof(s.said.name) || strlen(value) >= sizeof(s.said.value))
		return fault_say(fault, -EINVAL, "%s: no control has so long a name or value",
				 path);
	snprintf(s.said.name, sizeof(s.said.name), "%s", name);
	snprintf(s.said.value, sizeof(s.said.value), "%s", value);
	err = find_control(fd, &s, &why);
	if (!err)
		err = read_value(fd, &s, &why);
	if (!err)
		err = check_range(&s, &why);
	if (!err)
		err = set_and_read_back(fd, path, &s, &why);
	if (err)
		return fault_say(fault, err, "%s: %s", path, why.text);
	if (is_rounded(&s))
		*taken = (double)s.taken;
	return 0;
}
