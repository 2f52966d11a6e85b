/* Plain files alone: a pipe or a device may have no end, and may keep whoever opens it waiting. */
#ifndef INLAY_BAKE_PLAIN_FILE_H
#define INLAY_BAKE_PLAIN_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "hal/fault.h"

#define PLAIN_FILE_MAX                                                                             \
	((uint64_t)4 << 30) /* bytes; a mesh's text takes as many of memory, twice                 \
			     */

/* -ENOENT ...; -EINVAL: no plain file; -EFBIG: longer than most. The fault names the file. */
int plain_file_open(FILE **file, const char *path, uint64_t most, struct fault *fault);

/* The same, mapped. An empty file has no bytes and may be unmapped, too. */
struct plain_map {
	const char *at;
	size_t bytes;
};

int plain_file_map(struct plain_map *map, const char *path, uint64_t most, struct fault *fault);
void plain_file_unmap(struct plain_map *map);

#endif
