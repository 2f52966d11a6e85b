/* SPDX-License-Identifier: MIT */
/* Private to config/: the names in [buttons] driver. */
#ifndef INLAY_CONFIG_CONFIG_DRIVERS_H
#define INLAY_CONFIG_CONFIG_DRIVERS_H

#include "config/config.h"

/* Copies the next word of *text, which blanks or commas separate, and moves *text behind it. A word
 * of more than 60 characters is cut. False: no word is left. */
bool config_next_word(const char **text, char word[CONFIG_NAME_MAX]);

#endif
