/* SPDX-License-Identifier: MIT */
/* Checks that a PLY holds what its header says: where it does not, assimp invents faces, never
 * stops reading, or allocates memory for billions of them. */
#ifndef INLAY_BAKE_MESH_MESH_PLY_H
#define INLAY_BAKE_MESH_MESH_PLY_H

#include "hal/base/fault.h"

/* Returns 0 also for any other kind of file. -ENOENT ...: not a plain file that can be opened;
 * -EBADMSG: a header without end or meaning, more rows than the file can hold or has, or a wrong
 * face; -ENOTSUP: binary data that assimp would misread; -E2BIG: too many elements or properties.
 * The fault names the file and, in text, the line. Vertex indices of binary files are not
 * checked. */
int mesh_ply_check(const char *path, struct fault *fault);

#endif
