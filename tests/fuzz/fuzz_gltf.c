/* SPDX-License-Identifier: MIT */
/* Any bytes as a glTF: read, or refused in a sentence.
 *
 * reaches: document.cpp:read_glb document.cpp:parse document.cpp:data_decode
 * document.cpp:decompress document.cpp:part accessor.cpp:find_elements accessor.cpp:find_replaced
 * geometry.cpp:read_triangles geometry.cpp:add_morph nodes.cpp:skin_matrices
 * nodes.cpp:instance_matrices gltf.cpp:apply_skin materials.cpp:read_use input.c:input_read
 */
#include <stdlib.h>

#include "bake/mesh/gltf/gltf.h"
#include "tests/support/as_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};
	struct mesh mesh = {.part_count = 0};

	if ((gltf_read(&mesh, as_file(data, bytes), 60, true, &fault) == 0) != !fault.text[0])
		abort();
	mesh_free(&mesh);
	return 0;
}
