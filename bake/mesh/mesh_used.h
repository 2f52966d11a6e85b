/* SPDX-License-Identifier: MIT */
/* Vertices that no triangle has are forgotten. */
#ifndef INLAY_BAKE_MESH_MESH_USED_H
#define INLAY_BAKE_MESH_MESH_USED_H

#include "bake/mesh/mesh.h"

/* Numbers the vertices that corners name, in their order; the others' number is UINT32_MAX. Corners
 * get the new numbers, which are not larger. Returns how many vertices are used. */
size_t mesh_number_used(uint32_t *corner, size_t corners, uint32_t *number, size_t vertices);
/* Moves the rows of an array to such numbers. */
void mesh_move_rows(void *array, size_t bytes, const uint32_t *number, size_t count);

/* Does both to a part. -ENOMEM. */
int mesh_drop_unused(struct mesh_part *part);

#endif
