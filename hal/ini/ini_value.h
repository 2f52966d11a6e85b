/* SPDX-License-Identifier: MIT */
/* Private to hal/ini: converts one value between text and its field. */
#ifndef INLAY_HAL_INI_INI_VALUE_H
#define INLAY_HAL_INI_INI_VALUE_H

#include "hal/ini/ini.h"

#define INI_WHY_MAX 512

/* Reads text and writes the value into the field. A relative INI_PATH starts at folder; NULL or
 * empty: it stays relative. 0; -EINVAL: why says what is wrong and what was expected, and the field
 * is unchanged. */
int ini_value_read(const struct ini_key *key, const char *text, const char *folder, void *values,
		   char why[INI_WHY_MAX]);

/* Writes what the key accepts, with its unit: "a whole number 0..255", "one of cell, node". */
void ini_value_expected(const struct ini_key *key, char *text, size_t room);

#endif
