/* SPDX-License-Identifier: MIT */
/* Any bytes as an OBJ and, behind the first NUL, its library: all that it uses is there, or a
 * sentence says what is not.
 *
 * reaches: mesh_mtl.c:check_used mesh_mtl.c:read_library mesh_mtl.c:add_name
 * mesh_mtl.c:miss_library
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bake/mesh/mesh_mtl.h"
#include "tests/fuzz/as_file.h"

static char folder[] = "/tmp/inlay-fuzz-XXXXXX";
static char obj[64], mtl[64];

static void clean_up(void)
{
	unlink(obj);
	unlink(mtl);
	rmdir(folder);
}

/* In place of any library that does not exist, fuzz.mtl is read. */
static void fuzz_mtl_begin(void)
{
	if (!mkdtemp(folder))
		abort();
	snprintf(obj, sizeof(obj), "%s/fuzz.obj", folder);
	snprintf(mtl, sizeof(mtl), "%s/fuzz.mtl", folder);
	atexit(clean_up);
}

static void fuzz_mtl_put(const char *path, const uint8_t *data, size_t bytes)
{
	FILE *file = fopen(path, "wb");

	if (!file || fwrite(data, 1, bytes, file) != bytes || fclose(file))
		abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	const uint8_t *end = bytes ? memchr(data, 0, bytes) : NULL;
	const size_t first = end ? (size_t)(end - data) : bytes;
	struct fault fault = {.text = ""};

	if (!obj[0])
		fuzz_mtl_begin();
	/* names that lead out of the folder would make the result depend on this machine */
	if (bytes && (memchr(data, '/', bytes) || memmem(data, bytes, "..", 2)))
		return 0;
	fuzz_mtl_put(obj, data, first);
	unlink(mtl);
	if (end)
		fuzz_mtl_put(mtl, end + 1, bytes - first - 1);
	if (mesh_mtl_check(obj, &fault) && !fault.text[0])
		abort();
	return 0;
}
