/* SPDX-License-Identifier: MIT */
#include "bake/demo/polygonise.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/vec.h"

#define EVENING_PASSES 5
#define NEWTON_STEPS 6
#define CLOSE_ENOUGH 1e-7 /* of a step */

struct grid {
	const struct solid *solid;
	double step;
	int size[3];  /* corners along x, y, z */
	float *value; /* at each corner */
	int *vertex;  /* of each cell, named by its lowest corner; -1: not crossed */
};

static size_t grid_index(const struct grid *grid, int x, int y, int z)
{
	return ((size_t)z * grid->size[1] + y) * grid->size[0] + x;
}

static void grid_point(const struct grid *grid, double x, double y, double z, double p[3])
{
	p[0] = grid->solid->low[0] + (x - 1) * grid->step;
	p[1] = grid->solid->low[1] + (y - 1) * grid->step;
	p[2] = grid->solid->low[2] + (z - 1) * grid->step;
}

static int grid_create(struct grid *grid, const struct solid *solid, double step)
{
	size_t count = 1;
	size_t at = 0;

	grid->solid = solid;
	grid->step = step;
	/* A corner to spare on every side keeps the surface off the border. */
	for (int i = 0; i < 3; i++) {
		grid->size[i] = (int)ceil((solid->high[i] - solid->low[i]) / step) + 3;
		count *= grid->size[i];
	}
	grid->value = malloc(count * sizeof(*grid->value));
	grid->vertex = malloc(count * sizeof(*grid->vertex));
	if (!grid->value || !grid->vertex)
		return -ENOMEM;
	for (int z = 0; z < grid->size[2]; z++) {
		for (int y = 0; y < grid->size[1]; y++) {
			for (int x = 0; x < grid->size[0]; x++) {
				double p[3];

				grid_point(grid, x, y, z, p);
				grid->vertex[at] = -1;
				grid->value[at++] = (float)solid->at(solid->context, p).value;
			}
		}
	}
	return 0;
}

static void grid_free(struct grid *grid)
{
	free(grid->value);
	free(grid->vertex);
}

/* The mean of the points where the cell's edges cross the surface; false when none does. */
static bool cell_middle(const struct grid *grid, const int cell[3], double p[3])
{
	double sum[3] = {0, 0, 0};
	int crossed = 0;

	for (int axis = 0; axis < 3; axis++) {
		for (int edge = 0; edge < 4; edge++) {
			int from[3] = {cell[0], cell[1], cell[2]};
			int to[3];

			from[(axis + 1) % 3] += edge & 1;
			from[(axis + 2) % 3] += edge >> 1;
			memcpy(to, from, sizeof(to));
			to[axis]++;

			const double a = grid->value[grid_index(grid, from[0], from[1], from[2])];
			const double b = grid->value[grid_index(grid, to[0], to[1], to[2])];

			if ((a < 0) == (b < 0))
				continue;
			for (int i = 0; i < 3; i++)
				sum[i] += from[i];
			sum[axis] += a / (a - b);
			crossed++;
		}
	}
	if (!crossed)
		return false;
	grid_point(grid, sum[0] / crossed, sum[1] / crossed, sum[2] / crossed, p);
	return true;
}

static int place_vertices(struct grid *grid, struct trimesh *mesh)
{
	int room = 0;

	for (int z = 0; z + 1 < grid->size[2]; z++) {
		for (int y = 0; y + 1 < grid->size[1]; y++) {
			for (int x = 0; x + 1 < grid->size[0]; x++) {
				const int cell[3] = {x, y, z};
				double p[3];

				if (!cell_middle(grid, cell, p))
					continue;
				if (mesh->vertex_count == room) {
					void *more;

					room = room ? 2 * room : 4096;
					more = realloc(mesh->position,
						       room * sizeof(*mesh->position));
					if (!more)
						return -ENOMEM;
					mesh->position = more;
				}
				grid->vertex[grid_index(grid, x, y, z)] = mesh->vertex_count;
				memcpy(mesh->position[mesh->vertex_count++], p, sizeof(p));
			}
		}
	}
	return 0;
}

/* The four cells around a crossed edge, anti-clockwise seen from outside. */
static void edge_cells(const struct grid *grid, const int corner[3], int axis, bool leaving,
		       int quad[4])
{
	static const int around[4][2] = {{0, 0}, {-1, 0}, {-1, -1}, {0, -1}};

	for (int k = 0; k < 4; k++) {
		const int turn = leaving ? k : 3 - k;
		int cell[3] = {corner[0], corner[1], corner[2]};

		cell[(axis + 1) % 3] += around[turn][0];
		cell[(axis + 2) % 3] += around[turn][1];
		quad[k] = grid->vertex[grid_index(grid, cell[0], cell[1], cell[2])];
	}
}

