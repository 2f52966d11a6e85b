/* SPDX-License-Identifier: MIT */
#include "hal/basis/basis_reader.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>

int basis_damaged(const struct basis_reader *reader, const char *format, ...)
{
	char text[FAULT_TEXT_MAX / 2];
	va_list args;

	va_start(args, format);
	vsnprintf(text, sizeof(text), format, args);
	va_end(args);
	return fault_say(reader->fault, -EBADMSG, "%s: damaged basis file: %s", reader->name, text);
}

bool basis_all_zero(const uint8_t *from, const uint8_t *to)
{
	uint8_t any = 0;

	while (from < to)
		any |= *from++;
	return any == 0;
}
