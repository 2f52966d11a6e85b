/* SPDX-License-Identifier: MIT */
#include "drivers/libcamera/parts.h"

#include <errno.h>
#include <glob.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Says why libcamera sees no camera. */
static int say_none(struct fault *fault)
{
	glob_t media;
	int err = 0;

	if (glob("/dev/media*", 0, NULL, &media))
		return fault_say(fault, -ENODEV, "no camera: there is no /dev/media*");
	for (size_t i = 0; i < media.gl_pathc && !err; i++)
		if (access(media.gl_pathv[i], R_OK | W_OK) && errno == EACCES)
			err = fault_say(
				fault, -EACCES,
				"no permission for %s: the user must be in the group that owns it (video)",
				media.gl_pathv[i]);
	globfree(&media);
	if (err)
		return err;
	if (access("/run/udev/data", F_OK))
		return fault_say(
			fault, -ENODEV,
			"no camera: libcamera finds them through udev, which is not running");
	return fault_say(
		fault, -ENODEV,
		"no camera: libcamera has no pipeline handler for what is plugged in, or another program is setting it up");
}

enum likeness { IS_ID, IS_MODEL, IS_PART, LIKENESSES };

static bool is_like(const struct libcamera_name *camera, const char *wanted, enum likeness likeness)
{
	switch (likeness) {
	case IS_ID:
		return strcmp(camera->id, wanted) == 0;
	case IS_MODEL:
		return strcmp(camera->model, wanted) == 0;
	default:
		return strcasestr(camera->id, wanted) || strcasestr(camera->model, wanted);
	}
}

/* Writes "id (model)" of all cameras that match; LIKENESSES matches all. */
static void write_names(const struct libcamera_name *cameras, int count, const char *wanted,
			enum likeness likeness, char *text, size_t size)
{
	size_t used = 0;

	text[0] = '\0';
	for (int i = 0; i < count && used < size; i++)
		if (likeness == LIKENESSES || is_like(&cameras[i], wanted, likeness))
			used += (size_t)snprintf(text + used, size - used, "%s%s (%s)",
						 used ? ", " : "", cameras[i].id, cameras[i].model);
}

int libcamera_find(const struct libcamera_name *cameras, int count, const char *wanted,
		   struct fault *fault)
{
	char names[FAULT_TEXT_MAX];

	if (count == 0)
		return say_none(fault);
	if (!wanted[0])
		return 0;
	for (int likeness = 0; likeness < LIKENESSES; likeness++) {
		int found = 0, last = 0;

		for (int i = 0; i < count; i++)
			if (is_like(&cameras[i], wanted, likeness)) {
				found++;
				last = i;
			}
		if (found == 1)
			return last;
		if (found == 0)
			continue;
		write_names(cameras, count, wanted, likeness, names, sizeof(names));
		return fault_say(fault, -EINVAL,
				 "\"%s\" fits more than one camera, expected one of %s", wanted,
				 names);
	}
	write_names(cameras, count, wanted, LIKENESSES, names, sizeof(names));
	return fault_say(fault, -ENODEV, "no camera \"%s\"; there is %s", wanted, names);
}
