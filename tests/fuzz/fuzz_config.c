/* Any bytes as a configuration: read, check, print; what was read without fault reads back. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/driver_list.h"
#include "config/config.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct config *config, *again;
	struct ini_report report = {.count = 0};
	char *text = NULL;
	size_t text_bytes;
	FILE *stream;

	if (config_create(&config, driver_list()))
		return 0;
	if (config_read_memory(config, (const char *)data, bytes, "fuzz", &report) == 0) {
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
