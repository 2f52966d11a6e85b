/* SPDX-License-Identifier: MIT */
/* Whether a PLY holds what its header says: where it does not, assimp makes faces up, reads on for
 * ever, or takes memory for billions of them. */
#ifndef INLAY_BAKE_MESH_MESH_PLY_H
#define INLAY_BAKE_MESH_MESH_PLY_H

#include "hal/base/fault.h"

/* 0 for any other file. -ENOENT ...: not a plain file that can be opened; -EBADMSG: a header
 * without end or meaning, more rows than the file can hold or has, a face that is none; -E2BIG:
 * more elements or properties than are read. The fault names the file and, of text, the line.
 * Indices of binary files are not looked at. */
int mesh_ply_check(const char *path, struct fault *fault);

#endif
