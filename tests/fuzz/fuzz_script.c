/* SPDX-License-Identifier: MIT */
/* Any bytes as a file of presses: refused in a sentence, or presses that are due in the order of
 * time.
 *
 * reaches: buttons_script.c:parse_line buttons_script.c:script_append buttons_script.c:script_arm
 */
#include <stdlib.h>
#include <string.h>

#include "drivers/drivers.h"
#include "tests/support/as_file.h"

static void play(struct buttons *buttons)
{
	struct fault fault = {.text = ""};
	struct button_press press;

	/* only presses that are due at once: the fuzzer does not wait */
	while (buttons_read(buttons, &press, &fault) == 0)
		if (press.action <= ACTION_NONE || press.action >= ACTION_COUNT)
			abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};
	char path[INI_PATH_MAX] = ""; /* the driver's only option */
	struct buttons buttons;

	strcpy(path, as_file(data, bytes));
	if (buttons_open(&buttons, &buttons_script, path, &fault) == 0)
		play(&buttons);
	else if (!fault.text[0])
		abort();
	buttons_close(&buttons);
	return 0;
}
