/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh_unused.h"

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
