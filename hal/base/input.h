/* SPDX-License-Identifier: MIT */
/*
 * Opens files that are read to their end. Named pipes, devices, sockets and folders are refused,
 * because reading them may never end or never begin. The pipe of a shell's <(command) is accepted:
 * it has a writer.
 */
#ifndef INLAY_HAL_BASE_INPUT_H
#define INLAY_HAL_BASE_INPUT_H

#include <stdio.h>

#include "hal/base/fault.h"

/* Returns a descriptor that the caller closes, or -ENOENT, -EISDIR, -EINVAL ... with a fault that
 * names the path. Never blocks. */
int input_open(const char *path, struct fault *fault);

/* Opens the file as a stream that the caller closes. 0 or -errno as input_open(). */
int input_stream(const char *path, FILE **stream, struct fault *fault);

#endif
