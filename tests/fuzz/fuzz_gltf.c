/* SPDX-License-Identifier: MIT */
/* Any bytes as a glTF: refused in a sentence, or passed on to the library that reads meshes.
 *
 * reaches: mesh_gltf.c:check_glb mesh_gltf.c:check_chunks mesh_gltf.c:check_depth
 * plain_file.c:plain_file_map
 */
#include <stdlib.h>

#include "bake/mesh/mesh_gltf.h"
#include "tests/fuzz/as_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	struct fault fault = {.text = ""};

	if ((mesh_gltf_check(as_file(data, bytes), &fault) == 0) != !fault.text[0])
		abort();
	return 0;
}
