/* SPDX-License-Identifier: MIT */
/* Any bytes as a lights file: refused in a sentence, or six lights, finite and of at least 0.
 *
 * reaches: lights_file.c:lights_read_lines lights_file.c:parse_colour
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "hal/lights/lights_file.h"
#include "tests/support/as_file.h"

#define LIGHTS 6

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	float radiance[LIGHTS][3];
	struct fault fault = {.text = ""};

	if (lights_file_read(as_file(data, bytes), radiance, LIGHTS, &fault)) {
		if (!*fault.text)
			abort();
		return 0;
	}
	for (int i = 0; i < LIGHTS; i++) {
		for (int c = 0; c < 3; c++) {
			if (!isfinite(radiance[i][c]) || radiance[i][c] < 0)
				abort();
		}
	}
	return 0;
}
