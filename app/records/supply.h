/* SPDX-License-Identifier: MIT */
/* What a Raspberry Pi says of its power supply and its heat: either makes it slower and pictures
 * late. */
#ifndef INLAY_APP_RECORDS_SUPPLY_H
#define INLAY_APP_RECORDS_SUPPLY_H

#include <stdbool.h>

#define SUPPLY_SYSFS "/sys"

struct supply {
	bool told; /* by this machine; else the rest is false */
	bool undervoltage, throttled;
	bool undervoltage_before, throttled_before; /* since the machine started */
};

/* Reads the first line of the small file FORMAT..., without its end. False: there is no file, or it
 * is empty. */
__attribute__((format(printf, 2, 3))) bool supply_line(char line[64], const char *format, ...);

/* Asks the firmware, else the kernel's monitor, which tells of the voltage alone. */
struct supply supply_read(const char *sysfs);

#endif
