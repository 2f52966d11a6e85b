/* SPDX-License-Identifier: MIT */
/* Normals of the smoothed surface, where a mesh's file has none. */
#ifndef INLAY_BAKE_MESH_MESH_NORMALS_H
#define INLAY_BAKE_MESH_MESH_NORMALS_H

#include "bake/mesh/mesh.h"

/*
 * Each corner of a triangle gets the mean of the normals of all triangles that meet at its place
 * and differ from its own by less than crease_deg, weighted by their angles there (Thuermer and
 * Wuethrich, Computing Vertex Normals from Polygonal Facets, 1998). Whether the file lets triangles
 * share vertices makes no difference: a vertex whose corners need several normals becomes several.
 * Triangles without area have no say, and a normal of 0. Indices must be in range. -ENOMEM.
 */
int mesh_smooth(struct mesh_part *part, double crease_deg);

#endif
