/* SPDX-License-Identifier: MIT */
/* Private to config/: what its files do for each other. */
#ifndef INLAY_CONFIG_CONFIG_PARTS_H
#define INLAY_CONFIG_CONFIG_PARTS_H

#include "config/config.h"
#include "hal/ini/ini.h"

/*
 * [camera NAME], [screen] and [buttons] are blocks: the section's own struct,
 * and behind it in memory the options of every driver of its class.
 */

/* Works out where in a block the options of each driver of the class start, and the prefix of their
 * keys. section_bytes: size of the section's own struct. 0, or -E2BIG: more than CONFIG_DRIVERS_MAX
 * drivers. */
int config_block_lay_out(struct config *config, enum config_class kind, size_t section_bytes);

/* Allocates a block with every key at its default; keys are those of the section's own struct. The
 * caller frees it with free(). NULL: out of memory. */
void *config_block_create(const struct config *config, enum config_class kind,
			  const struct ini_key *keys);

/* Copies the next word of *text, which blanks or commas separate, and moves *text behind it. A word
 * of more than 60 characters is cut. False: no word is left. */
bool config_next_word(const char **text, char word[CONFIG_NAME_MAX]);

/* The tables of keys, without those of drivers. The root of their place() is a struct config. A
 * NULL section ends the array. */
extern const struct ini_table config_tables[];
extern const size_t config_table_count; /* without the end */

/* Adds a fault of -EINVAL to the report. Its text begins with the configuration's name. */
__attribute__((format(printf, 3, 4))) void
config_complain(const struct config *config, struct ini_report *report, const char *format, ...);

#endif
