/* SPDX-License-Identifier: MIT */
/*
 * Opening files that are read to their end. What has no end, or may never begin, is refused: named
 * pipes, devices, sockets, folders. The pipe of a shell's <(command) is fine: somebody writes it.
 */
#ifndef INLAY_HAL_BASE_INPUT_H
#define INLAY_HAL_BASE_INPUT_H

#include <stdio.h>

#include "hal/base/fault.h"

/* A descriptor, or -ENOENT, -EISDIR, -EINVAL ... with a fault that names the path. Never waits. */
int input_open(const char *path, struct fault *fault);

/* The same as a stream; 0 or -errno. */
int input_stream(const char *path, FILE **stream, struct fault *fault);

#endif
