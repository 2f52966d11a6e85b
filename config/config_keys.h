/* Private to config/: the tables of keys, without those of drivers. */
#ifndef INLAY_CONFIG_CONFIG_KEYS_H
#define INLAY_CONFIG_CONFIG_KEYS_H

#include "hal/ini/ini.h"

/* root is a struct config. Ends with a NULL section. */
extern const struct ini_table config_tables[];
extern const size_t config_table_count;

extern const struct ini_key config_camera_keys[], config_screen_keys[], config_buttons_keys[];

/* place() of the sections that hold drivers' options too. */
void *config_place_camera(void *root, const char *instance);
void *config_place_screen(void *root, const char *instance);
void *config_place_buttons(void *root, const char *instance);

#endif
