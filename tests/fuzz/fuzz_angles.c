/* SPDX-License-Identifier: MIT */
/* Any bytes as a file of light angles: refused in a sentence with nothing kept, or all the lights
 * of a dome, each once.
 *
 * reaches: angles.c:find_dome angles.c:match_lines
 */
#include <stdint.h>
#include <stdlib.h>

#include "bake/base/angles.h"
#include "tests/support/as_file.h"

static void fuzz_angles_check(const struct dome *dome, const int *light)
{
	char *taken = calloc((size_t)dome->count, 1);

	if (!taken)
		abort();
	for (int k = 0; k < dome->count; k++) {
		if (light[k] < 0 || light[k] >= dome->count || taken[light[k]])
			abort();
		taken[light[k]] = 1;
	}
	free(taken);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};
	struct dome dome;
	int *light;

	if (angles_read(as_file(data, bytes), &dome, &light, &fault) == 0)
		fuzz_angles_check(&dome, light);
	else if (!fault.text[0] || light)
		abort();
	free(light);
	dome_free(&dome);
	return 0;
}
