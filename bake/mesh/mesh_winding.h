/* SPDX-License-Identifier: MIT */
/* Closed surfaces, and which side of them is the outer one. */
#ifndef INLAY_BAKE_MESH_MESH_WINDING_H
#define INLAY_BAKE_MESH_MESH_WINDING_H

#include <stdbool.h>

#include "bake/mesh/mesh.h"

/* Tells whether the surface is closed and oriented: the triangles at each edge, vertices at the
 * same place taken as one, pass along it as often in one direction as in the other. */
bool mesh_is_closed(const struct mesh_part *parts, int count);

/* Turns a closed surface that is wound inwards: one whose volume is negative. */
void mesh_turn_outwards(struct mesh *mesh);

#endif
