/* SPDX-License-Identifier: MIT */
/* Any bytes as a PLY: read, or refused in a sentence.
 *
 * reaches: ply.c:check_corner ply.c:ply_take_list ply.c:binary_value ply.c:ply_add_strip
 * ply.c:header_comment ply.c:ply_add_materials
 */
#include <stdint.h>
#include <stdlib.h>

#include "bake/mesh/formats/formats.h"
#include "tests/fuzz/as_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};
	struct mesh mesh = {.part_count = 0};

	if ((ply_read(&mesh, as_file(data, bytes), 60, true, &fault) == 0) != !fault.text[0])
		abort();
	mesh_free(&mesh);
	return 0;
}
