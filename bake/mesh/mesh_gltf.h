/* SPDX-License-Identifier: MIT */
/* Whether a glTF can be handed to assimp, which trusts the lengths of a GLB, and goes down into
 * JSON as deep as it is nested, until its stack ends. */
#ifndef INLAY_BAKE_MESH_MESH_GLTF_H
#define INLAY_BAKE_MESH_MESH_GLTF_H

#include "hal/base/fault.h"

/* 0 for any other file. -ENOENT ...: not a plain file that can be opened; -EBADMSG: a GLB whose
 * lengths are not those of the file; -E2BIG: JSON that is nested deeper than any mesh's. The fault
 * names the file. */
int mesh_gltf_check(const char *path, struct fault *fault);

#endif
