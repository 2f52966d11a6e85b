/* SPDX-License-Identifier: MIT */
/*
 * A file that appears whole or not at all. It is written without a name in the folder of its target
 * (under a temporary name where the file system has no nameless files), then renamed over the
 * target. After a crash or a full disk the old file is still there, and no other file is left.
 */
#ifndef INLAY_HAL_BASE_OUTPUT_H
#define INLAY_HAL_BASE_OUTPUT_H

#include <limits.h>
#include <stdbool.h>
#include <stdio.h>

#include "hal/base/fault.h"

struct output {
	FILE *stream; /* the caller writes to it; NULL: nothing is open */
	char path[PATH_MAX];
	char temporary[PATH_MAX]; /* empty while the file has no name */
	/* Set after output_open(): */
	bool fresh;    /* a file that is at path by then is not replaced */
	bool unsynced; /* nobody waits for the disk, and a power cut may leave the old file */
};

/*
 * Checks, before a command spends time, that each output can be written and that no output is
 * another output or one of the inputs. NULL entries are skipped. 0, or -errno with a fault naming
 * the path.
 */
int output_check(const char *const *outputs, int count, const char *const *inputs, int input_count,
		 struct fault *fault);

/* Opens an output. Nothing stands at path before output_commit(). 0, or -errno with a fault naming
 * the path when the folder is missing or cannot be written. */
int output_open(struct output *out, const char *path, struct fault *fault);

/* Flushes, syncs, renames and closes. 0 or -errno; -EEXIST: see fresh. On failure the old file is
 * untouched and no temporary file is left. */
int output_commit(struct output *out, struct fault *fault);

/* Discards everything written. Harmless on a zeroed, committed or abandoned output. */
void output_abandon(struct output *out);

#endif
