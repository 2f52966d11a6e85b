/* SPDX-License-Identifier: MIT */
#include "hal/device/camera_controls.h"

#include <ctype.h>
#include <errno.h>
#include <stdbool.h>
#include <string.h>

/* Copies the text between from and end without blanks around it. False: empty, or too long. */
static bool copy_trimmed(const char *from, const char *end, char *to, size_t size)
{
	size_t length;

	while (from < end && isspace((unsigned char)*from))
		from++;
	while (from < end && isspace((unsigned char)end[-1]))
		end--;
	length = (size_t)(end - from);
	if (length == 0 || length >= size)
		return false;
	memcpy(to, from, length);
	to[length] = '\0';
	return true;
}

int camera_controls_next(const char **text, struct camera_control *control, struct fault *fault)
{
	const char *const start = *text + strspn(*text, " \t,"), *const end = strchrnul(start, ',');
	const char *const equals = memchr(start, '=', (size_t)(end - start));

	*text = end;
	if (start == end)
		return 0;
	if (!equals || !copy_trimmed(start, equals, control->name, sizeof(control->name)) ||
	    !copy_trimmed(equals + 1, end, control->value, sizeof(control->value)))
		return fault_say(fault, -EINVAL,
				 "controls: \"%.*s\", expected name=value, name=value",
				 (int)(end - start), start);
	return 1;
}
