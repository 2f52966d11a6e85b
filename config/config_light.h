/* SPDX-License-Identifier: MIT */
/* Private to config/: the part of config_check() about the light. */
#ifndef INLAY_CONFIG_CONFIG_LIGHT_H
#define INLAY_CONFIG_CONFIG_LIGHT_H

#include "config/config.h"

/* Reports what is wrong with the exposures of [fisheye] and the ground patch of [background]. */
void config_check_light(const struct config *config, struct ini_report *report);

#endif
