/* SPDX-License-Identifier: MIT */
#include "tests/support/expect.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>

#include "tests/support/chance.h"

enum { CASE_MAX = 400 };

void expect_fail(const char *file, int line, const char *what, const char *format, ...)
{
	char text[CASE_MAX];
	va_list arguments;

	va_start(arguments, format);
	vsnprintf(text, sizeof(text), format, arguments);
	va_end(arguments);
	print_error("%s: %s (INLAY_SEED=%llu)\n", what, text, (unsigned long long)chance_seed());
	_fail(file, line);
}

void expect_fail_number(const char *file, int line, const char *what, double value,
			const char *words, double limit, const char *format, ...)
{
	char text[CASE_MAX];
	va_list arguments;

	va_start(arguments, format);
	vsnprintf(text, sizeof(text), format, arguments);
	va_end(arguments);
	print_error("%s is %.9g, expected %s %.9g: %s (INLAY_SEED=%llu)\n", what, value, words,
		    limit, text, (unsigned long long)chance_seed());
	_fail(file, line);
}
