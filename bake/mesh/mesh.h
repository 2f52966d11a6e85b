/* SPDX-License-Identifier: MIT */
/*
 * Triangle meshes in world coordinates, from files: glTF, OBJ with MTL, PLY and STL.
 */
#ifndef INLAY_BAKE_MESH_MESH_H
#define INLAY_BAKE_MESH_MESH_H

#include <math.h>
#include <stdint.h>

#include "bake/mesh/material.h"
#include "hal/base/fault.h"

/* Triangles that share a material. */
struct mesh_part {
	int vertices, triangles;
	float (*position)[4]; /* [vertices]: x y z and padding, which Embree needs */
	struct v3 *normal;    /* [vertices]: unit, of the smoothed surface */
	float (*uv)[2];	      /* [vertices]: texture coordinates; NULL: none */
	float (*uv2)[2];      /* [vertices]: a second set; NULL: none */
	float (*tangent)
		[4]; /* [vertices]: along u of the material's bumps; w: 1 or -1, and along v is
				 w (normal x tangent). NULL: both follow from the coordinates */
	float (*colour)[4];   /* [vertices]: linear R G B and alpha, 0..1; NULL: 1 */
	uint32_t (*index)[3]; /* [triangles] */
	int material;	      /* index in the mesh's own list */
};

/* Corner k of a triangle. */
static inline struct v3 mesh_corner(const struct mesh_part *part, int triangle, int k)
{
	const float *p = part->position[part->index[triangle][k]];

	return v3_make(p[0], p[1], p[2]);
}

struct mesh {
	double origin[3]; /* of a reader's positions; mesh_read() adds it */
	struct mesh_part *parts;
	int part_count;
	struct material *materials; /* those of the file */
	int material_count;
	struct texture **textures;
	int texture_count;
};

/* Placement of a mesh, in this order: scaled, turned upright, rotated about X, Y and Z, moved. */
struct mesh_placement {
	double scale;
	double rotate_deg[3];
	double position[3];
	double crease_deg; /* edges sharper than this stay sharp where the file has no normals */
	int y_up;	   /* the file's up axis is Y: turn it so that its -Z points along +Y */
	int stand;	   /* finally move it along Z, so that its lowest point has Z = 0 */
	int own_materials; /* read the file's materials and textures */
};

/* Chooses the origin from which a reader rounds positions to single precision: any vertex that a
 * face has, in whole units; 0 where it is near. */
static inline void mesh_set_origin(double origin[3], const double vertex[3])
{
	for (int axis = 0; axis < 3; axis++)
		origin[axis] = fabs(vertex[axis]) < 1024 ? 0 : round(vertex[axis]);
}

/* Reads, checks and places a mesh; vertices that no face has are dropped, and one that is closed
 * and wound inwards is turned. -ENOENT ...; -ENOTSUP: another kind of file; -EBADMSG: not a mesh;
 * -ENODATA: no triangle, or none that has an area; -EDOM: a vertex is not finite; -ERANGE: the mesh
 * is so small and far from the origin, in a file of floats or in the world, that single precision
 * rounds its vertices to a hundredth of its size (from a two-thousandth on it says so), or it lies
 * beyond 1e9 world units. The fault names the file. mesh_free() also after a failure. */
int mesh_read(struct mesh *mesh, const char *path, const struct mesh_placement *placement,
	      struct fault *fault);

/* Hash of geometry, materials and texels. */
uint64_t mesh_hash(const struct mesh *mesh);

void mesh_free(struct mesh *mesh); /* idempotent; zeroed is fine */

/*
 * Gives each corner of a triangle the mean normal of all triangles that meet at its place and whose
 * normals differ from its own by less than crease_deg, weighted by their angles there (Thuermer and
 * Wuethrich, Computing Vertex Normals from Polygonal Facets, 1998). The result does not depend on
 * whether triangles of the file share vertices: a vertex whose corners need several normals becomes
 * several vertices. Triangles without area have no weight, and a normal of 0. Indices must be in
 * range. -ENOMEM.
 */
int mesh_smooth(struct mesh_part *part, double crease_deg);

/* Numbers the vertices that corners name, in their order; the others' number is UINT32_MAX. Corners
 * get the new numbers, which are not larger. Returns how many vertices are used. */
size_t mesh_number_used(uint32_t *corner, size_t corners, uint32_t *number, size_t vertices);
/* Moves the rows of an array to such numbers. */
void mesh_move_rows(void *array, size_t bytes, const uint32_t *number, size_t count);

/* Does both to a part. -ENOMEM. */
int mesh_drop_unused(struct mesh_part *part);

#endif
