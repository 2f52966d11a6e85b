/* SPDX-License-Identifier: MIT */
/* Reads a mesh file through assimp. The mesh is in the file's coordinates, and its geometry is not
 * yet checked. */
#ifndef INLAY_BAKE_MESH_MESH_IMPORT_H
#define INLAY_BAKE_MESH_MESH_IMPORT_H

#include <stdbool.h>

#include "bake/mesh/mesh.h"

/* crease_deg: as of mesh_smooth(), where the file has no normals. materials: read those of the
 * file, too. Call mesh_free() also after a failure. */
int mesh_import(struct mesh *mesh, const char *path, double crease_deg, bool materials,
		struct fault *fault);

#endif
