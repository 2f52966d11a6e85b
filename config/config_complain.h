/* SPDX-License-Identifier: MIT */
/* Private to config/: how a fault of the whole configuration gets into the report. */
#ifndef INLAY_CONFIG_CONFIG_COMPLAIN_H
#define INLAY_CONFIG_CONFIG_COMPLAIN_H

#include "config/config.h"

/* Adds a fault of -EINVAL to the report. Its text begins with the configuration's name. */
__attribute__((format(printf, 3, 4))) void
config_complain(const struct config *config, struct ini_report *report, const char *format, ...);

#endif
