/* SPDX-License-Identifier: MIT */
#include "hal/optics/dome_placed.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "hal/optics/dome_parts.h"
#include "hal/optics/vec.h"

#define WIDEST_RAD 1.2	/* largest angle from a cell's mean direction to its corners */
#define MARGIN_RAD 0.02 /* more, for pixels that reach over the border */

struct placed_cell {
	double mean[3]; /* m, not unit */
	double corner[DOME_PLACED_THIRDS][3], edge[DOME_PLACED_THIRDS][3];
	double weight[DOME_PLACED_THIRDS]; /* W / sum W; all 0: no pixel of the cell itself */
	double solid_angle_sr;
};

struct dome_placed {
	int lights;
	struct placed_cell *cell;
	double (*direction)[3]; /* of the means, unit */
	struct dome_cells *around;
	struct dome_lookup *lookup;
	struct dome_facets *facets;
};

/* The triangle around a cell. False: the cell is too wide. */
static bool placed_cell_begin(struct placed_cell *f, const struct dome *dome, int i, double unit[3])
{
	const struct dome_cells *cells = dome->cells;
	double e[2][3], axis[3], length, reach = 0, out;

	f->solid_angle_sr = dome->solid_angle_sr[i];
	dome_cells_moment(cells, i, unit);
	length = vec_normalize(unit) / f->solid_angle_sr;
	for (int k = cells->first[i]; k < cells->first[i + 1]; k++)
		reach = fmax(reach, vec_angle(unit, cells->corner[k]));
	if (!(reach < WIDEST_RAD))
		return false;
	memcpy(axis, (double[]){fabs(unit[0]) < 0.6, fabs(unit[0]) >= 0.6, 0}, sizeof(axis));
	vec_cross(axis, unit, e[0]);
	vec_normalize(e[0]);
	vec_cross(unit, e[0], e[1]);
	/* So far out the weights of a third hardly differ, and few thirds need fine sums. */
	out = 12 * tan(reach + MARGIN_RAD);
	for (int k = 0; k < DOME_PLACED_THIRDS; k++)
		for (int c = 0; c < 3; c++)
			f->corner[k][c] = length *
					  (unit[c] + out * (cos(2 * M_PI / 3 * k) * e[0][c] +
							    sin(2 * M_PI / 3 * k) * e[1][c]));
	for (int k = 0; k < DOME_PLACED_THIRDS; k++)
		vec_cross(f->corner[(k + 1) % 3], f->corner[(k + 2) % 3], f->edge[k]);
	out = vec_dot(f->corner[0], f->edge[0]);
	for (int k = 0; k < DOME_PLACED_THIRDS; k++)
		for (int c = 0; c < 3; c++)
			f->edge[k][c] /= out;
	for (int c = 0; c < 3; c++)
		f->mean[c] = length * unit[c];
	return true;
}

/* The triangles between the means. -EINVAL: none cover the sky, as with very few lights. */
static int placed_triangulate(struct dome_placed *f, const struct dome *dome)
{
	const double(*node)[3] = (const double(*)[3])f->direction;
	int ret;

	for (int i = 0; i < f->lights; i++)
		if (!placed_cell_begin(&f->cell[i], dome, i, f->direction[i]))
			return -EINVAL;
	ret = dome_cells_create(&f->around, node, f->lights, sqrt(2 * M_PI / f->lights));
	if (!ret)
		ret = dome_lookup_create(&f->lookup, f->around->radius, node, f->lights);
	return ret ? ret : dome_facets_create(&f->facets, f->around, f->lookup, node, f->lights);
}

void dome_placed_thirds(const struct dome_placed *f, int light, const double dir[3],
			double part[DOME_PLACED_THIRDS])
{
	for (int k = 0; k < DOME_PLACED_THIRDS; k++)
		part[k] = fmax(vec_dot(f->cell[light].edge[k], dir), 0);
}

void dome_placed_even(struct dome_placed *f, const double *weight)
{
	for (int i = 0; i < f->lights; i++) {
		const double *w = weight + (size_t)DOME_PLACED_THIRDS * (size_t)i;
		const double all = w[0] + w[1] + w[2];

		for (int k = 0; k < DOME_PLACED_THIRDS; k++)
			f->cell[i].weight[k] = all > 0 ? w[k] / all : 0;
	}
}

