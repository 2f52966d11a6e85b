/* SPDX-License-Identifier: MIT */
#include "bake/exchange/pictures.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* text begins behind a "%". Returns the place behind the "d" of the number, or NULL. */
static const char *number_end(const char *text)
{
	text += strspn(text, "0123456789");
	return *text == 'd' ? text + 1 : NULL;
}

int picture_pattern_take(void *pattern, const char *option, const char *text, struct fault *fault)
{
	int count = 0;

	*(const char **)pattern = text;
	for (const char *at = strchr(text, '%'); at; at = strchr(at, '%')) {
		const char *end = number_end(at + 1);

		if (!end || end - at > 4) /* "%03d": no widths of hundreds */
			count = 2;
		count++;
		at = end ? end : at + 1;
	}
	return count == 1
		       ? 0
		       : fault_say(
				 fault, -EINVAL,
				 "%s: \"%s\", expected a name with one number, such as o%%03d.hdr",
				 option, text);
}

int picture_name(const char *pattern, int number, char *name, size_t room)
{
	const char *at = strchr(pattern, '%'), *end = number_end(at + 1);
	const int width = atoi(at + 1);
	const bool zeros = at[1] == '0';
	const int length = snprintf(name, room, zeros ? "%.*s%0*d%s" : "%.*s%*d%s",
				    (int)(at - pattern), pattern, width, number, end);

	return length < 0 || (size_t)length >= room ? -ENAMETOOLONG : 0;
}
