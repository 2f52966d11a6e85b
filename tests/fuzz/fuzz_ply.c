/* Any bytes as a PLY: refused in a sentence, or passed on to the library that reads meshes. That is
 * not called: it is not ours, and what it does with what we let pass is tests/unit/test_scene.c's.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#include "bake/mesh_ply.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes)
{
	static int file = -1;
	struct fault fault = {.text = ""};
	char path[64];

	if (file < 0)
		file = memfd_create("ply", MFD_CLOEXEC);
	if (file < 0 || ftruncate(file, 0) || pwrite(file, data, bytes, 0) != (ssize_t)bytes)
		abort();
	snprintf(path, sizeof(path), "/proc/self/fd/%d", file);
	if ((mesh_ply_check(path, &fault) == 0) != !fault.text[0])
		abort();
	return 0;
}
