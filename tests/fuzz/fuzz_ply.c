/* SPDX-License-Identifier: MIT */
/* Any bytes as a PLY and as an STL: read, or refused in a sentence.
 *
 * reaches: ply.c:check_corner ply.c:ply_take_property ply.c:binary_value ply.c:ply_add_strip
 * ply.c:header_comment ply.c:ply_add_materials stl.c:stl_read_binary stl.c:stl_vertex
 * stl.c:stl_corner
 */
#include <stdint.h>
#include <stdlib.h>

#include "bake/mesh/formats/formats.h"
#include "tests/support/as_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	const char *path = as_file(data, bytes);

	for (int stl = 0; stl < 2; stl++) {
		struct fault fault = {.text = ""};
		struct mesh mesh = {.part_count = 0};
		const int err = (stl ? stl_read : ply_read)(&mesh, path, 60, true, &fault);

		if ((err == 0) != !fault.text[0])
			abort();
		mesh_free(&mesh);
	}
	return 0;
}
