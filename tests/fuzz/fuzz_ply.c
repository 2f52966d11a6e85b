/* SPDX-License-Identifier: MIT */
/* Any bytes as a PLY: refused in a sentence, or passed on to the library that reads meshes. That is
 * not called: it is not ours, and what it does with what we let pass is tests/unit/bake/scene/test_scene.c's.
 *
 * reaches: mesh_ply.c:check_counts mesh_ply.c:check_corner mesh_ply.c:check_values
 * mesh_ply.c:check_text_row mesh_ply.c:check_binary_row
 */
#include <stdint.h>
#include <stdlib.h>

#include "bake/mesh/mesh_ply.h"
#include "tests/fuzz/as_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};

	if ((mesh_ply_check(as_file(data, bytes), &fault) == 0) != !fault.text[0])
		abort();
	return 0;
}
