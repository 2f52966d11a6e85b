/* SPDX-License-Identifier: MIT */
/* Any bytes as a line of the control socket: what is taken is an action with its range, what is not
 * is refused in plain text.
 *
 * reaches: control.c:control_parse buttons.c:parse_level buttons.c:unknown_action
 */
#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "app/control/control.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static int is_action(const struct button_press *press)
{
	return press->action > ACTION_NONE && press->action < ACTION_COUNT && press->value >= 0 &&
	       press->value <= ACTION_LEVEL_MAX;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct control_request request;
	struct fault fault = {.text = ""};
	const int err = control_parse((const char *)data, bytes, &request, &fault);

	if (err) {
		if (err != -EINVAL || !*fault.text || request.kind != CONTROL_NOTHING)
			abort();
		for (const char *c = fault.text; *c; c++)
			if (*c < ' ' || *c > '~')
				abort();
	} else if (request.kind != CONTROL_STATUS && request.kind != CONTROL_SNAPSHOT &&
		   (request.kind != CONTROL_ACTION || !is_action(&request.press))) {
		abort();
	}
	return 0;
}
