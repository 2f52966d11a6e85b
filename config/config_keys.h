/* SPDX-License-Identifier: MIT */
/* Private to config/: the tables of keys, without those of drivers. */
#ifndef INLAY_CONFIG_CONFIG_KEYS_H
#define INLAY_CONFIG_CONFIG_KEYS_H

#include "config/config.h"
#include "hal/ini/ini.h"

/* root is a struct config. Ends with a NULL section. */
extern const struct ini_table config_tables[];
extern const size_t config_table_count;

extern const struct ini_key config_camera_keys[], config_screen_keys[], config_buttons_keys[];

/* place() of the sections that hold drivers' options too. */
void *config_place_camera(void *root, const char *instance);
void *config_place_screen(void *root, const char *instance);
void *config_place_buttons(void *root, const char *instance);

/* Adds a fault that begins with the configuration's name to the report. */
__attribute__((format(printf, 3, 4))) void
config_complain(const struct config *config, struct ini_report *report, const char *format, ...);

/* The next of the words that blanks or commas separate, cut to size; false at the end. */
bool config_next_word(const char **text, char word[CONFIG_NAME_MAX]);

/* What is wrong with the fisheye's exposures and the ground's patch. */
void config_check_light(const struct config *config, struct ini_report *report);

#endif
