/* SPDX-License-Identifier: MIT */
#include "hal/base/number.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* strtod() alone would also take hexadecimal numbers, "nan" and "infinity". */
int number_read(const char **text, double *value)
{
	const size_t length = strspn(*text, "+-.0123456789eE");
	char *end;
	double v;

	if (!length)
		return -EINVAL;
	v = strtod(*text, &end);
	if (end != *text + length || !isfinite(v))
		return -EINVAL;
	*value = v;
	*text = end;
	return 0;
}

int number_of(const char *text, double *value)
{
	double v;

	if (number_read(&text, &v) < 0 || *text)
		return -EINVAL;
	*value = v;
	return 0;
}
