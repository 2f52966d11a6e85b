/* SPDX-License-Identifier: MIT */
/* Any bytes as a configuration: read, also as a file, check, print; what was read without fault
 * reads back.
 *
 * reaches: config.c:config_read config_check.c:config_check config.c:config_print ini.c:ini_read
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/settings.h"
#include "config/config.h"
#include "tests/support/as_file.h"

/* Read from a file, it must say the same, but for the name. */
static void read_file(const uint8_t *data, size_t bytes, int expected)
{
	struct config *config;

	if (config_create(&config, driver_list()) ||
	    config_read(config, as_file(data, bytes), NULL) != expected)
		abort();
	config_destroy(config);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct config *config, *again;
	struct ini_report report = {.count = 0};
	char *text = NULL;
	size_t text_bytes;
	FILE *stream;
	int err;

	if (config_create(&config, driver_list()))
		return 0;
	err = config_read_memory(config, (const char *)data, bytes, "fuzz", &report);
	read_file(data, bytes, err);
	if (err == 0) {
		(void)config_check(config, &report);
		stream = open_memstream(&text, &text_bytes);
		if (!stream || config_create(&again, driver_list()))
			abort();
		config_print(config, stream);
		fclose(stream);
		if (config_read_memory(again, text, text_bytes, "again", NULL))
			abort();
		config_destroy(again);
		free(text);
	}
	config_destroy(config);
	return 0;
}
