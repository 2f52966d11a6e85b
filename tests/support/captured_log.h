/* SPDX-License-Identifier: MIT */
/* What a program writes to stderr, caught in a temporary file. */
#ifndef INLAY_TESTS_SUPPORT_CAPTURED_LOG_H
#define INLAY_TESTS_SUPPORT_CAPTURED_LOG_H

#include <stdio.h>

struct captured_log {
	FILE *stream;
	int stderr_was;
};

/* From here on stderr goes to a file. */
struct captured_log captured_log_begin(void);

/* Gives stderr back. Returns the file, to be read from its start; the caller closes it. */
FILE *captured_log_end(const struct captured_log *log);

#endif
