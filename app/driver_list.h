/* SPDX-License-Identifier: MIT */
/* Names of the drivers and their tables of keys, for the configuration. */
#ifndef INLAY_APP_DRIVER_LIST_H
#define INLAY_APP_DRIVER_LIST_H

#include "config/config.h"

/* In the order of the arrays in drivers/drivers.h, so that an index serves both. Lives as long as
 * the program; not for several threads. */
const struct config_drivers *driver_list(void);

#endif
