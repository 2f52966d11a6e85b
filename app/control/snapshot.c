/* SPDX-License-Identifier: MIT */
#include "app/control/snapshot.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROW_ALIGNED 64 /* bytes: a cache line */

int snapshot_create(struct snapshot **out, int width, int height, struct fault *fault)
{
	const size_t stride = ((size_t)width * 4 + ROW_ALIGNED - 1) / ROW_ALIGNED * ROW_ALIGNED;
	struct snapshot *s = calloc(1, sizeof(*s));

	if (s)
		s->pixels = aligned_alloc(ROW_ALIGNED, stride * (size_t)height);
	if (!s || !s->pixels) {
		free(s);
		return fault_say(fault, -ENOMEM, "there is no memory for the picture");
	}
	s->width = width;
	s->height = height;
	s->stride = stride;
	s->holders = 1;
	*out = s;
	return 0;
}

size_t snapshot_bytes(const struct snapshot *s)
{
	return 4 * (size_t)s->width * (size_t)s->height;
}

void snapshot_finish(struct snapshot *s, char line[SNAPSHOT_LINE_MAX])
{
	const size_t row = 4 * (size_t)s->width;

	for (size_t y = 1; y < (size_t)s->height && s->stride != row; y++)
		memmove(s->pixels + y * row, s->pixels + y * s->stride, row);
	s->stride = row;
	snprintf(line, SNAPSHOT_LINE_MAX, "snapshot %d %d", s->width, s->height);
}

int snapshot_expect(struct snapshot **out, const char *line, struct fault *fault)
{
	int width, height, end = -1, err;

	(void)sscanf(line, "snapshot %5d %5d%n", &width, &height, &end);
	if (end < 0 || line[end] || width < 1 || height < 1 || width > SNAPSHOT_SIDE_MAX ||
	    height > SNAPSHOT_SIDE_MAX)
		return fault_say(fault, -EBADMSG,
				 "the kiosk answered \"%.60s\", expected a picture", line);
	err = snapshot_create(out, width, height, fault);
	if (!err)
		(*out)->stride = 4 * (size_t)width;
	return err;
}

void snapshot_release(struct snapshot *s)
{
	if (!s || --s->holders)
		return;
	free(s->pixels);
	free(s);
}
