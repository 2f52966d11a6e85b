/* SPDX-License-Identifier: MIT */
/* Any bytes as a state file: refused in a sentence that leaves everything alone, or in range.
 *
 * reaches: state.c:take_values state.c:put_value
 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "app/records/records.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	const struct state_values before = {{12.5, false}, SHOW_QUAD, 3};
	struct state_values values = before;
	struct fault fault = {.text = ""};

	if (state_read_memory((const char *)data, bytes, "fuzz", &values, &fault)) {
		if (!*fault.text || values.threshold.value != before.threshold.value ||
		    values.view != before.view || values.pose != before.pose)
			abort();
		return 0;
	}
	if (!(values.threshold.value >= 0 &&
	      values.threshold.value <= (values.threshold.percent ? 100 : 255)) ||
	    values.view < 0 || values.view >= SHOW_COUNT || values.pose < 0 || values.pose > 65535)
		abort();
	return 0;
}
