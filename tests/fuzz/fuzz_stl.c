/* SPDX-License-Identifier: MIT */
/* Any bytes as an STL: read, or refused in a sentence.
 *
 * reaches: stl.c:stl_read_binary stl.c:stl_vertex stl.c:stl_corner
 */
#include <stdint.h>
#include <stdlib.h>

#include "bake/mesh/formats/formats.h"
#include "tests/fuzz/as_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};
	struct mesh mesh = {.part_count = 0};

	if ((stl_read(&mesh, as_file(data, bytes), 60, true, &fault) == 0) != !fault.text[0])
		abort();
	mesh_free(&mesh);
	return 0;
}