int dome_placed_create(struct dome_placed **out, const struct dome *dome)
{
	struct dome_placed *f = calloc(1, sizeof(*f));
	int ret = -ENOMEM;

	*out = NULL;
	if (!f)
		return ret;
	f->lights = dome->count;
	f->cell = calloc((size_t)f->lights, sizeof(*f->cell));
	f->direction = calloc((size_t)f->lights, sizeof(*f->direction));
	if (f->cell && f->direction)
		ret = placed_triangulate(f, dome);
	if (ret)
		dome_placed_destroy(f);
	else
		*out = f;
	return ret;
}

/* Shares the light of cell i in one channel. Adds its projected flux as it is, and as it became.
 * *facet: see dome_facets_weights(). */
static void placed_cell_share(const struct dome_placed *f, int i, const double (*third)[3], int c,
			      double (*light)[3], double (*projected)[2], int *facet)
{
	const struct placed_cell *cell = &f->cell[i];
	double radiance = 0, flux, centroid[3], weight[3] = {1};
	int to[3] = {i}, count = 1;

	/* Differences from one third keep even light exactly even. */
	for (int k = 1; k < DOME_PLACED_THIRDS; k++)
		radiance += cell->weight[k] * (third[k][c] - third[0][c]);
	radiance += third[0][c];
	if (!(radiance > 0))
		return;
	memcpy(centroid, cell->mean, sizeof(centroid));
	for (int k = 0; k < DOME_PLACED_THIRDS; k++)
		for (int x = 0; x < 3; x++)
			centroid[x] += cell->weight[k] * (third[k][c] - radiance) / radiance *
				       cell->corner[k][x];
	centroid[2] = fmax(centroid[2], 0);
	flux = cell->solid_angle_sr * radiance;
	projected[c][0] += flux * centroid[2];
	if (memcmp(centroid, cell->mean, sizeof(centroid)) != 0)
		count = dome_facets_weights(f->facets, i, facet, centroid, to, weight);
	for (int n = 0; n < count; n++) {
		const struct placed_cell *there = &f->cell[to[n]];

		light[to[n]][c] += weight[n] * cell->solid_angle_sr / there->solid_angle_sr *
				   radiance;
		projected[c][1] += weight[n] * flux * there->mean[2];
	}
}

void dome_placed_run(struct dome_placed *f, const double (*third)[3], int channels,
		     double (*light)[3])
{
	double projected[3][2] = {{0}};

	memset(light, 0, (size_t)f->lights * sizeof(*light));
	for (int i = 0; i < f->lights; i++) {
		int facet = -1; /* channels mostly have the same */

		for (int c = 0; c < channels; c++)
			placed_cell_share(f, i, third + (size_t)DOME_PLACED_THIRDS * i, c, light,
					  projected, &facet);
	}
	for (int c = 0; c < channels; c++) {
		const double factor = projected[c][1] > 0 ? projected[c][0] / projected[c][1] : 1;

		for (int i = 0; i < f->lights; i++)
			light[i][c] *= factor;
	}
}

/* Bound of the factor that keeps a level plane's irradiance: below the lowest mean direction it
 * would darken upright surfaces. */
#define LEVEL_FACTOR_MOST 1.5

int dome_placed_share(const struct dome_placed *f, int light, int *facet, const double dir[3],
		      int to[3], double weight[3])
{
	const int count = dome_facets_weights(f->facets, light, facet, dir, to, weight);
	double level = 0, factor;

	for (int n = 0; n < count; n++)
		level += weight[n] * f->cell[to[n]].mean[2];
	factor = level > 0 ? dir[2] / (sqrt(vec_dot(dir, dir)) * level) : 1;
	factor = fmin(fmax(factor, 1 / LEVEL_FACTOR_MOST), LEVEL_FACTOR_MOST);
	for (int n = 0; n < count; n++)
		weight[n] *= factor;
	return count;
}

void dome_placed_destroy(struct dome_placed *f)
{
	if (!f)
		return;
	dome_cells_destroy(f->around);
	dome_lookup_destroy(f->lookup);
	dome_facets_destroy(f->facets);
	free(f->cell);
	free(f->direction);
	free(f);
}