static int join_vertices(const struct grid *grid, struct trimesh *mesh)
{
	int room = 0;

	for (int z = 1; z + 1 < grid->size[2]; z++) {
		for (int y = 1; y + 1 < grid->size[1]; y++) {
			for (int x = 1; x + 1 < grid->size[0]; x++) {
				for (int axis = 0; axis < 3; axis++) {
					const int corner[3] = {x, y, z};
					int next[3] = {x, y, z};
					int quad[4];

					next[axis]++;
					const bool inside = grid->value[grid_index(grid, x, y, z)] <
							    0;
					const bool inside_next =
						grid->value[grid_index(grid, next[0], next[1],
								       next[2])] < 0;

					if (inside == inside_next)
						continue;
					edge_cells(grid, corner, axis, inside, quad);
					if (mesh->triangle_count + 2 > room) {
						void *more;

						room = room ? 2 * room : 8192;
						more = realloc(mesh->triangle,
							       room * sizeof(*mesh->triangle));
						if (!more)
							return -ENOMEM;
						mesh->triangle = more;
					}
					int(*t)[3] = mesh->triangle + mesh->triangle_count;

					memcpy(t[0], (int[3]){quad[0], quad[1], quad[2]},
					       sizeof(t[0]));
					memcpy(t[1], (int[3]){quad[0], quad[2], quad[3]},
					       sizeof(t[1]));
					mesh->triangle_count += 2;
				}
			}
		}
	}
	return 0;
}

/* Moves a point onto the surface, at most a step each time, and returns the unit gradient. */
static void settle_vertex(const struct grid *grid, double p[3], double normal[3])
{
	struct implicit f = grid->solid->at(grid->solid->context, p);

	for (int k = 0; k < NEWTON_STEPS && fabs(f.value) > CLOSE_ENOUGH * grid->step; k++) {
		const double length2 = vec_dot(f.gradient, f.gradient);
		double move = length2 > 0 ? f.value / length2 : 0;
		const double far = grid->step / sqrt(length2);

		move = fmin(fmax(move, -far), far);
		for (int i = 0; i < 3; i++)
			p[i] -= move * f.gradient[i];
		f = grid->solid->at(grid->solid->context, p);
	}
	memcpy(normal, f.gradient, sizeof(f.gradient));
	vec_normalize(normal);
}

/* Moves each vertex along the surface half-way to the mean of its neighbours, and back onto the
 * surface. This removes the pattern of the grid: triangles end up nearly equal. */
static int even_out(const struct grid *grid, struct trimesh *mesh)
{
	const int count = mesh->vertex_count;
	double(*middle)[4] = malloc(count * sizeof(*middle));

	if (!middle)
		return -ENOMEM;
	for (int pass = 0; pass < EVENING_PASSES; pass++) {
		memset(middle, 0, count * sizeof(*middle));
		for (int t = 0; t < mesh->triangle_count; t++) {
			for (int k = 0; k < 3; k++) {
				const int from = mesh->triangle[t][k];
				const int to = mesh->triangle[t][(k + 1) % 3];

				for (int i = 0; i < 3; i++)
					middle[from][i] += mesh->position[to][i];
				middle[from][3]++;
			}
		}
		for (int v = 0; v < count; v++) {
			double *p = mesh->position[v];
			double *normal = mesh->normal[v];
			double move[3], off;

			for (int i = 0; i < 3; i++)
				move[i] = (middle[v][i] / middle[v][3] - p[i]) / 2;
			off = vec_dot(move, normal);
			for (int i = 0; i < 3; i++)
				p[i] += move[i] - off * normal[i];
			settle_vertex(grid, p, normal);
		}
	}
	free(middle);
	return 0;
}

static double distance_squared(const double a[3], const double b[3])
{
	double d[3];

	for (int i = 0; i < 3; i++)
		d[i] = a[i] - b[i];
	return vec_dot(d, d);
}

/* join_vertices() made the triangles in pairs. Splits each pair along its shorter diagonal. */
static void choose_diagonals(struct trimesh *mesh)
{
	for (int t = 0; t < mesh->triangle_count; t += 2) {
		int *one = mesh->triangle[t], *two = mesh->triangle[t + 1];
		const int a = one[0], b = one[1], c = one[2], d = two[2];

		if (distance_squared(mesh->position[a], mesh->position[c]) <=
		    distance_squared(mesh->position[b], mesh->position[d]))
			continue;
		memcpy(one, (int[3]){a, b, d}, 3 * sizeof(int));
		memcpy(two, (int[3]){b, c, d}, 3 * sizeof(int));
	}
}

int polygonise(struct trimesh *mesh, const struct solid *solid, double step)
{
	struct grid grid = {0};
	int err;

	memset(mesh, 0, sizeof(*mesh));
	err = grid_create(&grid, solid, step);
	if (err)
		goto fail;
	err = place_vertices(&grid, mesh);
	if (err)
		goto fail;
	err = join_vertices(&grid, mesh);
	if (err)
		goto fail;
	mesh->normal = malloc((mesh->vertex_count + 1) * sizeof(*mesh->normal));
	if (!mesh->normal) {
		err = -ENOMEM;
		goto fail;
	}
	for (int v = 0; v < mesh->vertex_count; v++)
		settle_vertex(&grid, mesh->position[v], mesh->normal[v]);
	err = even_out(&grid, mesh);
	if (err)
		goto fail;
	choose_diagonals(mesh);
	grid_free(&grid);
	return 0;

fail:
	grid_free(&grid);
	trimesh_free(mesh);
	return err;
}

void trimesh_free(struct trimesh *mesh)
{
	free(mesh->position);
	free(mesh->normal);
	free(mesh->triangle);
	memset(mesh, 0, sizeof(*mesh));
}
