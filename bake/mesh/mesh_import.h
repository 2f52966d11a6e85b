/* SPDX-License-Identifier: MIT */
/* Reads a mesh file through assimp, as the file has it: not placed, not checked. */
#ifndef INLAY_BAKE_MESH_MESH_IMPORT_H
#define INLAY_BAKE_MESH_MESH_IMPORT_H

#include <stdbool.h>

#include "bake/mesh/mesh.h"

/* What was read before a failure stays in mesh, for mesh_free(). */
int mesh_import(struct mesh *mesh, const char *path, double crease_deg, bool materials,
		struct fault *fault);

#endif
