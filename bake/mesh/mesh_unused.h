/* SPDX-License-Identifier: MIT */
/* Leaves out the vertices of a mesh that no face has. */
#ifndef INLAY_BAKE_MESH_MESH_UNUSED_H
#define INLAY_BAKE_MESH_MESH_UNUSED_H

#include <stddef.h>
#include <stdint.h>

/* Numbers the vertices that corners name, in their order; the others' number is UINT32_MAX. Corners
 * get the new numbers, which are not larger. Returns how many vertices are used. */
size_t mesh_number_used(uint32_t *corner, size_t corners, uint32_t *number, size_t vertices);

/* Moves the rows of an array, of so many bytes each, to such numbers. NULL is harmless. */
void mesh_move_rows(void *array, size_t bytes, const uint32_t *number, size_t count);

#endif
