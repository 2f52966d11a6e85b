/* SPDX-License-Identifier: MIT */
/* A fuzzer's input as a file, for readers that open a path. */
#ifndef INLAY_TESTS_SUPPORT_AS_FILE_H
#define INLAY_TESTS_SUPPORT_AS_FILE_H

#include <stddef.h>
#include <stdint.h>

/* What libFuzzer, or replay.c, calls with each input. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

/* Writes the input to one file in memory, in place of the last input. Returns its path, which is
 * the same in each call. */
const char *as_file(const void *data, size_t bytes);

#endif
