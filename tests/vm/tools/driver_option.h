/* SPDX-License-Identifier: MIT */
/* Drivers' options on the command lines of the tools of this folder. */
#ifndef INLAY_TESTS_VM_TOOLS_DRIVER_OPTION_H
#define INLAY_TESTS_VM_TOOLS_DRIVER_OPTION_H

#include "hal/ini/ini.h"

/* Sets "name=value" in a driver's options, as the driver's key table says. keys may be NULL: no
 * options. 0, or a negative errno with a message on stderr. */
int driver_option_set(const char *driver, const struct ini_key *keys, void *options,
		      const char *option);

#endif
