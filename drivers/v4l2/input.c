/* SPDX-License-Identifier: MIT */
#include "drivers/v4l2/v4l2.h"

#include <ctype.h>
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAMES_MAX = 400 };

static const char *next_letter(const char *text)
{
	while (*text && !isalnum((unsigned char)*text))
		text++;
	return text;
}

bool v4l2_same_name(const char *a, const char *b)
{
	for (;; a++, b++) {
		a = next_letter(a);
		b = next_letter(b);
		if (tolower((unsigned char)*a) != tolower((unsigned char)*b))
			return false;
		if (!*a)
			return true;
	}
}

static void add_name(char names[NAMES_MAX], const char *name)
{
	const size_t used = strlen(names);

	snprintf(names + used, NAMES_MAX - used, "%s\"%s\"", used ? ", " : "", name);
}

/* Reads a whole number from 0 to 255; -1: text is something else. */
static int input_number(const char *text)
{
	char *end;
	const long value = strtol(text, &end, 10);

	return end != text && !*end && value >= 0 && value <= 255 ? (int)value : -1;
}

static int find_input(int fd, const char *wanted, struct fault *fault)
{
	struct v4l2_input input = {0};
	char names[NAMES_MAX] = "";
	const int number = input_number(wanted);

	for (; device_ioctl(fd, VIDIOC_ENUMINPUT, &input) == 0; input.index++) {
		const char *name = (const char *)input.name;

		if (number >= 0 ? (int)input.index == number : v4l2_same_name(wanted, name))
			return (int)input.index;
		add_name(names, name);
	}
	return fault_say(
		fault, -EINVAL,
		"v4l2.input: the camera has no input \"%s\", expected a number below %u or one of %s",
		wanted, input.index, names[0] ? names : "none");
}

/* Selects an input by number or name. Empty, or "-1" in old configurations, keeps the present
 * one. */
static int select_input(int fd, const char *wanted, struct v4l2_source *source, struct fault *fault)
{
	int err, selected;

	if (device_ioctl(fd, VIDIOC_G_INPUT, &selected))
		selected = -1;
	source->input = selected;
	if (!wanted[0] || strcmp(wanted, "-1") == 0)
		return 0;
	source->input = find_input(fd, wanted, fault);
	if (source->input < 0 || source->input == selected)
		return source->input < 0 ? source->input : 0;
	err = device_ioctl(fd, VIDIOC_S_INPUT, &source->input);
	if (err)
		return fault_say(fault, err, "v4l2.input: cannot select input \"%s\": %s", wanted,
				 err == -EBUSY ? "another program uses the camera"
					       : strerror(-err));
	return 0;
}

int v4l2_check_signal(int fd, const struct v4l2_source *source, struct fault *fault)
{
	struct v4l2_input input = {.index = (unsigned)source->input};

	if (source->input < 0 || device_ioctl(fd, VIDIOC_ENUMINPUT, &input))
		return 0;
	if (input.status & V4L2_IN_ST_NO_SIGNAL)
		return fault_say(fault, -ENOLINK, "no signal at the input \"%s\"",
				 (const char *)input.name);
	if (input.status & (V4L2_IN_ST_NO_SYNC | V4L2_IN_ST_NO_H_LOCK))
		return fault_say(fault, -ENOLCK, "the signal at the input \"%s\" is not stable",
				 (const char *)input.name);
	return 0;
}

/* Whether timings agree, the pixel clock to 2 %. Measured timings are never exact; to set them each
 * time would make them drift. */
static bool is_the_same(const struct v4l2_bt_timings *set, const struct v4l2_bt_timings *measured)
{
	const uint64_t a = set->pixelclock, b = measured->pixelclock;

	return set->width == measured->width && set->height == measured->height &&
	       set->interlaced == measured->interlaced && (a > b ? a - b : b - a) * 50 <= a;
}

static int take_timings(int fd, struct fault *fault)
{
	struct v4l2_dv_timings timings = {0}, set = {0};
	int err = device_ioctl(fd, VIDIOC_QUERY_DV_TIMINGS, &timings);

	if (err == -ENOLINK)
		return fault_say(fault, err, "no signal at the camera's input");
	if (err == -ENOLCK)
		return fault_say(fault, err, "the signal at the camera's input is not stable");
	if (err == -ERANGE)
		return fault_say(fault, err, "the source's timings are out of the camera's range");
	if (err)
		return 0; /* the device cannot measure: keep what is set */
	if (!device_ioctl(fd, VIDIOC_G_DV_TIMINGS, &set) && is_the_same(&set.bt, &timings.bt))
		return 0;
	err = device_ioctl(fd, VIDIOC_S_DV_TIMINGS, &timings);
	if (err == -EINVAL) /* not a fault of the settings: the source may send others later */
		err = -ERANGE;
	if (err)
		return fault_say(fault, err, "the source's timings are not taken: %s",
				 err == -EBUSY ? "another program uses the camera"
					       : strerror(-err));
	return 0;
}

