/* SPDX-License-Identifier: MIT */
/* Any bytes as the thesis's file: refused in a sentence with nothing kept, or every pixel inside
 * it, and every value that import takes of it finite.
 *
 * reaches: msi.c:msi_find_pixels msi.c:try_variant msi.c:is_flat msi.c:fill_shadow
 * msi.c:fill_object
 */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "bake/exchange/msi.h"
#include "tests/support/as_file.h"

#define LIGHTS 6 /* the dome of frequency 1 */

static void check_tile(const struct msi_source *source)
{
	static float object[IMPORT_PIXELS * 3 * LIGHTS], with[IMPORT_PIXELS * 3 * LIGHTS],
		without[IMPORT_PIXELS * 3 * LIGHTS];
	const struct msi *msi = source->msi;
	struct import_tile tile = {
		.width = msi->width < BASIS_TILE ? msi->width : BASIS_TILE,
		.height = msi->height < BASIS_TILE ? msi->height : BASIS_TILE,
		.object = object,
		.with = with,
		.without = without,
	};

	msi_fill(source, &tile);
	for (size_t k = 0; k < sizeof(object) / sizeof(*object); k++)
		if (!isfinite(object[k]) || !isfinite(with[k]) || !isfinite(without[k]))
			abort();
}

static void fuzz_msi_check(const struct msi *msi)
{
	static const int place[LIGHTS] = {0, 1, 2, 3, 4, 5};
	static struct dome dome;
	struct msi_source source;

	for (long p = 0; p < (long)msi->width * msi->height; p++)
		if (msi->start[p] + 1 + (size_t)msi->data[msi->start[p]] * 3 * (size_t)msi->lights >
		    msi->bytes)
			abort();
	if (msi->lights != LIGHTS)
		return;
	if (!dome.count && dome_create(&dome, 1, NULL))
		abort();
	if (msi_source_create(&source, msi, &dome, place, 1))
		return;
	check_tile(&source);
	msi_source_free(&source);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};
	struct msi msi;

	if (msi_open(&msi, as_file(data, bytes), &fault) == 0)
		fuzz_msi_check(&msi);
	else if (!fault.text[0] || msi.data || msi.start)
		abort();
	msi_close(&msi);
	return 0;
}
