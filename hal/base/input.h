/* SPDX-License-Identifier: MIT */
/*
 * Opens and reads files that are read to their end. Named pipes, devices, sockets and folders are
 * refused, because reading them may never end or never begin. The pipe of a shell's <(command) is
 * accepted: it has a writer.
 */
#ifndef INLAY_HAL_BASE_INPUT_H
#define INLAY_HAL_BASE_INPUT_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/base/fault.h"

/* Returns a descriptor that the caller closes, or -ENOENT, -EISDIR, -EINVAL ... with a fault that
 * names the path. Never blocks. */
int input_open(const char *path, struct fault *fault);

/* Has the paths of files told to seen(), each before it is opened, whether or not it is there; NULL
 * ends that. Of one thread, and for programs that follow their files: seen() must not open
 * others. */
void input_observe(void (*seen)(void *context, const char *path), void *context);

/* Tells of a path that is looked at in another way, and opened only if a file is there. */
void input_note(const char *path);

#define INPUT_MAX ((uint64_t)4 << 30) /* bytes of any file that is read whole */

/* Reads the whole file, which the caller frees; an empty one is not NULL. Not mapped: of a file
 * that another program cuts short, a map raises SIGBUS. 0; -errno as input_open() and read();
 * -EFBIG: longer than most bytes. */
int input_read(const char *path, uint64_t most, uint8_t **data, size_t *bytes, struct fault *fault);

/* Opens the file as a stream that the caller closes. 0 or -errno as input_open(). */
int input_stream(const char *path, FILE **stream, struct fault *fault);

#endif
