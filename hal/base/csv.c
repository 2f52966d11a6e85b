/* SPDX-License-Identifier: MIT */
#include "hal/base/csv.h"

#include <math.h>
#include <string.h>

void csv_text(FILE *to, const char *text)
{
	if (!strpbrk(text, ",\"\n\r")) {
		fputs(text, to);
		return;
	}
	fputc('"', to);
	for (; *text; text++) {
		if (*text == '"')
			fputc('"', to);
		fputc(*text, to);
	}
	fputc('"', to);
}

void csv_number(FILE *to, double value)
{
	if (isfinite(value))
		fprintf(to, "%.7g", value);
}
