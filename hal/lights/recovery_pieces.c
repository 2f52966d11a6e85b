/* SPDX-License-Identifier: MIT */
#include "hal/lights/recovery_pieces.h"

#include <errno.h>
#include <stdlib.h>

#define CORNERS_MAX 32 /* corners of a cell: five to seven, more where corners coincide */
#define BEYOND 0.01    /* step across an edge, over the distance from node to edge */

struct clipped_pieces {
	int lights;
	int *first;	  /* [lights + 1]: pairs of light i are first[i]..first[i + 1] - 1 */
	int *neighbour;	  /* [pairs]: each pair once, at the light of greater index */
	int *parent;	  /* [lights]: union-find: an earlier light of the same piece, or itself */
	double *solid_sr; /* [lights]: solid angle */
	double *piece_sr; /* [lights]: result of clipped_pieces_find() */
};

/* ---- neighbours ---- */

/* The light behind the edge between corners a and b of a light's cell; -1: below the horizon. */
static int cell_across(const struct dome *dome, int light, const double a[3], const double b[3])
{
	double out[3];

	for (int k = 0; k < 3; k++) {
		const double middle = (a[k] + b[k]) / 2;

		out[k] = middle + BEYOND * (middle - dome->direction[light][k]);
	}
	return dome_cell_of(dome, out);
}

/* Lists the neighbours of a light that have a smaller index; to may be NULL. Returns their
 * count. */
static int light_neighbours(const struct dome *dome, int light, int *to)
{
	double corner[CORNERS_MAX][3];
	const int corners = dome_cell_corners(dome, light, corner, CORNERS_MAX);
	const int known = corners < CORNERS_MAX ? corners : CORNERS_MAX;
	int count = 0;

	for (int k = 0; k < known; k++) {
		const int other = cell_across(dome, light, corner[k], corner[(k + 1) % known]);

		if (other < 0 || other >= light)
			continue;
		if (to)
			to[count] = other;
		count++;
	}
	return count;
}

int clipped_pieces_create(struct clipped_pieces **out, const struct dome *dome)
{
	const size_t lights = (size_t)dome->count;
	struct clipped_pieces *p = calloc(1, sizeof(*p));

	*out = NULL;
	if (!p)
		return -ENOMEM;
	p->lights = dome->count;
	p->first = calloc(lights + 1, sizeof(*p->first));
	p->parent = calloc(lights, sizeof(*p->parent));
	p->solid_sr = calloc(lights, sizeof(*p->solid_sr));
	p->piece_sr = calloc(lights, sizeof(*p->piece_sr));
	if (!p->first || !p->parent || !p->solid_sr || !p->piece_sr)
		goto destroy;
	for (int i = 0; i < p->lights; i++) {
		p->solid_sr[i] = dome->solid_angle_sr[i];
		p->first[i + 1] = p->first[i] + light_neighbours(dome, i, NULL);
	}
	p->neighbour = calloc((size_t)p->first[p->lights] + 1, sizeof(*p->neighbour));
	if (!p->neighbour)
		goto destroy;
	for (int i = 0; i < p->lights; i++)
		light_neighbours(dome, i, p->neighbour + p->first[i]);
	*out = p;
	return 0;

destroy:
	clipped_pieces_destroy(p);
	return -ENOMEM;
}

void clipped_pieces_destroy(struct clipped_pieces *p)
{
	if (!p)
		return;
	free(p->first);
	free(p->neighbour);
	free(p->parent);
	free(p->solid_sr);
	free(p->piece_sr);
	free(p);
}

/* ---- union-find over the clipped lights of a frame ---- */

/* The root of a light's piece, its light of smallest index. Halves the path on the way. */
static int piece_root(struct clipped_pieces *p, int light)
{
	while (p->parent[light] != light) {
		p->parent[light] = p->parent[p->parent[light]];
		light = p->parent[light];
	}
	return light;
}

static void pieces_join(struct clipped_pieces *p, int light, int neighbour)
{
	const int a = piece_root(p, light), b = piece_root(p, neighbour);

	if (a < b)
		p->parent[b] = a;
	else
		p->parent[a] = b;
}

const double *clipped_pieces_find(struct clipped_pieces *p, const float *clipped)
{
	for (int i = 0; i < p->lights; i++) {
		p->parent[i] = i;
		p->piece_sr[i] = 0;
		for (int k = p->first[i]; clipped[i] > 0 && k < p->first[i + 1]; k++)
			if (clipped[p->neighbour[k]] > 0)
				pieces_join(p, i, p->neighbour[k]);
	}
	for (int i = 0; i < p->lights; i++)
		if (clipped[i] > 0)
			p->piece_sr[piece_root(p, i)] += (double)clipped[i] * p->solid_sr[i];
	/* A root comes first in its piece and holds the sum; the other lights copy it. */
	for (int i = 0; i < p->lights; i++)
		if (clipped[i] > 0)
			p->piece_sr[i] = p->piece_sr[piece_root(p, i)];
	return p->piece_sr;
}
