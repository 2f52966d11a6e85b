/* SPDX-License-Identifier: MIT */
/* The drivers as the configuration wants to know them: names and tables of keys. */
#ifndef INLAY_APP_DRIVER_LIST_H
#define INLAY_APP_DRIVER_LIST_H

#include "config/config.h"

/* In the order of the arrays in drivers/drivers.h, so that an index serves both. Made on the first
 * call; lives as long as the program. */
const struct config_drivers *driver_list(void);

#endif
