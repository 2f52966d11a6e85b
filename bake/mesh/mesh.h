/* SPDX-License-Identifier: MIT */
/*
 * Triangle meshes from files (OBJ with MTL, PLY, glTF and whatever else assimp reads), in world
 * coordinates.
 */
#ifndef INLAY_BAKE_MESH_MESH_H
#define INLAY_BAKE_MESH_MESH_H

#include <stdint.h>

#include "bake/mesh/material.h"
#include "hal/base/fault.h"

/* Triangles that share a material. */
struct mesh_part {
	int vertices, triangles;
	float (*position)[4]; /* x y z and padding, as Embree likes it */
	struct v3 *normal;    /* unit; of the smoothed surface */
	float (*uv)[2];	      /* NULL: none */
	uint32_t (*index)[3];
	int material; /* in the mesh's own list */
};

struct mesh {
	struct mesh_part *parts;
	int part_count;
	struct material *materials; /* as the file gives them */
	int material_count;
	struct texture **textures;
	int texture_count;
};

/* Where a mesh stands: scaled, turned upright, rotated about X, then Y, then Z, then moved. */
struct mesh_placement {
	double scale;
	double rotate_deg[3];
	double position[3];
	double crease_deg; /* edges sharper than this stay sharp where the file has no normals */
	int y_up;	   /* the file's up axis is Y: turned so that its -Z looks along +Y */
	int stand;	   /* moved along Z at last, so that the lowest point touches Z = 0 */
	int own_materials; /* read the file's materials and their textures */
};

/* -ENOENT..., -EBADMSG: not a mesh; -ENODATA: no triangle, or none that has an area; -EDOM: a
 * vertex that is not finite; -ERANGE: so small and far from the origin, in the file or in the
 * world, that its vertices are rounded visibly, or beyond 1e9 world units. The fault names the
 * file. */
int mesh_read(struct mesh *mesh, const char *path, const struct mesh_placement *placement,
	      struct fault *fault);

/* A hash of everything in it: geometry, materials, texels. */
uint64_t mesh_hash(const struct mesh *mesh);

void mesh_free(struct mesh *mesh); /* idempotent; zeroed is fine */

#endif
