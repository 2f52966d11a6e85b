/* SPDX-License-Identifier: MIT */
#include "app/records/records.h"

#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MONITORS_MAX 32

/* Bits of get_throttled, as Raspberry Pi's documentation of vcgencmd lists them. The same bits 16
 * higher stay set once they have been. Throttled means all that makes the processor slower: a
 * capped frequency, throttling, a soft limit of the temperature. */
#define UNDERVOLTAGE 0x1UL
#define THROTTLED 0xeUL
#define BEFORE_SHIFT 16

/* Reads the first line of the small file FORMAT..., without its end. False: there is no file, or it
 * is empty. */
__attribute__((format(printf, 2, 3))) static bool supply_line(char line[64], const char *format,
							      ...)
{
	char path[PATH_MAX];
	va_list args;
	ssize_t bytes;
	int file;

	va_start(args, format);
	vsnprintf(path, sizeof(path), format, args);
	va_end(args);
	file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
	if (file < 0)
		return false;
	bytes = read(file, line, 63);
	close(file);
	line[bytes > 0 ? bytes : 0] = '\0';
	line[strcspn(line, "\n")] = '\0';
	return bytes > 0;
}

struct supply supply_read(const char *sysfs)
{
	unsigned long bits;
	char line[64];

	if (supply_line(line, "%s/devices/platform/soc/soc:firmware/get_throttled", sysfs)) {
		bits = strtoul(line, NULL, 16);
		return (struct supply){
			.told = true,
			.undervoltage = bits & UNDERVOLTAGE,
			.throttled = bits & THROTTLED,
			.undervoltage_before = bits >> BEFORE_SHIFT & UNDERVOLTAGE,
			.throttled_before = bits >> BEFORE_SHIFT & THROTTLED,
		};
	}
	for (int i = 0; i < MONITORS_MAX; i++) {
		if (supply_line(line, "%s/class/hwmon/hwmon%d/name", sysfs, i) &&
		    strcmp(line, "rpi_volt") == 0 &&
		    supply_line(line, "%s/class/hwmon/hwmon%d/in0_lcrit_alarm", sysfs, i))
			return (struct supply){.told = true, .undervoltage = *line == '1'};
	}
	return (struct supply){.told = false};
}
