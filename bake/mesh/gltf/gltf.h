/* SPDX-License-Identifier: MIT */
/*
 * Reads glTF 2.0 and GLB: what the scene shows at rest, in the file's coordinates. README.md lists
 * the extensions.
 */
#ifndef INLAY_BAKE_MESH_GLTF_GLTF_H
#define INLAY_BAKE_MESH_GLTF_GLTF_H

#include <stdbool.h>

#include "bake/mesh/mesh.h"
#include "hal/base/fault.h"

/* Tells whether a file is a glTF, by its ending or else by its first bytes. */
bool gltf_is(const char *path);

/* Adds parts, materials and textures to a zeroed mesh, which the caller frees, also after a
 * failure. crease_deg: as of mesh_smooth(), where the file has no normals. materials: read those,
 * too. What the bake cannot show is said in one line (left_out.h). -EBADMSG: damaged; -ENOTSUP: it
 * needs an extension or a kind of picture that is not known; -E2BIG: JSON nested deeper than that
 * of any mesh; -EFBIG: too many triangles. */
int gltf_read(struct mesh *mesh, const char *path, double crease_deg, bool materials,
	      struct fault *fault);

#endif
