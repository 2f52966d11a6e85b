/* SPDX-License-Identifier: MIT */
/* Opens plain files of bounded length, by hal/base/input.h. Meshes and their libraries are read
 * whole, so they must have an end. */
#ifndef INLAY_BAKE_MESH_PLAIN_FILE_H
#define INLAY_BAKE_MESH_PLAIN_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/base/fault.h"

/* Largest length, in bytes. The text of a mesh takes twice as much memory. */
#define PLAIN_FILE_MAX ((uint64_t)4 << 30)

/* Opens a file for reading; the caller closes it. Errors of input_open(); -EINVAL: a pipe; -EFBIG:
 * longer than most bytes. The fault names the file. */
int plain_file_open(FILE **file, const char *path, uint64_t most, struct fault *fault);

/* A file mapped read-only. An empty file has 0 bytes, and may be unmapped too. */
struct plain_map {
	const char *at;
	size_t bytes;
};

/* Errors as of plain_file_open(). */
int plain_file_map(struct plain_map *map, const char *path, uint64_t most, struct fault *fault);
void plain_file_unmap(struct plain_map *map);

#endif