/* Finds a standard by name. Families go first: a device lists "PAL-BGHIDK" and never plain
 * "PAL". */
static int standard_called(int fd, const char *name, v4l2_std_id offered, v4l2_std_id *standard,
			   struct fault *fault)
{
	static const struct {
		const char *name;
		v4l2_std_id bits;
	} families[] = {{"PAL", V4L2_STD_PAL}, {"NTSC", V4L2_STD_NTSC}, {"SECAM", V4L2_STD_SECAM}};
	struct v4l2_standard listed = {0};
	char names[NAMES_MAX] = "";

	for (int i = 0; i < 3; i++)
		if (v4l2_same_name(name, families[i].name) && families[i].bits & offered) {
			*standard = families[i].bits & offered;
			return 0;
		}
	for (; device_ioctl(fd, VIDIOC_ENUMSTD, &listed) == 0; listed.index++) {
		if (v4l2_same_name(name, (const char *)listed.name)) {
			*standard = listed.id;
			return 0;
		}
		add_name(names, (const char *)listed.name);
	}
	return fault_say(
		fault, -EINVAL,
		"v4l2.standard: the input does not know \"%s\", expected PAL, NTSC, SECAM or one of %s",
		name, names[0] ? names : "none");
}

/* Sets a standard unless it is set already: a device that is set restarts and must settle. */
static int change_standard(int fd, v4l2_std_id standard)
{
	v4l2_std_id set = 0;

	if (device_ioctl(fd, VIDIOC_G_STD, &set) == 0 && set == standard)
		return 0;
	return device_ioctl(fd, VIDIOC_S_STD, &standard);
}

static int set_standard(int fd, const char *name, v4l2_std_id standard, struct fault *fault)
{
	int err = change_standard(fd, standard);

	if (err)
		return fault_say(fault, err, "v4l2.standard: cannot set \"%s\": %s", name,
				 err == -EBUSY ? "another program uses the camera"
					       : strerror(-err));
	return 0;
}

/* Sets the standard that the device detects. Without a signal drivers report all standards, or
 * none. */
static void take_standard(int fd)
{
	v4l2_std_id standard = 0;

	if (device_ioctl(fd, VIDIOC_QUERYSTD, &standard) == 0 && standard != 0 &&
	    standard != V4L2_STD_ALL)
		(void)change_standard(fd, standard);
}

static int setup_television(int fd, const char *wanted, v4l2_std_id offered,
			    struct v4l2_source *source, struct fault *fault)
{
	v4l2_std_id standard = 0;
	int err;

	if (wanted[0]) {
		err = standard_called(fd, wanted, offered, &standard, fault);
		if (!err)
			err = set_standard(fd, wanted, standard, fault);
		if (err)
			return err;
	} else {
		take_standard(fd);
	}
	if (device_ioctl(fd, VIDIOC_G_STD, &source->standard))
		source->standard = standard;
	return 0;
}

static void ask_for_events(int fd, struct v4l2_source *source)
{
	struct v4l2_event_subscription wish = {.type = V4L2_EVENT_SOURCE_CHANGE,
					       .id = source->input > 0 ? (unsigned)source->input
								       : 0};

	source->tells = device_ioctl(fd, VIDIOC_SUBSCRIBE_EVENT, &wish) == 0;
}

int v4l2_setup_input(int fd, const struct v4l2_options *options, struct v4l2_source *source,
		     struct fault *fault)
{
	struct v4l2_input input = {0};
	int err;

	*source = (struct v4l2_source){.input = -1};
	err = select_input(fd, options->input, source, fault);
	if (err)
		return err;
	/* Subscribed before anything is read, so that no change is missed in between. */
	ask_for_events(fd, source);
	input.index = (unsigned)source->input;
	if (source->input >= 0 && device_ioctl(fd, VIDIOC_ENUMINPUT, &input))
		source->input = -1;
	if (options->standard[0] && !(input.capabilities & V4L2_IN_CAP_STD))
		return fault_say(
			fault, -EINVAL,
			"v4l2.standard: the input is not a television one; leave it empty");
	if (source->input < 0)
		return 0;
	if (input.capabilities & V4L2_IN_CAP_DV_TIMINGS)
		err = take_timings(fd, fault);
	else if (input.capabilities & V4L2_IN_CAP_STD)
		err = setup_television(fd, options->standard, input.std, source, fault);
	return err ? err : v4l2_check_signal(fd, source, fault);
}

bool v4l2_source_changed(int fd)
{
	struct v4l2_event event = {0};
	bool changed = false;

	while (device_ioctl(fd, VIDIOC_DQEVENT, &event) == 0) {
		changed = changed || event.type == V4L2_EVENT_SOURCE_CHANGE;
		if (event.pending == 0)
			break;
	}
	return changed;
}
