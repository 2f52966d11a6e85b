/* SPDX-License-Identifier: MIT */
/* Any bytes as an OBJ and, behind the first NUL, its library: read, or refused in a sentence.
 *
 * reaches: obj.c:obj_corner obj.c:obj_miss obj.c:obj_colour mtl.c:mtl_make mtl.c:map_take_option
 * ears.c:ears_cut_all mesh_normals.c:normal_sums_around text.c:text_append textures.c:textures_take
 * beside.c:append_any_case
 */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/mesh/formats/formats.h"
#include "tests/support/as_file.h"

static char folder[] = "/tmp/inlay-fuzz-XXXXXX";
static char obj[64], mtl[64];

static void clean_up(void)
{
	unlink(obj);
	unlink(mtl);
	rmdir(folder);
}

/* In place of any library that does not exist, fuzz.mtl is read; a picture may be one of the two
 * files. */
static void fuzz_obj_begin(void)
{
	if (!mkdtemp(folder))
		abort();
	snprintf(obj, sizeof(obj), "%s/fuzz.obj", folder);
	snprintf(mtl, sizeof(mtl), "%s/fuzz.mtl", folder);
	atexit(clean_up);
}

static void fuzz_obj_put(const char *path, const uint8_t *data, size_t bytes)
{
	FILE *file = fopen(path, "wb");

	if (!file || fwrite(data, 1, bytes, file) != bytes || fclose(file))
		abort();
}

/* Names that lead out of the folder would make the result depend on this machine. Slashes stand
 * between numbers, backslashes at the ends of lines. */
static bool fuzz_obj_leads_out(const uint8_t *data, size_t bytes)
{
	for (size_t k = 0; k < bytes; k++) {
		const uint8_t before = k ? data[k - 1] : ' ',
			      after = k + 1 < bytes ? data[k + 1] : ' ';

		if ((data[k] == '.' && after == '.') ||
		    (data[k] == '/' && before != '/' && (before < '0' || before > '9')) ||
		    (data[k] == '\\' && after != '\n'))
			return true;
	}
	return false;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	const uint8_t *end = bytes ? memchr(data, 0, bytes) : NULL;
	const size_t first = end ? (size_t)(end - data) : bytes;
	struct fault fault = {.text = ""};
	struct mesh mesh = {.part_count = 0};

	if (!obj[0])
		fuzz_obj_begin();
	if (fuzz_obj_leads_out(data, bytes))
		return 0;
	fuzz_obj_put(obj, data, first);
	unlink(mtl);
	if (end)
		fuzz_obj_put(mtl, end + 1, bytes - first - 1);
	if ((obj_read(&mesh, obj, 60, true, &fault) == 0) != !fault.text[0])
		abort();
	mesh_free(&mesh);
	return 0;
}
