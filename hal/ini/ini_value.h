/* SPDX-License-Identifier: MIT */
/* Private to hal/ini: one value between text and its field. */
#ifndef INLAY_HAL_INI_INI_VALUE_H
#define INLAY_HAL_INI_INI_VALUE_H

#include "hal/ini/ini.h"

#define INI_WHY_MAX 512

/* Writes text's value into the field. folder: where a relative INI_PATH starts; NULL or empty
 * leaves it as it is. -EINVAL: why says what is wrong and what was expected; the field is
 * untouched. */
int ini_value_read(const struct ini_key *key, const char *text, const char *folder, void *values,
		   char why[INI_WHY_MAX]);

/* "a whole number 0..255", "one of cell, node": what the key takes, unit included. */
void ini_value_expected(const struct ini_key *key, char *text, size_t room);

#endif
