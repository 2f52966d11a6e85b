/* SPDX-License-Identifier: MIT */
/* Private to config/: the tables of keys, without those of drivers. */
#ifndef INLAY_CONFIG_CONFIG_KEYS_H
#define INLAY_CONFIG_CONFIG_KEYS_H

#include "config/config.h"
#include "hal/ini/ini.h"

/* The root of their place() is a struct config. A NULL section ends the array. */
extern const struct ini_table config_tables[];
extern const size_t config_table_count; /* without the end */

#endif
