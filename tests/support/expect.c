/* SPDX-License-Identifier: MIT */
#include "tests/support/expect.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>

#include "tests/support/chance.h"

enum { CASE_MAX = 400, NUMBER_MAX = 48 };

/* Prints a failure as a TAP comment and ends the test. */
__attribute__((format(printf, 4, 0))) static void
expect_end(const char *file, int line, const char *what, const char *format, va_list arguments)
{
	char text[CASE_MAX];

	vsnprintf(text, sizeof(text), format, arguments);
	print_error("# %s: %s (INLAY_SEED=%llu)\n", what, text, (unsigned long long)chance_seed());
	_fail(file, line);
}

/* Integers with all of their digits. */
static void expect_number(char text[NUMBER_MAX], long double number)
{
	if (number == rintl(number) && fabsl(number) < 1e19L)
		snprintf(text, NUMBER_MAX, "%.0Lf", number);
	else
		snprintf(text, NUMBER_MAX, "%.9Lg", number);
}

void expect_fail(const char *file, int line, const char *what, const char *format, ...)
{
	va_list arguments;

	va_start(arguments, format);
	expect_end(file, line, what, format, arguments);
	va_end(arguments);
}

void expect_fail_number(const char *file, int line, const char *what, long double value,
			const char *words, long double limit, const char *format, ...)
{
	char is[NUMBER_MAX], should[NUMBER_MAX], text[CASE_MAX];
	va_list arguments;

	expect_number(is, value);
	expect_number(should, limit);
	snprintf(text, sizeof(text), "%s is %s, expected %s %s", what, is, words, should);
	va_start(arguments, format);
	expect_end(file, line, text, format, arguments);
	va_end(arguments);
}

void expect_picture(const char *file, int line, const uint8_t *is, const uint8_t *should,
		    size_t stride, size_t bytes, const char *format, ...)
{
	char text[CASE_MAX];
	va_list arguments;
	size_t at = 0;

	while (at < bytes && is[at] == should[at])
		at++;
	if (at == bytes)
		return;
	snprintf(text, sizeof(text), "pixel (%zu, %zu), channel %zu is %d, expected %d",
		 at % stride / 4, at / stride, at % 4, is[at], should[at]);
	va_start(arguments, format);
	expect_end(file, line, text, format, arguments);
	va_end(arguments);
}

void expect_no_fault(const char *file, int line, int err, const struct fault *fault)
{
	if (!err)
		return;
	print_error("# %s (%d)\n", fault->text, err);
	_fail(file, line);
}
