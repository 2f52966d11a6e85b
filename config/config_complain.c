/* SPDX-License-Identifier: MIT */
#include "config/config_complain.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>

void config_complain(const struct config *config, struct ini_report *report, const char *format,
		     ...)
{
	char what[FAULT_TEXT_MAX - INI_PATH_MAX / 2];
	struct fault fault = {.text = ""};
	va_list args;

	va_start(args, format);
	vsnprintf(what, sizeof(what), format, args);
	va_end(args);
	fault_say(&fault, -EINVAL, "%.500s: %s", config->name, what);
	ini_report_add(report, &fault);
}
