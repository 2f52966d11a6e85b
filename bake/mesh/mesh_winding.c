/* SPDX-License-Identifier: MIT */
#include "bake/mesh/mesh_winding.h"

#include <string.h>

#include "bake/base/random.h"

static uint64_t hash_of(struct v3 v)
{
	uint32_t bits[3];

	v = v3_add(v, v3_make(0, 0, 0)); /* -0 becomes 0 */
	memcpy(bits, &v, sizeof(bits));
	return random_hash(bits[0], bits[1], bits[2]);
}

/* Sums a random number for each directed edge, which is minus that of the opposite edge. On a
 * closed and oriented surface the sum is 0; on others with a probability of 2^-64. */
bool mesh_is_closed(const struct mesh_part *parts, int count)
{
	uint64_t sum = 0;

	for (int p = 0; p < count; p++)
		for (int t = 0; t < parts[p].triangles; t++)
			for (int k = 0; k < 3; k++) {
				const uint64_t a = hash_of(mesh_corner(&parts[p], t, k));
				const uint64_t b = hash_of(mesh_corner(&parts[p], t, (k + 1) % 3));

				sum += random_hash(a, b, 0) - random_hash(b, a, 0);
			}
	return sum == 0;
}

/* Six times the volume, as a sum over tetrahedra from the first vertex. */
static double signed_volume(const struct mesh_part *parts, int count)
{
	const struct v3 from = mesh_corner(parts, 0, 0);
	double sum = 0;

	for (int p = 0; p < count; p++)
		for (int t = 0; t < parts[p].triangles; t++) {
			const struct v3 a = v3_sub(mesh_corner(&parts[p], t, 0), from);
			const struct v3 b = v3_sub(mesh_corner(&parts[p], t, 1), from);
			const struct v3 c = v3_sub(mesh_corner(&parts[p], t, 2), from);

			sum += (double)v3_dot(a, v3_cross(b, c));
		}
	return sum;
}

void mesh_turn_outwards(struct mesh *mesh)
{
	if (!mesh_is_closed(mesh->parts, mesh->part_count) ||
	    signed_volume(mesh->parts, mesh->part_count) >= 0)
		return;
	for (int p = 0; p < mesh->part_count; p++)
		for (int t = 0; t < mesh->parts[p].triangles; t++) {
			uint32_t *index = mesh->parts[p].index[t];
			const uint32_t second = index[1];

			index[1] = index[2];
			index[2] = second;
		}
}
