#include "bake/cells.h"

#include <errno.h>
#include <stdlib.h>

#include "bake/random.h"

#define CORNERS_MAX 32
#define TABLE_MAX (4 << 20) /* directions in a table */

static struct v3 narrow(const double d[3])
{
	return v3_make((float)d[0], (float)d[1], (float)d[2]);
}

/* Sine of the largest angle from the node to a corner of its cell; 1 when a right angle or more. */
static float reach_of(const struct dome *dome, int cell)
{
	double corner[CORNERS_MAX][3];
	const double *node = dome->direction[cell];
	const int count = dome_cell_corners(dome, cell, corner, CORNERS_MAX);
	double least = 1;

	for (int k = 0; k < count && k < CORNERS_MAX; k++) {
		const double c = corner[k][0] * node[0] + corner[k][1] * node[1] +
				 corner[k][2] * node[2];

		least = c < least ? c : least;
	}
	if (least <= 0 || count > CORNERS_MAX)
		return 1;
	return (float)sqrt(1 - least * least) * 1.001f + 1e-6f;
}

/* Point number index of a cell's scrambled net. */
static void cell_point(const struct dome *dome, int cell, uint32_t index, double out[3])
{
	const uint64_t scramble = random_hash((uint64_t)cell, 0xce11, 0);
	double point[2];

	sobol_point(index, scramble, point);
	dome_cell_sample(dome, cell, point[0], point[1], out);
}

/* By rejection: a direction stays with a chance of its cosine over the cell's largest. */
static void fill_ground(struct cells *cells, int cell, struct v3 *out)
{
	struct random random = {random_hash((uint64_t)cell, 0x9d, 1)};
	const double sine = cells->reach[cell];
	const double z = cells->node[cell].z;
	/* cos(a - b), b the cell's reach; 1 where the cell holds the zenith */
	const double most = z * z + sine * sine >= 1
				    ? 1
				    : z * sqrt(1 - sine * sine) + sqrt(1 - z * z) * sine;
	uint32_t index = 0;

	for (int k = 0; k < cells->depth;) {
		double d[3];

		cell_point(cells->dome, cell, index++, d);
		if (random_next(&random) * most < d[2])
			out[k++] = narrow(d);
	}
}

int cells_create(struct cells *cells, const struct dome *dome)
{
	const size_t count = (size_t)dome->count;
	size_t all;

	*cells = (struct cells){.dome = dome, .count = dome->count, .depth = 256};
	while ((int64_t)cells->depth * cells->count > TABLE_MAX / 16 && cells->depth > 32)
		cells->depth /= 2;
	all = count * (size_t)cells->depth;
	cells->node = malloc(count * sizeof(*cells->node));
	cells->sr = malloc(count * sizeof(*cells->sr));
	cells->share = malloc(count * sizeof(*cells->share));
	cells->reach = malloc(count * sizeof(*cells->reach));
	cells->uniform = malloc(all * sizeof(*cells->uniform));
	cells->ground = malloc(all * sizeof(*cells->ground));
	if (!cells->node || !cells->sr || !cells->share || !cells->reach || !cells->uniform ||
	    !cells->ground) {
		cells_free(cells);
		return -ENOMEM;
	}
	for (int i = 0; i < cells->count; i++) {
		struct v3 *uniform = cells->uniform + (size_t)i * (size_t)cells->depth;

		cells->node[i] = narrow(dome->direction[i]);
		cells->sr[i] = (float)dome->solid_angle_sr[i];
		cells->share[i] = (float)(dome->projected_sr[i] / M_PI);
		cells->reach[i] = reach_of(dome, i);
		for (int k = 0; k < cells->depth; k++) {
			double d[3];

			cell_point(dome, i, (uint32_t)k, d);
			uniform[k] = narrow(d);
		}
		fill_ground(cells, i, cells->ground + (size_t)i * (size_t)cells->depth);
	}
	return 0;
}

void cells_free(struct cells *cells)
{
	free(cells->node);
	free(cells->sr);
	free(cells->share);
	free(cells->reach);
	free(cells->uniform);
	free(cells->ground);
	*cells = (struct cells){.count = 0};
}
