/* SPDX-License-Identifier: MIT */
/* Private to hal/ini: finds keys and sections by name, and the nearest name of a misspelt one. */
#ifndef INLAY_HAL_INI_INI_NAMES_H
#define INLAY_HAL_INI_INI_NAMES_H

#include "hal/ini/ini.h"

#define INI_NAME_MAX 128 /* a key with its prefix */

const char *ini_prefix(const struct ini_table *table); /* "" for none */

/* The first table of a section; NULL when there is none. */
const struct ini_table *ini_table_of(const struct ini_table *tables, const char *section);

/* The key called name, prefix included, and the table that holds it; NULL when there is none. */
const struct ini_key *ini_key_of(const struct ini_table *tables, const char *section,
				 const char *name, const struct ini_table **owner);

/* Write the nearest valid name into best; empty if none is near. */
void ini_nearest_section(const struct ini_table *tables, const char *name, char best[INI_NAME_MAX]);
void ini_nearest_key(const struct ini_table *tables, const char *section, const char *name,
		     char best[INI_NAME_MAX]);

#endif
