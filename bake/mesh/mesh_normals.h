/* SPDX-License-Identifier: MIT */
/* Computes the normals of the smoothed surface, where a mesh's file has none. */
#ifndef INLAY_BAKE_MESH_MESH_NORMALS_H
#define INLAY_BAKE_MESH_MESH_NORMALS_H

#include "bake/mesh/mesh.h"

/*
 * Gives each corner of a triangle the mean normal of all triangles that meet at its place and whose
 * normals differ from its own by less than crease_deg, weighted by their angles there (Thuermer and
 * Wuethrich, Computing Vertex Normals from Polygonal Facets, 1998). The result does not depend on
 * whether triangles of the file share vertices: a vertex whose corners need several normals becomes
 * several vertices. Triangles without area have no weight, and a normal of 0. Indices must be in
 * range. -ENOMEM.
 */
int mesh_smooth(struct mesh_part *part, double crease_deg);

#endif
