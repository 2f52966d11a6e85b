/* SPDX-License-Identifier: MIT */
/* Checks whether a glTF is safe to hand to assimp, which trusts the lengths in a GLB and overflows
 * its stack on deeply nested JSON. */
#ifndef INLAY_BAKE_MESH_MESH_GLTF_H
#define INLAY_BAKE_MESH_MESH_GLTF_H

#include "hal/base/fault.h"

/* Returns 0 for a safe file and for any other kind of file. -ENOENT ...: not a plain file that can
 * be opened; -EBADMSG: a GLB whose lengths do not fit the file; -E2BIG: JSON nested deeper than
 * that of any mesh. The fault names the file. */
int mesh_gltf_check(const char *path, struct fault *fault);

#endif
