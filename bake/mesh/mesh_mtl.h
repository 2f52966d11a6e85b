/* SPDX-License-Identifier: MIT */
/* Whether an OBJ's materials are there: assimp makes grey of those that are not, without a word. */
#ifndef INLAY_BAKE_MESH_MESH_MTL_H
#define INLAY_BAKE_MESH_MESH_MTL_H

#include "hal/base/fault.h"

/* 0 for any other file. -ENOENT: an mtllib that cannot be opened, where a usemtl may have meant it;
 * -EINVAL: a usemtl that none of them has, a library that is
 * no plain file; -EFBIG. The fault names file and line. */
int mesh_mtl_check(const char *path, struct fault *fault);

#endif
