/* SPDX-License-Identifier: MIT */
/*
 * A picture of the screen on its way from the kiosk to a client: a line, and the pixels after it,
 * which the kiosk holds until the client has taken them. The kiosk, which may write no files
 * outside of its own folders, needs no path of the client's, and encodes nothing.
 */
#ifndef INLAY_APP_CONTROL_SNAPSHOT_H
#define INLAY_APP_CONTROL_SNAPSHOT_H

#include <stddef.h>
#include <stdint.h>

#include "hal/base/fault.h"

#define SNAPSHOT_LINE_MAX 64
#define SNAPSHOT_SIDE_MAX 32768

struct snapshot {
	int width, height;
	int holders; /* who call snapshot_release() */
	size_t stride;
	uint8_t *pixels; /* BGRX */
};

/* Memory to draw in, with one holder. 0 or -ENOMEM. */
int snapshot_create(struct snapshot **snapshot, int width, int height, struct fault *fault);

/* Ends drawing: rows follow each other without gaps. Writes the line that goes before the
 * pixels. */
void snapshot_finish(struct snapshot *snapshot, char line[SNAPSHOT_LINE_MAX]);

/* Bytes after the line. */
size_t snapshot_bytes(const struct snapshot *snapshot);

/* The client's: creates what a line without its newline announces. -EBADMSG: it announces none. */
int snapshot_expect(struct snapshot **snapshot, const char *line, struct fault *fault);

void snapshot_release(struct snapshot *snapshot); /* NULL is harmless */

#endif
