/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

size_t mesh_number_used(uint32_t *corner, size_t corners, uint32_t *number, size_t vertices)
{
	uint32_t used = 0;

	memset(number, 0xff, vertices * sizeof(*number));
	for (size_t k = 0; k < corners; k++)
		number[corner[k]] = 0;
	for (size_t v = 0; v < vertices; v++)
		if (number[v] == 0)
			number[v] = used++;
	for (size_t k = 0; k < corners; k++)
		corner[k] = number[corner[k]];
	return used;
}

void mesh_move_rows(void *array, size_t bytes, const uint32_t *number, size_t count)
{
	char *rows = array;

	for (size_t v = 0; rows && v < count; v++)
		if (number[v] != UINT32_MAX)
			memmove(rows + number[v] * bytes, rows + v * bytes, bytes);
}

int mesh_drop_unused(struct mesh_part *part)
{
	const size_t count = (size_t)part->vertices;
	uint32_t *number = malloc((count + 1) * sizeof(*number));

	if (!number)
		return -ENOMEM;
	part->vertices = (int)mesh_number_used(&part->index[0][0], 3 * (size_t)part->triangles,
					       number, count);
	mesh_move_rows(part->position, sizeof(*part->position), number, count);
	mesh_move_rows(part->normal, sizeof(*part->normal), number, count);
	mesh_move_rows(part->uv, sizeof(*part->uv), number, count);
	mesh_move_rows(part->uv2, sizeof(*part->uv2), number, count);
	mesh_move_rows(part->tangent, sizeof(*part->tangent), number, count);
	mesh_move_rows(part->colour, sizeof(*part->colour), number, count);
	free(number);
	return 0;
}
