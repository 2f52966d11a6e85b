/* SPDX-License-Identifier: MIT */
/* What hal/base/input.h opens, of bounded length: meshes and their libraries are read whole. */
#ifndef INLAY_BAKE_MESH_PLAIN_FILE_H
#define INLAY_BAKE_MESH_PLAIN_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/base/fault.h"

/* Bytes. The text of a mesh takes twice as many of memory. */
#define PLAIN_FILE_MAX ((uint64_t)4 << 30)

/* What input_open() returns; -EINVAL: a pipe; -EFBIG: longer than most. The fault names the file.
 */
int plain_file_open(FILE **file, const char *path, uint64_t most, struct fault *fault);

/* The same, mapped. An empty file has no bytes and may be unmapped, too. */
struct plain_map {
	const char *at;
	size_t bytes;
};

int plain_file_map(struct plain_map *map, const char *path, uint64_t most, struct fault *fault);
void plain_file_unmap(struct plain_map *map);

#endif
