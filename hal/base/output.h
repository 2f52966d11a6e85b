/* SPDX-License-Identifier: MIT */
/*
 * A file that appears whole or not at all: written without a name (where the file system knows no
 * such files: under a temporary one) in the same folder, then renamed over its target. After a
 * crash or a full disk the old file is still there, and nothing else.
 */
#ifndef INLAY_HAL_BASE_OUTPUT_H
#define INLAY_HAL_BASE_OUTPUT_H

#include <limits.h>
#include <stdio.h>

#include "hal/base/fault.h"

struct output {
	FILE *stream; /* write here; NULL when nothing is open */
	char path[PATH_MAX];
	char temporary[PATH_MAX]; /* empty while the file has no name */
};

/*
 * Before a command spends time on them: that each output can be written where it is to go, and is
 * neither another output nor one of the files that are read. NULLs are passed over. -errno with a
 * fault naming the path.
 */
int output_check(const char *const *outputs, int count, const char *const *inputs, int input_count,
		 struct fault *fault);

/* -errno with a fault naming the path when the folder is missing or cannot be written. */
int output_open(struct output *out, const char *path, struct fault *fault);

/* Flushes, syncs and renames. On failure nothing is left behind and the old file is untouched. */
int output_commit(struct output *out, struct fault *fault);

/* Forgets everything written. Harmless on a zeroed, committed or abandoned output. */
void output_abandon(struct output *out);

#endif
