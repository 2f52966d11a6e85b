/* SPDX-License-Identifier: MIT */
/*
 * A picture of the screen on its way from the kiosk to a client: plain pixels in a memory file, which
 * the kiosk seals before it hands the descriptor over. The kiosk, which may write no files outside of
 * its own folders, needs no path of the client's, and encodes nothing; the client can change nothing.
 */
#ifndef INLAY_APP_CONTROL_SNAPSHOT_H
#define INLAY_APP_CONTROL_SNAPSHOT_H

#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"

#define SNAPSHOT_LINE_MAX 64

struct snapshot {
	int fd; /* -1: closed */
	int width, height;
	size_t stride;
	uint8_t *pixels; /* BGRX; NULL: not mapped */
};

/* The kiosk's: memory to draw in. 0 or -errno. snapshot_close() is to be called in any case. */
int snapshot_create(struct snapshot *snapshot, int width, int height, struct fault *fault);

/* Ends drawing: the memory cannot be written any more. Writes the line that goes with snapshot->fd. */
int snapshot_seal(struct snapshot *snapshot, char line[SNAPSHOT_LINE_MAX], struct fault *fault);

/* The client's: takes over a descriptor (-1: none came) with its line, and maps it. -EBADMSG: it is not what the line
 * says, or is not sealed. snapshot_close() is to be called in any case. */
int snapshot_open(struct snapshot *snapshot, int fd, const char *line, struct fault *fault);

void snapshot_close(struct snapshot *snapshot); /* idempotent */

#endif
