/* SPDX-License-Identifier: MIT */
/* The scene file: any bytes give a scene or a fault, never a crash. Nothing it names is opened.
 *
 * reaches: scene_file.c:scene_check_camera scene_file.c:scene_check_ground
 * scene_file.c:check_material_name scene_file.c:scene_place_tsai scene_file.c:scene_place_standin
 * scene_file.c:scene_place_keyframe keyframes.c:keyframes_settle
 */
#include <stdint.h>
#include <stdlib.h>

#include "bake/scene/scene_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static struct scene_file file;
	struct fault fault = {.text = ""};
	const int err = scene_file_read_memory(&file, (const char *)data, bytes, "scene", &fault);

	/* a refusal gives a reason; an accepted scene can be used */
	if (err ? !fault.text[0] : file.mesh_count < 1)
		abort();
	for (int k = 0; !err && k < file.mesh_count; k++)
		if (file.mesh[k].material[0] && !scene_file_material(&file, file.mesh[k].material))
			abort();
	return 0;
}
