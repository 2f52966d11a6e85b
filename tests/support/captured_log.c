/* SPDX-License-Identifier: MIT */
#include "tests/support/captured_log.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <unistd.h>

struct captured_log captured_log_begin(void)
{
	const struct captured_log log = {tmpfile(), dup(STDERR_FILENO)};

	assert_non_null(log.stream);
	assert_true(log.stderr_was >= 0);
	fflush(stderr);
	assert_true(dup2(fileno(log.stream), STDERR_FILENO) >= 0);
	return log;
}

FILE *captured_log_end(const struct captured_log *log)
{
	fflush(stderr);
	assert_true(dup2(log->stderr_was, STDERR_FILENO) >= 0);
	close(log->stderr_was);
	rewind(log->stream);
	return log->stream;
}
