/* SPDX-License-Identifier: MIT */
/* The input as a file that a reader may open by its path: what every target of files needs. */
#ifndef INLAY_TESTS_FUZZ_AS_FILE_H
#define INLAY_TESTS_FUZZ_AS_FILE_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

/* One file in memory, written anew at each call; its path, which stays the same. */
static inline const char *as_file(const void *data, size_t bytes)
{
	static int file = -1;
	static char path[64];

	if (file < 0)
		file = memfd_create("fuzz", MFD_CLOEXEC);
	if (file < 0 || ftruncate(file, 0) || pwrite(file, data, bytes, 0) != (ssize_t)bytes)
		abort();
	snprintf(path, sizeof(path), "/proc/self/fd/%d", file);
	return path;
}

#endif
