/* SPDX-License-Identifier: MIT */
/* Checks that an OBJ's materials exist: assimp silently replaces missing ones by grey. */
#ifndef INLAY_BAKE_MESH_MESH_MTL_H
#define INLAY_BAKE_MESH_MESH_MTL_H

#include "hal/base/fault.h"

/* Returns 0 also for any other kind of file. -ENOENT: a usemtl is missing, and an mtllib that may
 * have it cannot be opened; -EINVAL: no library has the material of a usemtl, or a library is no
 * plain file; -EFBIG. The fault names file and line. */
int mesh_mtl_check(const char *path, struct fault *fault);

#endif
