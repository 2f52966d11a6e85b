/* SPDX-License-Identifier: MIT */
/*
 * Reads OBJ with MTL, PLY and STL: one reader for each, and each the only one that looks into its
 * kind of file. The mesh is in the file's coordinates. Its indices are in range and its vertices
 * finite; it may have no triangles, or none with an area.
 */
#ifndef INLAY_BAKE_MESH_FORMATS_FORMATS_H
#define INLAY_BAKE_MESH_FORMATS_FORMATS_H

#include <stdbool.h>

#include "bake/mesh/mesh.h"

/*
 * crease_deg: as of mesh_smooth(), where the file has no normals. materials: reads those of the
 * file too, and colours of its vertices. Logs what is left out. -ENOENT ...: the file, a library or
 * a picture cannot be opened; -EBADMSG: not what its kind of file has there; -EINVAL: a material
 * that no library has; -EDOM: a vertex that is not finite; -EFBIG. The fault names the file and, in
 * text, the line. mesh_free() also after a failure.
 */
int obj_read(struct mesh *mesh, const char *path, double crease_deg, bool materials,
	     struct fault *fault);
int ply_read(struct mesh *mesh, const char *path, double crease_deg, bool materials,
	     struct fault *fault);
int stl_read(struct mesh *mesh, const char *path, double crease_deg, bool materials,
	     struct fault *fault);

#endif
