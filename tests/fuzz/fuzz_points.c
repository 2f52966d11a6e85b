/* SPDX-License-Identifier: MIT */
/* Any bytes as a file of points: refused in a sentence with nothing kept, or points that are
 * finite.
 *
 * reaches: observations.c:read_point observations.c:observations_add
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "bake/calibrate/observe/observations.h"
#include "tests/support/as_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static const struct points_convention up = {.height = 480, .y_up = 1, .pixel_centre = 0};
	struct observations all = {0};
	struct fault fault = {.text = ""};

	if (observations_read(&all, as_file(data, bytes), &up, &fault)) {
		if (!*fault.text || all.count || all.views)
			abort();
	} else if (all.count < 1 || all.views != 1 || all.view[0].count != all.count) {
		abort();
	}
	for (int i = 0; i < all.count; i++) {
		const struct observation *point = &all.point[i];

		for (int k = 0; k < 3; k++)
			if (!isfinite(point->world[k]) || (k < 2 && !isfinite(point->px[k])))
				abort();
	}
	observations_free(&all);
	return 0;
}
